// The dual of the small quadratic programme needs P only, never its inverse: with s = S x (admissible: s >= 0) and
// multipliers l >= 0, s = s_hat + Q l and l . s = 0, where Q = S P S over the constrained parameters. That is a
// non-negative least squares problem, solved by the active set method of Lawson & Hanson (1974, ch. 23).
#include "common/identification/projection.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace fathom::identification {
namespace {

constexpr double kTolerance = 1e-12;  // in units of each parameter's own sigma

// Solves Q_ss z_s = -s_hat_s over the chosen set; zero elsewhere.
ParameterVector solve_chosen(const ParameterMatrix& Q, const ParameterVector& s_hat,
                             const std::array<bool, kMaxParameters>& chosen) {
  const Eigen::Index m = s_hat.size();
  std::array<Eigen::Index, kMaxParameters> where{};
  Eigen::Index count = 0;
  for (Eigen::Index i = 0; i < m; ++i) {
    if (chosen[static_cast<std::size_t>(i)]) where[static_cast<std::size_t>(count++)] = i;
  }
  ParameterMatrix A(count, count);
  ParameterVector b(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    b(i) = -s_hat(where[static_cast<std::size_t>(i)]);
    for (Eigen::Index j = 0; j < count; ++j) {
      A(i, j) = Q(where[static_cast<std::size_t>(i)], where[static_cast<std::size_t>(j)]);
    }
  }
  const ParameterVector solved = A.ldlt().solve(b);
  ParameterVector z = ParameterVector::Zero(m);
  for (Eigen::Index i = 0; i < count; ++i) z(where[static_cast<std::size_t>(i)]) = solved(i);
  return z;
}

}  // namespace

bool obeys(const ParameterVector& x, const Signs& signs) {
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    if (x(i) * signs[static_cast<std::size_t>(i)] < 0.0) return false;
  }
  return true;
}

ParameterVector project_on_signs(const ParameterVector& x_hat, const ParameterMatrix& P, const Signs& signs) {
  if (obeys(x_hat, signs)) return x_hat;
  const Eigen::Index n = x_hat.size();
  std::array<Eigen::Index, kMaxParameters> constrained{};
  Eigen::Index m = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (signs[static_cast<std::size_t>(i)] != 0) constrained[static_cast<std::size_t>(m++)] = i;
  }
  // Everything in units of sigma, so that one tolerance fits all.
  ParameterVector scale(m);
  ParameterVector s_hat(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    const Eigen::Index a = constrained[static_cast<std::size_t>(i)];
    scale(i) = signs[static_cast<std::size_t>(a)] / std::sqrt(P(a, a));
    s_hat(i) = x_hat(a) * scale(i);
  }
  ParameterMatrix Q(m, m);
  for (Eigen::Index i = 0; i < m; ++i) {
    for (Eigen::Index j = 0; j < m; ++j) {
      Q(i, j) =
          scale(i) * scale(j) * P(constrained[static_cast<std::size_t>(i)], constrained[static_cast<std::size_t>(j)]);
    }
  }

  ParameterVector l = ParameterVector::Zero(m);
  std::array<bool, kMaxParameters> chosen{};
  for (Eigen::Index outer = 0; outer < 3 * m; ++outer) {
    Eigen::Index worst = -1;
    double violation = kTolerance;
    for (Eigen::Index i = 0; i < m; ++i) {
      if (chosen[static_cast<std::size_t>(i)]) continue;
      const double s = s_hat(i) + Q.row(i).dot(l);
      if (-s > violation) {
        violation = -s;
        worst = i;
      }
    }
    if (worst < 0) break;
    chosen[static_cast<std::size_t>(worst)] = true;
    for (Eigen::Index inner = 0; inner < m; ++inner) {
      const ParameterVector z = solve_chosen(Q, s_hat, chosen);
      double step = 1.0;
      for (Eigen::Index i = 0; i < m; ++i) {
        if (chosen[static_cast<std::size_t>(i)] && z(i) <= 0.0) step = std::min(step, l(i) / (l(i) - z(i)));
      }
      if (!(step < 1.0)) {
        l = z;
        break;
      }
      l += step * (z - l);
      for (Eigen::Index i = 0; i < m; ++i) {
        if (chosen[static_cast<std::size_t>(i)] && z(i) <= 0.0 && l(i) <= kTolerance) {
          l(i) = 0.0;
          chosen[static_cast<std::size_t>(i)] = false;
        }
      }
    }
  }

  ParameterVector x = x_hat;
  for (Eigen::Index i = 0; i < m; ++i) x += P.col(constrained[static_cast<std::size_t>(i)]) * (scale(i) * l(i));
  for (Eigen::Index i = 0; i < m; ++i) {
    const Eigen::Index a = constrained[static_cast<std::size_t>(i)];
    // Active ones are zero up to rounding; make the sign exact for those who check it.
    if (chosen[static_cast<std::size_t>(i)] || x(a) * signs[static_cast<std::size_t>(a)] < 0.0) x(a) = 0.0;
  }
  return x;
}

}  // namespace fathom::identification
