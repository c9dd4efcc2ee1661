#include "common/learning/spread.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/base/factors.hpp"
#include "common/learning/learn.hpp"
#include "common/likelihood/effect_stages.hpp"

namespace fathom::learning {
namespace {

using likelihood::NumberKind;

constexpr std::size_t kMostWindows = 20;

}  // namespace

Vector6d spread_of(const likelihood::Fit& fit, const model::Visited& visited, const Telling& tell, double input_step,
                   std::span<const model::Window> windows) {
  std::vector<Eigen::Index> at;
  std::vector<likelihood::Number> numbers;
  for (std::size_t j = 0; j < fit.numbers.size(); ++j) {
    const NumberKind kind = fit.numbers[j].kind;
    if (kind != NumberKind::kBase && kind != NumberKind::kEffect && kind != NumberKind::kWeight) continue;
    at.push_back(static_cast<Eigen::Index>(j));
    numbers.push_back(fit.numbers[j]);
  }
  const std::size_t every = windows.size() / kMostWindows + 1;
  std::vector<model::Window> chosen;
  for (std::size_t w = 0; w < windows.size(); w += every) chosen.push_back(windows[w]);
  Vector6d sigma = Vector6d::Zero();
  if (at.empty() || chosen.empty() || fit.information.rows() != static_cast<Eigen::Index>(fit.numbers.size()))
    return sigma;
  const Eigen::MatrixXd inverse = inverse_symmetric(fit.information);
  const SymmetricEigen ways = symmetric_eigen(inverse(at, at));
  const auto ends = [&](const likelihood::Hypothesis& hypothesis) {
    const model::LearnedForce force{tell(hypothesis.force), visited, hypothesis.model.allocation};
    const model::Model model = as_model(hypothesis, input_step, &force);
    Eigen::MatrixXd all(6, static_cast<Eigen::Index>(chosen.size()));
    model::VelocityTrace nu;
    for (std::size_t w = 0; w < chosen.size(); ++w) {
      (void)model::rollout(model, chosen[w], model::true_velocity(model, *chosen[w].trial, chosen[w].start), nu);
      all.col(static_cast<Eigen::Index>(w)) = nu.col(nu.cols() - 1);
    }
    return all;
  };
  const Eigen::VectorXd middle = values(fit.hypothesis, numbers);
  const Eigen::MatrixXd from = ends(fit.hypothesis);
  for (Eigen::Index j = 0; j < ways.values.size(); ++j) {
    if (!(ways.values[j] > 0.0)) continue;
    likelihood::Hypothesis moved = fit.hypothesis;
    set_values(moved, numbers, middle + std::sqrt(ways.values[j]) * ways.vectors.col(j));
    sigma += (ends(moved) - from).rowwise().squaredNorm() / static_cast<double>(chosen.size());
  }
  return sigma.cwiseSqrt();
}

double not_visited(const model::Model& model, const model::LearnedForce& force, std::span<const Trial> trials) {
  double beyond = 0.0, count = 0.0;
  for (const Trial& trial : trials) {
    for (std::size_t k = 0; k < trial.size(); ++k) {
      model::Motion motion;
      motion.t = trial.t[k];
      motion.p_WB = trial.p_WB[k];
      motion.R_WB = trial.q_WB[k].toRotationMatrix();
      motion.nu = trial.nu[k];
      motion.force = trial.input[k];
      motion.vehicle = model.vehicle;
      likelihood::feel_hull(model, motion);
      if (!trial.columns.empty())
        motion.columns = {trial.columns[k].data(), static_cast<std::size_t>(trial.columns[k].size())};
      beyond += force.beyond(motion) ? 1.0 : 0.0;
      count += 1.0;
    }
  }
  return count > 0.0 ? beyond / count : 0.0;
}

}  // namespace fathom::learning
