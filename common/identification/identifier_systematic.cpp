// What no residual shows: errors of the instruments that act like parameters, and the noise of the accelerations that
// the masses are learnt from. Known beforehand from settings, they move the report and widen its intervals; nothing of
// it is fed back into the recursion.
#include <algorithm>
#include <cmath>

#include "common/identification/identifier.hpp"

namespace fathom::identification {
namespace {

constexpr double kMostlyNoise = 0.5;   // share of what a mass was learnt from
constexpr double kDoubtOfNoise = 0.5;  // share of the correction: how well the noise of an estimated speed is known

}  // namespace

int Identifier::column(model::BaseParameter parameter) const {
  const auto at = std::ranges::find(parameters_, parameter);
  return at == parameters_.end() ? -1 : static_cast<int>(at - parameters_.begin());
}

// Noise in a regressor draws its parameter towards zero: the normal matrix A holds N too much, so that A x = b should
// be (A - N) x = b. To first order that is x + P N x (Stoica and Soderstrom 1982, bias-compensated least squares). N is
// on the masses alone, where noise is large beside the signal. How large: as the residual shows, were all of it so; at
// most as stated, since what the model lacks is in the residual too.
void Identifier::compensate(RecursiveReport& report) const {
  if (settings_.noise_acceleration <= 0.0) return;
  const RecursiveEstimator::State& s = estimator_.state();
  ParameterVector drawn = ParameterVector::Zero(report.estimate.size());
  for (int axis = 0; axis < 3; ++axis) {
    const int i = column(static_cast<model::BaseParameter>(axis));
    if (i < 0 || !(report.estimate(i) > 0.0)) continue;
    const double force =
        s.axes[static_cast<std::size_t>(axis)].variance - settings_.noise_force * settings_.noise_force;
    const double seen = std::sqrt(std::max(0.0, force)) / report.estimate(i);
    const double noise = std::min(seen, settings_.noise_acceleration);
    drawn(i) = noise * noise * s.derivatives(i) * report.estimate(i);
  }
  const ParameterVector correction = estimator_.covariance() * drawn;
  report.estimate += correction;
  for (Eigen::Index i = 0; i < report.estimate.size(); ++i) {
    if (report.active[static_cast<std::size_t>(i)]) report.estimate(i) = 0.0;
  }
  report.covariance += kDoubtOfNoise * kDoubtOfNoise * correction * correction.transpose();
}

ParameterMatrix Identifier::bend() const {
  const auto n = static_cast<Eigen::Index>(parameters_.size());
  return misfit_.any() ? ParameterMatrix{misfit_.bend(estimator_.covariance()).topLeftCorner(n, n)}
                       : ParameterMatrix{ParameterMatrix::Zero(n, n)};
}

// An axis that has hardly moved: where most of what a mass was learnt from is the noise of accelerations, as stated, it
// and the axis's drag are drawn to zero, and no residual shows it. Of a regressor with the share s of noise 1 - s of
// the parameter is left; nothing is left to know it by when all is noise, and then it is as unknown as it was.
void Identifier::doubt_unmoved(RecursiveReport& report) const {
  if (settings_.noise_acceleration <= 0.0) return;
  const RecursiveEstimator::State& s = estimator_.state();
  ParameterVector wider = ParameterVector::Ones(report.estimate.size());
  for (int axis = 0; axis < 3; ++axis) {
    const int mass = column(static_cast<model::BaseParameter>(axis));
    if (mass < 0 || !(s.information(mass) > 0.0)) continue;
    const double noise = std::pow(settings_.noise_acceleration, 2.0) * s.derivatives(mass) / s.information(mass);
    if (noise < kMostlyNoise) continue;
    for (const int each : {axis, 6 + axis, 12 + axis}) {
      const int i = column(static_cast<model::BaseParameter>(each));
      if (i < 0) continue;
      const double known = std::sqrt(report.covariance(i, i)), prior = estimator_.prior_sigma()(i);
      const double most = std::max(1.0, prior / known);
      wider(i) = noise < 1.0 ? std::min(most, (1.0 - kMostlyNoise) / (1.0 - noise)) : most;
    }
  }
  report.covariance = (wider.asDiagonal() * report.covariance * wider.asDiagonal()).eval();
}

// Velocities that are all off by the same share s explain every force as well with masses and linear drag divided by
// 1 + s, quadratic drag by its square: a direction in which data say nothing, known beforehand to `velocity_scale`.
// A heave speed that is off by a constant becomes, through linear drag, a weight: known to `velocity_offset`. An
// attitude that is off turns the moment of weight and buoyancy: known to `attitude_offset`.
void Identifier::add_systematic(RecursiveReport& report) const {
  using enum model::BaseParameter;
  const auto widen = [&](const ParameterVector& along) { report.covariance += along * along.transpose(); };
  const ParameterVector none = ParameterVector::Zero(report.estimate.size());
  ParameterVector along = none;
  for (std::size_t k = 0; k < parameters_.size(); ++k) {
    const model::BaseParameter parameter = parameters_[k];
    if (model::axis(parameter) > 2 || parameter >= W_B) continue;
    const auto i = static_cast<Eigen::Index>(k);
    along(i) = settings_.velocity_scale * (parameter >= X_uu ? 2.0 : 1.0) * report.estimate(i);
  }
  widen(along);
  if (column(Z_w) >= 0 && column(W_B) >= 0) {
    ParameterVector steady = none;
    steady(column(W_B)) = settings_.velocity_offset * report.estimate(column(Z_w));
    widen(steady);
  }
  for (const model::BaseParameter side : {G_x, G_y}) {
    if (column(side) < 0 || column(G_z) < 0) continue;
    ParameterVector tilted = none;
    tilted(column(side)) = settings_.attitude_offset * report.estimate(column(G_z));
    widen(tilted);
  }
  report.sigma = report.covariance.diagonal().cwiseSqrt();
}

}  // namespace fathom::identification
