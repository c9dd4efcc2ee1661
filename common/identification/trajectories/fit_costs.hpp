// What the output-error fit hands to Ceres: the residuals of all windows, axis by axis, and the priors.
#pragma once

// Its logging defines CHECK anew, which in a test that reads this later is doctest's.
#pragma push_macro("CHECK")
#include <ceres/ceres.h>
#pragma pop_macro("CHECK")

#include <span>
#include <vector>

#include "common/base/parallel.hpp"
#include "common/identification/trajectories/window_residual.hpp"

namespace fathom::identification {

/// Residuals and derivatives of all windows at the solver's current point. They are worked out side by side before the
/// solver asks, and the solver itself adds them up in one thread: so a fit gives the same bits however many threads
/// help.
class Evaluations final : public ceres::EvaluationCallback {
 public:
  Evaluations(std::span<const WindowResidual> windows, const model::Model& model, const ParameterMap& map,
              const Vector6d& sigma, const Eigen::VectorXd& x, const std::vector<Vector6d>& nu0, int threads)
      : windows_{windows},
        model_{model},
        map_{map},
        sigma_{sigma},
        x_{x},
        nu0_{nu0},
        threads_{threads},
        at_(windows.size()) {}

  struct One {
    Eigen::VectorXd residual;
    Eigen::MatrixXd by_parameter, by_initial;
  };

  void PrepareForEvaluation(bool jacobians, bool /*new_point*/) override {
    // The solver tries a step, takes it, and derives there.
    const bool same = last_nu0_.size() == nu0_.size() && x_ == last_x_ && nu0_ == last_nu0_;
    if (same && (with_jacobians_ || !jacobians)) return;
    with_jacobians_ = jacobians;
    last_x_ = x_;
    last_nu0_ = nu0_;
    model::Model model = model_;
    map_.unpack(x_, model);
    for_each_index(windows_.size(), threads_, [&](std::size_t w) {
      thread_local model::VelocityTrace trace;
      One& one = at_[w];
      if (!same) {
        one.residual.resize(windows_[w].rows());
        windows_[w].evaluate(model, nu0_[w], sigma_, trace, one.residual);
      }
      if (jacobians)
        windows_[w].jacobians(model, map_, nu0_[w], sigma_, one.residual, one.by_parameter, one.by_initial);
    });
  }

  [[nodiscard]] const One& at(std::size_t window) const { return at_[window]; }

 private:
  std::span<const WindowResidual> windows_;
  const model::Model& model_;
  const ParameterMap& map_;
  const Vector6d& sigma_;
  const Eigen::VectorXd& x_;
  const std::vector<Vector6d>& nu0_;
  int threads_;
  bool with_jacobians_{false};
  Eigen::VectorXd last_x_;  ///< where at_ was worked out
  std::vector<Vector6d> last_nu0_;
  std::vector<One> at_;
};

/// Weighted residual of one axis of a window: parameter blocks theta (scaled) and nu0.
class AxisCost final : public ceres::CostFunction {
 public:
  AxisCost(const Evaluations& evaluations, std::size_t window, AxisRows rows, std::size_t parameters)
      : evaluations_{evaluations}, window_{window}, rows_{rows} {
    set_num_residuals(static_cast<int>(rows.count));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(parameters));
    mutable_parameter_block_sizes()->push_back(6);
  }

  bool Evaluate(double const* const* /*blocks*/, double* residuals, double** jacobians) const override {
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const Evaluations::One& one = evaluations_.at(window_);
    Eigen::Map<Eigen::VectorXd>(residuals, rows_.count) = one.residual.segment(rows_.first, rows_.count);
    if (jacobians == nullptr) return one.residual.allFinite();
    if (jacobians[0] != nullptr) {
      Eigen::Map<RowMajor>(jacobians[0], rows_.count, one.by_parameter.cols()) =
          one.by_parameter.middleRows(rows_.first, rows_.count);
    }
    if (jacobians[1] != nullptr) {
      Eigen::Map<RowMajor>(jacobians[1], rows_.count, 6) = one.by_initial.middleRows(rows_.first, rows_.count);
    }
    return one.residual.allFinite();
  }

 private:
  const Evaluations& evaluations_;
  std::size_t window_;
  AxisRows rows_;
};

/// Priors on the parameters, and on nothing else.
class PriorCost final : public ceres::CostFunction {
 public:
  explicit PriorCost(const ParameterMap& map) : map_{map} {
    set_num_residuals(static_cast<int>(map.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(map.size()));
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const std::size_t n = map_.size();
    for (std::size_t i = 0; i < n; ++i) {
      residuals[i] = (blocks[0][i] * map_[i].scale - map_[i].prior_mean) / map_[i].prior_sigma;
    }
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      std::fill(jacobians[0], jacobians[0] + n * n, 0.0);
      for (std::size_t i = 0; i < n; ++i) jacobians[0][i * n + i] = map_[i].scale / map_[i].prior_sigma;
    }
    return true;
  }

 private:
  const ParameterMap& map_;
};

}  // namespace fathom::identification
