#include "common/identification/misfit.hpp"

#include <algorithm>
#include <cmath>

namespace fathom::identification {

Misfit::Misfit(Eigen::Index parameters) { state_.information.fill(ParameterVector::Zero(parameters)); }

void Misfit::take(const Row& row, double square, bool fails) {
  const auto axis = static_cast<std::size_t>(row.axis);
  state_.information[axis] += row.h.cwiseAbs2() / row.variance;
  double& excess = state_.excess[row.axis];
  if (fails) excess = std::max(0.0, excess + square - 1.0);
}

void Misfit::forget(double keep) {
  state_.excess *= keep;
  for (ParameterVector& information : state_.information) information *= keep;
}

// A wrench d that is missing moves the estimate by P sum(h d / variance). For one parameter that is, by Cauchy and
// Schwarz, at most the square root of P_ii times sum(d^2 / variance): reached when d looks like what the parameter
// does. Of d the residual shows the part that no parameter imitates. Taken for the part that they do, and for one
// standard deviation, it is what was measured with effects hidden (decision 083). Each axis counts by its share in what
// is known of the parameter.
ParameterMatrix Misfit::bend(const ParameterMatrix& nominal) const {
  ParameterVector told = ParameterVector::Zero(nominal.rows()), bent = told;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    told += state_.information[axis];
    bent += state_.excess[static_cast<Eigen::Index>(axis)] * state_.information[axis];
  }
  for (Eigen::Index i = 0; i < bent.size(); ++i) bent(i) = told(i) > 0.0 ? std::sqrt(bent(i) / told(i)) : 0.0;
  return bent.asDiagonal() * nominal * bent.asDiagonal();
}

}  // namespace fathom::identification
