#include "common/inference/tones.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>

namespace fathom::inference {
namespace {

constexpr double kHighestTone = 6.0;  // rad/s
constexpr double kFinest = 0.01;      // of half a turn over the run

}  // namespace

std::vector<double> strongest_tones(const likelihood::Problem& problem, const std::vector<Eigen::MatrixXd>& slope,
                                    int w, double lowest) {
  std::size_t longest = 0;
  for (std::size_t r = 0; r < problem.runs.size(); ++r) {
    if (problem.runs[r].blocks().size() > problem.runs[longest].blocks().size()) longest = r;
  }
  const likelihood::RunData& run = problem.runs[longest];
  const auto& blocks = run.blocks();
  std::vector<double> series(blocks.size(), 0.0);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const std::size_t middle = std::min((blocks[b].first + blocks[b].last) / 2, run.intervals().size() - 1);
    for (int i = 0; i < problem.simulated; ++i) {
      const int axis = problem.axes[static_cast<std::size_t>(i)];
      if (axis < 3)
        series[b] += slope[longest](i, static_cast<Eigen::Index>(b)) * run.intervals()[middle].R_WB(w, axis);
    }
  }
  const double length = run.last_time() - run.first_time(), dt = blocks.front().dt;
  const double spacing = 0.5 * 2.0 * std::numbers::pi / std::max(length, 1.0);
  const auto power_at = [&](double omega) {
    std::complex<double> sum{}, at{1.0, 0.0};
    const std::complex<double> turn{std::cos(omega * dt), std::sin(omega * dt)};
    for (const double x : series) {
      sum += x * at;
      at *= turn;
    }
    return std::norm(sum);
  };
  std::vector<std::pair<double, double>> power;  // and frequency
  for (double omega = lowest; omega < kHighestTone; omega += spacing) power.emplace_back(power_at(omega), omega);
  std::ranges::sort(power, std::greater{});
  std::vector<double> found;
  for (const auto& [strength, omega] : power) {
    if (std::ranges::all_of(found, [&](double other) { return std::abs(other - omega) > 4.0 * spacing; }))
      found.push_back(omega);
    if (found.size() == 2) break;
  }
  // A grid's frequency slips by up to a quarter turn over the run, and the swing with it.
  for (double& omega : found) {
    double best = power_at(omega);
    for (double step = 0.5 * spacing; step > kFinest * spacing; step *= 0.5) {
      for (const double other : {omega - step, omega + step}) {
        const double there = power_at(other);
        if (there > best) best = there, omega = other;
      }
    }
  }
  return found;
}

}  // namespace fathom::inference
