#include "common/inference/thruster_laws.hpp"

#include <algorithm>
#include <cmath>

#include "common/model/thruster_kinds.hpp"

namespace fathom::inference {
namespace {

constexpr double kNever = 1e9;  // N: no thrust is as large

/// Twice the rms [N] and down by twos: what is small (a dead band) is narrow, what is large (a limit) is wide.
std::vector<likelihood::Factor> thrust_knots(double rms, int index) {
  constexpr int kKnots = 6;
  std::vector<likelihood::Factor> knots;
  double at = 2.0 * rms;
  for (int k = 0; k < kKnots && at > 0.0; ++k, at *= 0.5) {
    const bool lowest = k == kKnots - 1;
    knots.push_back({.quantity = likelihood::Quantity::kThrustKnot,
                     .index = index,
                     .a = at,
                     .b = lowest ? at : 0.5 * at,
                     .c = k == 0 ? kNever : at});
  }
  return knots;
}

}  // namespace

std::vector<ThrusterLaw> thruster_laws(const likelihood::Problem& problem, const Seen& seen,
                                       const model::Scene& scene) {
  if (scene.input_is_wrench) return {};
  const Eigen::Index count = seen.fit.hypothesis.model.allocation.cols();
  Eigen::VectorXd square = Eigen::VectorXd::Zero(count);
  double blocks = 0.0;
  const std::vector<likelihood::Number> none;
  for (std::size_t r = 0; r < problem.runs.size(); ++r) {
    const likelihood::Plant plant{seen.fit.hypothesis, none, problem.runs[r], r, false};
    square += plant.mean_forces().rowwise().squaredNorm();
    blocks += static_cast<double>(plant.mean_forces().cols());
  }
  const Eigen::VectorXd rms = (square / std::max(blocks, 1.0)).cwiseSqrt();
  const auto& thrusters = problem.vehicle->thrusters;
  const auto is_propeller = [&](Eigen::Index j) {
    return thrusters.size() != static_cast<std::size_t>(count) ||
           model::is_propeller(thrusters[static_cast<std::size_t>(j)]);
  };
  std::vector<ThrusterLaw> laws;
  bool alike = true;
  for (Eigen::Index j = 0; j < count; ++j) {
    alike = alike && is_propeller(j);
    if (is_propeller(j))
      laws.push_back({"thruster " + std::to_string(j + 1), model::kThrusterLine + static_cast<int>(j),
                      static_cast<int>(j), thrust_knots(rms[j], static_cast<int>(j))});
  }
  if (alike && count > 1)
    laws = {{"all thrusters", model::kEachThruster, 0,
             thrust_knots(std::sqrt(rms.squaredNorm() / static_cast<double>(count)), 0)}};
  return laws;
}

}  // namespace fathom::inference
