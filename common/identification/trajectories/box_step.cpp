#include "common/identification/trajectories/box_step.hpp"

#include <cmath>
#include <vector>

#include "common/base/factors.hpp"

namespace fathom::identification {
namespace {

/// The unbounded minimum over the free numbers, the others staying where d has them.
Eigen::VectorXd minimum(const Eigen::MatrixXd& A, const Eigen::VectorXd& g, const Eigen::VectorXd& d,
                        const std::vector<Eigen::Index>& free) {
  const auto m = static_cast<Eigen::Index>(free.size());
  Eigen::VectorXd fixed = d;
  for (const Eigen::Index i : free) fixed[i] = 0.0;
  const Eigen::VectorXd right = -(g + A * fixed);
  Eigen::MatrixXd part(m, m);
  Eigen::VectorXd b(m);
  for (Eigen::Index r = 0; r < m; ++r) {
    b[r] = right[free[static_cast<std::size_t>(r)]];
    for (Eigen::Index c = 0; c < m; ++c)
      part(r, c) = A(free[static_cast<std::size_t>(r)], free[static_cast<std::size_t>(c)]);
  }
  const Eigen::VectorXd solved = solve_symmetric(part, b);
  for (Eigen::Index r = 0; r < m; ++r) fixed[free[static_cast<std::size_t>(r)]] = solved[r];
  return fixed;
}

}  // namespace

Eigen::VectorXd box_step(const Eigen::MatrixXd& A, const Eigen::VectorXd& g, const Eigen::VectorXd& low,
                         const Eigen::VectorXd& high) {
  const Eigen::Index n = g.size();
  constexpr int kRoundsPerNumber = 3;  // it ends by itself; rounding must not keep it going
  std::vector<bool> held(static_cast<std::size_t>(n), false);
  Eigen::VectorXd d = Eigen::VectorXd::Zero(n);
  for (int round = 0; round < kRoundsPerNumber * static_cast<int>(n); ++round) {
    std::vector<Eigen::Index> free;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (!held[static_cast<std::size_t>(i)]) free.push_back(i);
    }
    const Eigen::VectorXd wanted = minimum(A, g, d, free);
    // As far that way as the first bound.
    double share = 1.0;
    Eigen::Index first = -1;
    for (const Eigen::Index i : free) {
      const double bound = wanted[i] < low[i] ? low[i] : wanted[i] > high[i] ? high[i] : wanted[i];
      if (bound == wanted[i]) continue;
      const double reach = (bound - d[i]) / (wanted[i] - d[i]);
      if (reach < share) {
        share = reach;
        first = i;
      }
    }
    d += share * (wanted - d);
    if (first >= 0) {
      d[first] = wanted[first] < low[first] ? low[first] : high[first];
      held[static_cast<std::size_t>(first)] = true;
      continue;
    }
    // There: whoever is held against his will is let go, the most unwilling first.
    const Eigen::VectorXd slope = A * d + g;
    Eigen::Index unwilling = -1;
    double most = 0.0;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (!held[static_cast<std::size_t>(i)]) continue;
      const double inwards = (d[i] <= low[i] ? -slope[i] : slope[i]) / std::sqrt(A(i, i));
      if (inwards > most) {
        most = inwards;
        unwilling = i;
      }
    }
    if (unwilling < 0) break;
    held[static_cast<std::size_t>(unwilling)] = false;
  }
  return d;
}

}  // namespace fathom::identification
