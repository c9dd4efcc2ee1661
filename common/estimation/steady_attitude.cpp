#include "common/estimation/steady_attitude.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/spatial.hpp"
#include "common/base/statistics.hpp"

namespace fathom::estimation {
namespace {

constexpr double kLongest = 0.5;  // s, each side: a scale error of the rates does not cancel when they change

/// Turn from one sample to the next by the rates, seen in the first; nothing where either is not valid.
std::vector<Eigen::Quaterniond> turns_of(const Trial& trial, std::vector<std::uint8_t>& known) {
  std::vector<Eigen::Quaterniond> turns(trial.size(), Eigen::Quaterniond::Identity());
  known.assign(trial.size(), 0);
  for (std::size_t k = 0; k + 1 < trial.size(); ++k) {
    if ((trial.rates_valid[k] & trial.rates_valid[k + 1] & trial.pose_valid[k] & trial.pose_valid[k + 1]) == 0)
      continue;
    known[k] = 1;
    turns[k] = quaternion_from_rotation_vector(0.5 * trial.dt * (trial.nu[k] + trial.nu[k + 1]).tail<3>());
  }
  return turns;
}

/// Samples on each side that leave the least: the mean of 2 n + 1 attitudes of variance `attitude`, to which rates of
/// variance `rates` carried them (a random walk to each side).
std::size_t best_reach(double attitude, double rates, double dt) {
  const double walk = rates * dt * dt, longest = kLongest / dt;
  if (!(attitude > 0.0)) return 0;
  return static_cast<std::size_t>(std::min(walk > 0.0 ? std::sqrt(3.0 * attitude / walk) : longest, longest));
}

}  // namespace

void steady_attitude(Trial& trial) {
  std::vector<std::uint8_t> known;
  const std::vector<Eigen::Quaterniond> turns = turns_of(trial, known);
  std::array<std::vector<double>, 3> apart;  // measured turn over the rates' turn
  for (std::size_t k = 0; k + 1 < trial.size(); ++k) {
    if (known[k] == 0) continue;
    const Eigen::Vector3d rest =
        rotation_vector_from_quaternion((trial.q_WB[k] * turns[k]).conjugate() * trial.q_WB[k + 1]);
    for (std::size_t axis = 0; axis < 3; ++axis) apart[axis].push_back(rest[static_cast<Eigen::Index>(axis)]);
  }
  double attitude = 0.0, rates = 0.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double rate = trial.nu_sigma[3 + static_cast<Eigen::Index>(axis)], walk = rate * trial.dt;
    const double total = mad_sigma(std::move(apart[axis]));
    attitude += std::max(total * total - walk * walk, 0.0) / 6.0;  // two attitudes each, three axes
    rates += rate * rate / 3.0;
  }
  const std::size_t reach = best_reach(attitude, rates, trial.dt);
  const std::vector<Eigen::Quaterniond> measured = trial.q_WB;
  for (std::size_t k = 0; k < trial.size(); ++k) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();  // of small turns from the sample itself
    double count = 1.0;
    Eigen::Quaterniond ahead = Eigen::Quaterniond::Identity(), behind = ahead;  // from the sample to its neighbour
    for (std::size_t i = 1; i <= reach && i <= k && k + i < trial.size(); ++i) {
      if ((known[k - i] & known[k + i - 1]) == 0) break;
      ahead = ahead * turns[k + i - 1];
      behind = behind * turns[k - i].conjugate();
      for (const auto& [neighbour, way] : {std::pair{k + i, ahead}, std::pair{k - i, behind}})
        sum += rotation_vector_from_quaternion(measured[k].conjugate() * measured[neighbour] * way.conjugate());
      count += 2.0;
    }
    trial.q_WB[k] = (measured[k] * quaternion_from_rotation_vector(sum / count)).normalized();
  }
}

}  // namespace fathom::estimation
