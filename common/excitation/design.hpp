// Input design on line: of a library of segments (multisines and steps over one or several axes) the one that shrinks
// the uncertainty of the parameters most, as the model known so far predicts it, and that stays inside the fence.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "common/excitation/fence.hpp"
#include "common/excitation/random.hpp"
#include "common/model/dynamics.hpp"
#include "common/samples/estimates.hpp"

namespace fathom::excitation {

/// One stretch of input. Values are shares of the largest wrench per axis.
struct Segment {
  static constexpr int kSines = 4;
  std::string name;
  double duration{};                     ///< s
  Vector6d switch_at{Vector6d::Zero()};  ///< s after which each step changes its sign, again and again; 0: never
  Vector6d step{Vector6d::Zero()};
  Eigen::Matrix<double, 6, kSines> amplitude{Eigen::Matrix<double, 6, kSines>::Zero()};
  Eigen::Matrix<double, 6, kSines> frequency{Eigen::Matrix<double, 6, kSines>::Zero()};  ///< Hz
  Eigen::Matrix<double, 6, kSines> phase{Eigen::Matrix<double, 6, kSines>::Zero()};      ///< rad
  /// Share of the largest wrench at `t` [s] from the segment's start.
  [[nodiscard]] Vector6d at(double t) const;
  [[nodiscard]] bool moves(Eigen::Index axis) const;
};

enum class Criterion { kD, kA };  ///< volume of the ellipsoid; sum of squared relative standard deviations

struct DesignSettings {
  Criterion criterion{Criterion::kD};
  double duration{3.0};              ///< s of one segment
  int draws{12};                     ///< candidates of each kind
  double highest_frequency{0.5};     ///< Hz
  double rows_per_second{};          ///< information arrives as so many rows
  Vector6d noise{Vector6d::Ones()};  ///< N, N m: sigma of a row
  double smallest_scale{0.05};       ///< of what is ordinary: below it a parameter's size is not asked for
};

/// Information of a stretch of motion: sum over rows of y' R^-1 y for the vehicle's parameters, in their order.
class Information {
 public:
  Information(const model::Vehicle& vehicle, const Vector6d& noise);
  void add(const Vector6d& nu_dot, const Vector6d& nu, const Eigen::Matrix3d& R_WB, double rows);
  [[nodiscard]] const Eigen::MatrixXd& matrix() const { return matrix_; }
  void clear() { matrix_.setZero(); }

 private:
  std::vector<int> columns_;
  std::array<bool, 6> dof_{};
  Vector6d weight_;
  Eigen::MatrixXd matrix_;
};

class Designer {
 public:
  Designer(const DesignSettings& settings, const model::Vehicle& vehicle, const Vector6d& largest, std::uint64_t seed);

  /// The best next segment from here. Without a covariance of the right size in `model` the prior's is taken.
  [[nodiscard]] Segment next(const StateEstimate& state, double turned, const ModelEstimate& model, const Fence& fence,
                             const Eigen::Vector3d& trim_W);
  /// Gain of the last choice in the criterion (D: half the fall of log det; A: fall of the sum).
  [[nodiscard]] double gain() const { return gain_; }

 private:
  [[nodiscard]] std::vector<Segment> library();
  /// False when it leaves the fence.
  [[nodiscard]] bool predict(const Segment& segment, const StateEstimate& state, double turned, const Fence& fence,
                             const Eigen::Vector3d& trim_W, double& bent);

  DesignSettings settings_;
  model::Vehicle vehicle_;
  Vector6d largest_;
  Random random_;
  model::Model model_;
  Information information_;
  double gain_{};
};

}  // namespace fathom::excitation
