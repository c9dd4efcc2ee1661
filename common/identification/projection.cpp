// The dual of the small quadratic programme needs P only, never its inverse: with multipliers l >= 0 and unit-sigma
// constraint vectors a_i = sign_i / sigma_i e_i, x = x_hat + P sum a_i l_i, a_i . x >= 0 and l_i (a_i . x) = 0. That is
// a non-negative least squares problem, solved by the active set method of Lawson & Hanson (1974, ch. 23).
#include "common/identification/projection.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace fathom::identification {
namespace {

constexpr double kTolerance = 1e-12;  // in units of each parameter's own sigma

/// The parameters held at zero, with their multipliers.
struct Held {
  std::array<Eigen::Index, kMaxParameters> which{};
  Eigen::Index count{};
  ParameterVector l;

  [[nodiscard]] bool has(Eigen::Index i) const {
    return std::find(which.begin(), which.begin() + count, i) != which.begin() + count;
  }
};

// Multipliers that bring every held parameter to zero.
ParameterVector multipliers(const ParameterVector& x_hat, const ParameterMatrix& P, const ParameterVector& scale,
                            const Held& held) {
  ParameterMatrix A(held.count, held.count);
  ParameterVector b(held.count);
  for (Eigen::Index j = 0; j < held.count; ++j) {
    const Eigen::Index b_j = held.which[static_cast<std::size_t>(j)];
    b(j) = -scale(b_j) * x_hat(b_j);
    for (Eigen::Index i = 0; i < held.count; ++i) {
      const Eigen::Index a_i = held.which[static_cast<std::size_t>(i)];
      A(i, j) = scale(a_i) * scale(b_j) * P(a_i, b_j);
    }
  }
  A.ldlt().solveInPlace(b);
  return b;
}

// Moves the multipliers as far towards `z` as they stay positive and releases the one that stops them (always one, so
// that rounding cannot keep this going); true when all the way.
bool advance(Held& held, const ParameterVector& z) {
  double step = 1.0;
  Eigen::Index stop = -1;
  for (Eigen::Index i = 0; i < held.count; ++i) {
    if (z(i) > 0.0) continue;
    const double reach = held.l(i) > 0.0 ? held.l(i) / (held.l(i) - z(i)) : 0.0;
    if (stop < 0 || reach < step) {
      step = reach;
      stop = i;
    }
  }
  if (stop < 0) {
    held.l = z;
    return true;
  }
  Eigen::Index kept = 0;
  for (Eigen::Index i = 0; i < held.count; ++i) {
    if (i == stop) continue;
    held.which[static_cast<std::size_t>(kept)] = held.which[static_cast<std::size_t>(i)];
    held.l(kept++) = std::max(0.0, held.l(i) + step * (z(i) - held.l(i)));
  }
  held.count = kept;
  held.l.conservativeResize(kept);
  return false;
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
  ParameterVector scale(n);  // sign over sigma: one tolerance fits all
  for (Eigen::Index i = 0; i < n; ++i) {
    const double sign = signs[static_cast<std::size_t>(i)];
    scale(i) = sign == 0.0 ? 0.0 : sign / std::sqrt(P(i, i));
  }
  Held held;
  held.l.resize(0);
  ParameterVector x = x_hat;
  for (Eigen::Index round = 0; round < 3 * n; ++round) {
    Eigen::Index worst = -1;
    double violation = kTolerance;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (-scale(i) * x(i) > violation && !held.has(i)) {
        violation = -scale(i) * x(i);
        worst = i;
      }
    }
    if (worst < 0) break;
    held.which[static_cast<std::size_t>(held.count++)] = worst;
    held.l.conservativeResize(held.count);
    held.l(held.count - 1) = 0.0;
    while (held.count > 0 && !advance(held, multipliers(x_hat, P, scale, held))) {
    }
    x = x_hat;
    for (Eigen::Index i = 0; i < held.count; ++i) {
      const Eigen::Index a = held.which[static_cast<std::size_t>(i)];
      x += (scale(a) * held.l(i)) * P.col(a);
    }
  }
  // Held ones are zero up to rounding; make the sign exact for those who check it.
  for (Eigen::Index i = 0; i < n; ++i) {
    if (held.has(i) || x(i) * signs[static_cast<std::size_t>(i)] < 0.0) x(i) = 0.0;
  }
  return x;
}

}  // namespace fathom::identification
