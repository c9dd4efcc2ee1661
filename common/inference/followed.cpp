#include "common/inference/followed.hpp"

#include <cmath>

namespace fathom::inference {
namespace {

/// Of one axis of one run, squares about their means over kSlow: of the accelerations over kAccelerationSpan as they
/// were filtered, and of what the model did not foretell of them from where the vehicle was.
struct Squares {
  double all{}, left{};
};
Squares squares_of(const likelihood::RunData& run, const likelihood::RunReference& reference, int axis) {
  constexpr double kSlow = 5.0;  // s: what changes more slowly is missing, but it is not thrust that nothing follows
  Squares squares;
  std::vector<double> moved, foretold;
  const auto close = [&] {
    const auto n = static_cast<double>(moved.size());
    double mean_moved = 0.0, mean_left = 0.0;
    for (std::size_t k = 0; k < moved.size(); ++k) {
      mean_moved += moved[k] / n;
      mean_left += (moved[k] - foretold[k]) / n;
    }
    for (std::size_t k = 0; k < moved.size(); ++k) {
      squares.all += std::pow(moved[k] - mean_moved, 2);
      squares.left += std::pow(moved[k] - foretold[k] - mean_left, 2);
    }
    moved.clear();
    foretold.clear();
  };
  double span = 0.0, sum = 0.0;
  Eigen::Index from = 0;
  for (std::size_t b = 1; b < run.blocks().size(); ++b) {
    const likelihood::Block& block = run.blocks()[b];
    const auto at = static_cast<Eigen::Index>(b);
    if (!block.scored) {
      span = sum = 0.0;
      from = at;
      continue;
    }
    span += block.dt;
    sum += block.dt * reference.nu_dot(axis, at);
    if (span < likelihood::kAccelerationSpan) continue;
    moved.push_back((reference.nu_end(axis, at) - reference.nu_end(axis, from)) / span);
    foretold.push_back(sum / span);
    span = sum = 0.0;
    from = at;
    if (static_cast<double>(moved.size()) * likelihood::kAccelerationSpan >= kSlow) close();
  }
  close();
  return squares;
}

}  // namespace

std::vector<double> followed(const likelihood::Problem& problem, const Seen& seen) {
  std::vector<double> shares;
  for (int i = 0; i < problem.simulated; ++i) {
    Squares sum;
    for (std::size_t r = 0; r < problem.runs.size(); ++r) {
      const Squares squares = squares_of(problem.runs[r], seen.reference[r], problem.axes[static_cast<std::size_t>(i)]);
      sum.all += squares.all;
      sum.left += squares.left;
    }
    shares.push_back(sum.all > 0.0 ? 1.0 - sum.left / sum.all : 1.0);
  }
  return shares;
}

}  // namespace fathom::inference
