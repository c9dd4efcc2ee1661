// Of what a residual may go with: one thruster whose force is not what was asked of it, or two that are in each other's
// water.
#include <cmath>

#include "common/diagnosis/associations.hpp"
#include "common/diagnosis/product_sums.hpp"

namespace fathom::diagnosis {
namespace {

constexpr double kChosen = 1.0;    // parameters that the choice of a thruster counts for
constexpr std::size_t kMost = 12;  // thrusters: more are as many columns as a run has samples

bool by_thrusters(const Trial& trial) { return !trial.input_is_wrench; }

}  // namespace

Association LeftOver::of_thrusters(int axis) const {
  Association best{.axis = model::kAxisNames[static_cast<std::size_t>(axis)], .log_odds = -1.0};
  const auto& thrusters = model_.vehicle->thrusters;
  const std::size_t n = thrusters.size();
  if (n < 2 || n > kMost) return best;
  const std::vector<Eigen::MatrixXd> runs = rows(axis, by_thrusters, [&](const Moment& at, Columns& row) {
    const Eigen::VectorXd& force = at.trial.input[at.k];
    for (Eigen::Index i = 0; i < force.size(); ++i) {
      row.push_back(std::abs(force[i]));
      row.push_back(std::pow(force[i], 3));
    }
    for (Eigen::Index i = 0; i < force.size(); ++i) {
      for (Eigen::Index j = i + 1; j < force.size(); ++j) {
        row.push_back(force[i] * std::abs(force[j]));
        row.push_back(force[j] * std::abs(force[i]));
      }
    }
  });
  if (runs.empty()) return best;
  const identification::LagSums sums = sums_of(runs);
  const auto asked = static_cast<double>(n * (n + 1) / 2);
  Eigen::Index first = kBaseColumns;
  const auto ask = [&](const std::string& with) {
    Answer told = answer(sums, range(first, first + 2), kChosen);
    first += 2;
    told.log_odds -= std::log(asked);
    if (told.log_odds <= best.log_odds) return;
    best.with = with;
    best.share = told.share;
    best.log_odds = told.log_odds;
  };
  for (std::size_t i = 0; i < n; ++i)
    ask("thrust of " + thrusters[i].name + ", not in proportion to what was asked of it");
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j)
      ask("thrust of " + thrusters[i].name + " and " + thrusters[j].name + " at once");
  }
  return best;
}

}  // namespace fathom::diagnosis
