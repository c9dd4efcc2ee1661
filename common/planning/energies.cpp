#include "common/planning/energies.hpp"

#include <algorithm>
#include <array>

#include "common/identification/trajectories/parameter_map.hpp"

namespace fathom::planning {
namespace {

constexpr double kShortest = 5.0;    // s: a step there and back
constexpr double kLongest = 1800.0;  // s: nobody flies the same for longer
constexpr double kCrooked = 0.3;     // of a change: what half of the effect does otherwise

/// Nothing where the change is not proportional to the effect: a motion that is unstable (a hull that will not run
/// straight) carries anything anywhere, and no fit would make sense of it.
Eigen::VectorXd sober_change(const View& view, const model::ActiveEffect& active) {
  Eigen::VectorXd change = view.change(active);
  model::ActiveEffect half = active;
  static_cast<void>(grow(half, 0.5));
  const double crooked = (2.0 * view.change(half) - change).norm();
  if (!change.allFinite() || !(crooked <= kCrooked * change.norm())) change.setZero();
  return change;
}

void choose(std::optional<Answer>& best, const Extra& extra, double needed, double gain) {
  if (!(gain > kNoEnergy)) return;
  const double seconds = extra.duration * needed / gain;
  if (seconds > kLongest) return;
  if (!best || seconds < best->seconds) best = {extra.name, seconds};
}

std::optional<Answer> at_least(std::optional<Answer> answer) {
  if (answer) answer->seconds = std::max(answer->seconds, kShortest);
  return answer;
}

Eigen::MatrixXd information(const model::Model& model, std::span<const View* const> views) {
  const identification::ParameterMap map{model};
  const auto n = static_cast<Eigen::Index>(map.size());
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(n + 1, n + 1);
  sum(n, n) = 1.0;  // the clock of the commands
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& free = map[static_cast<std::size_t>(i)];
    sum(i, i) = (free.scale / free.prior_sigma) * (free.scale / free.prior_sigma);
  }
  for (const View* view : views) sum += view->jacobian().transpose() * view->jacobian();
  return sum;
}

}  // namespace

Base::Base(const model::Model& model, std::span<const View* const> views) : factor_{information(model, views)} {}

bool grow(model::ActiveEffect& active, double factor) {
  const auto parameters = active.effect->parameters();
  const auto sizes =
      active.effect->amplitudes() > 0 ? static_cast<std::size_t>(active.effect->amplitudes()) : parameters.size();
  bool inside = true;
  for (std::size_t i = 0; i < sizes; ++i) {
    active.theta[i] *= factor;
    inside = inside && active.theta[i] >= parameters[i].low && active.theta[i] <= parameters[i].high;
  }
  return inside;
}

Energies::Energies(const View& excitation, std::span<const Extra> extras, const std::vector<Suspect>& suspects)
    : excitation_{excitation}, extras_{extras}, suspects_{suspects}, changes_(extras.size()) {
  const View* alone = &excitation;
  bases_.emplace_back(excitation.model(), std::span{&alone, 1});
  for (std::size_t e = 0; e < extras.size(); ++e) {
    const std::array<const View*, 2> both{&excitation, extras[e].view};
    bases_.emplace_back(excitation.model(), both);
    for (const Suspect& suspect : suspects) changes_[e].push_back(sober_change(*extras[e].view, suspect.active));
  }
}

double Energies::product(std::size_t i, std::size_t j, std::size_t with) const {
  double product = suspects_[i].change.dot(suspects_[j].change);
  Eigen::VectorXd left = excitation_.jacobian().transpose() * suspects_[i].change;
  Eigen::VectorXd right = excitation_.jacobian().transpose() * suspects_[j].change;
  if (with > 0) {
    const auto& jacobian = extras_[with - 1].view->jacobian();
    product += changes_[with - 1][i].dot(changes_[with - 1][j]);
    left += jacobian.transpose() * changes_[with - 1][i];
    right += jacobian.transpose() * changes_[with - 1][j];
  }
  return product - left.dot(bases_[with].solve(right));
}

double Energies::beside(std::size_t i, std::size_t j, std::size_t with) const {
  const double other = product(j, j, with), shared = product(i, j, with);
  return product(i, i, with) - (other > kNoEnergy ? shared * shared / other : 0.0);
}

std::optional<Answer> Energies::as_strong(std::size_t i) const {
  std::optional<Answer> best;
  const double now = product(i, i, 0);
  for (std::size_t e = 0; e < extras_.size(); ++e) choose(best, extras_[e], now, product(i, i, e + 1) - now);
  return at_least(best);
}

std::optional<Answer> Energies::tells_apart(std::size_t i, std::size_t j) const {
  std::optional<Answer> best;
  const double now = beside(i, j, 0);
  for (std::size_t e = 0; e < extras_.size(); ++e)
    choose(best, extras_[e], std::max(kToldApart - now, 0.0), beside(i, j, e + 1) - now);
  return at_least(best);
}

}  // namespace fathom::planning
