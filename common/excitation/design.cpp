#include "common/excitation/design.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/base/factors.hpp"
#include "common/model/priors/wide_prior.hpp"
#include "common/model/regressor.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::excitation {
namespace {

constexpr double kStep = 0.05;      // s of the prediction
constexpr double kLightest = 0.2;   // share of the prior's size that a predicted drag keeps
constexpr double kPossible = 0.3;   // of the prior's size: no mass is less, as LeavingSettings::lightest_share
constexpr double kBendWorth = 0.5;  // a segment that the fence alters all the time is worth half of what it promises

double log_det(const Eigen::MatrixXd& matrix) {
  return SymmetricFactor{matrix}.pivots().array().max(std::numeric_limits<double>::min()).log().sum();
}

}  // namespace

Vector6d Segment::at(double t) const {
  Vector6d share = step;
  for (Eigen::Index axis = 0; axis < 6; ++axis) {
    if (switch_at[axis] > 0.0 && std::fmod(t, 2.0 * switch_at[axis]) >= switch_at[axis]) share[axis] = -share[axis];
    for (Eigen::Index k = 0; k < kSines; ++k) {
      if (amplitude(axis, k) == 0.0) continue;
      share[axis] += amplitude(axis, k) * std::sin(2.0 * std::numbers::pi * frequency(axis, k) * t + phase(axis, k));
    }
  }
  return share.cwiseMax(-1.0).cwiseMin(1.0);
}

bool Segment::moves(Eigen::Index axis) const { return step[axis] != 0.0 || !amplitude.row(axis).isZero(0.0); }

Information::Information(const model::Vehicle& vehicle, const Vector6d& noise)
    : dof_{vehicle.dof}, weight_{noise.cwiseAbs2().cwiseInverse()} {
  for (const std::string& name : vehicle.parameters)
    columns_.push_back(model::index(*model::parameter_from_name(name)));
  const auto n = static_cast<Eigen::Index>(columns_.size());
  matrix_ = Eigen::MatrixXd::Zero(n, n);
}

void Information::add(const Vector6d& nu_dot, const Vector6d& nu, const Eigen::Matrix3d& R_WB, double rows) {
  const model::BaseRegressor Y = model::base_regressor(nu_dot, nu, R_WB);
  for (Eigen::Index axis = 0; axis < 6; ++axis) {
    if (!dof_[static_cast<std::size_t>(axis)]) continue;
    const double weight = rows * weight_[axis];
    for (std::size_t j = 0; j < columns_.size(); ++j) {
      const double y = weight * Y(axis, columns_[j]);
      if (y == 0.0) continue;
      for (std::size_t i = 0; i < columns_.size(); ++i) {
        matrix_(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) += y * Y(axis, columns_[i]);
      }
    }
  }
}

Designer::Designer(const DesignSettings& settings, const model::Vehicle& vehicle, const Vector6d& largest,
                   std::uint64_t seed)
    : settings_{settings},
      vehicle_{vehicle},
      largest_{largest},
      random_{seed},
      model_{model::nominal_model(vehicle_, true)},
      information_{vehicle_, settings.noise} {
  model_.vehicle = &vehicle_;
}

std::vector<Segment> Designer::library() {
  std::vector<Segment> all;
  std::vector<int> axes;
  for (int axis = 0; axis < 6; ++axis) {
    if (vehicle_.dof[static_cast<std::size_t>(axis)] && largest_[axis] > 0.0) axes.push_back(axis);
  }
  const double T = settings_.duration;
  const auto multisine = [&](Segment& s, int axis) {
    for (Eigen::Index k = 0; k < Segment::kSines; ++k) {
      s.amplitude(axis, k) = random_.uniform(0.2, 0.8);
      s.frequency(axis, k) = random_.uniform(0.5 / T, settings_.highest_frequency);
      s.phase(axis, k) = random_.uniform(0.0, 2.0 * std::numbers::pi);
    }
  };
  const auto step = [&](Segment& s, int axis, double least) {
    s.step[axis] = random_.uniform(least, 1.0) * random_.sign();
    s.switch_at[axis] = random_.uniform(0.2, 0.7) * T;
  };
  for (int i = 0; i < settings_.draws; ++i) {
    Segment sines{.name = "multisine on all axes", .duration = T};
    Segment steps{.name = "steps on all axes", .duration = T};
    Segment full{.name = "full steps on all axes", .duration = T};
    Segment mixed{.name = "steps and multisines", .duration = T};
    for (const int axis : axes) {
      multisine(sines, axis);
      step(steps, axis, 0.3);
      step(full, axis, 0.95);
      if (random_.sign() > 0.0) {
        multisine(mixed, axis);
      } else {
        step(mixed, axis, 0.5);
      }
    }
    Segment single{.name = "steps on one axis", .duration = T};
    step(single, axes[static_cast<std::size_t>(i) % axes.size()], 0.7);
    for (const Segment* each : {&sines, &steps, &full, &mixed, &single}) all.push_back(*each);
  }
  return all;
}

bool Designer::predict(const Segment& segment, const StateEstimate& start, double turned, const Fence& fence,
                       const Eigen::Vector3d& trim_W, double& bent) {
  StateEstimate state = start;
  information_.clear();
  bent = 0.0;
  model::Motion motion{.vehicle = &vehicle_};
  motion.force = model::ActuatorForces::Zero(6);
  const double inertia = std::max(model_.theta[5], 0.01);
  const int steps = static_cast<int>(std::lround(segment.duration / kStep));
  for (int k = 0; k < steps; ++k) {
    const Eigen::Matrix3d R_WB = state.q_WB.toRotationMatrix();
    Vector6d tau = segment.at(k * kStep).cwiseProduct(largest_);
    tau.head<3>() += R_WB.transpose() * trim_W;
    const Fence::Bent allowed = fence.bend(tau, state, turned, model_.theta[0], inertia, largest_);
    bent += allowed.bent ? 1.0 / steps : 0.0;
    motion.R_WB = R_WB;
    motion.nu = state.nu;
    motion.force = allowed.tau;
    const Vector6d first = model::acceleration(model_, motion);
    motion.nu = state.nu + 0.5 * kStep * first;
    const Vector6d nu_dot = model::acceleration(model_, motion);
    information_.add(nu_dot, motion.nu, R_WB, settings_.rows_per_second * kStep);
    state.nu += kStep * nu_dot;
    state.p_WB += kStep * (R_WB * motion.nu.head<3>());
    state.q_WB = (state.q_WB * quaternion_from_rotation_vector(kStep * motion.nu.tail<3>())).normalized();
    turned += kStep * motion.nu[5];
    if (!state.nu.allFinite() || !fence.outside(state, turned).empty()) return false;
  }
  return fence.holds(state.p_WB, state.q_WB * state.nu.head<3>());
}

Segment Designer::next(const StateEstimate& state, double turned, const ModelEstimate& known, const Fence& fence,
                       const Eigen::Vector3d& trim_W) {
  const auto n = static_cast<Eigen::Index>(vehicle_.parameters.size());
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd scale(n);
  const bool whole = known.parameters.size() == vehicle_.parameters.size() &&
                     known.covariance.size() == static_cast<std::size_t>(n * n);
  if (whole) P = Eigen::Map<const Eigen::MatrixXd>(known.covariance.data(), n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const auto parameter = *model::parameter_from_name(vehicle_.parameters[k]);
    // Not what the vehicle file believes, but what any vehicle of this mass would have: the design must need no answer.
    const model::Prior ordinary = model::wide_prior(parameter, vehicle_);
    const double sigma = ordinary.sigma;
    if (!whole) P(i, i) = sigma * sigma;
    double value = whole ? known.parameters[k].value : ordinary.mean;
    scale[i] = std::max(std::abs(value), settings_.smallest_scale * sigma);
    // A model that is hardly known yet must still predict a finite motion.
    const double size = std::max(std::abs(ordinary.mean), settings_.smallest_scale * sigma);
    // Nor does a mass that nothing has count: so light a vehicle would leave the fence in every rehearsal, nothing
    // would be flown that could tell more of it, and it would stay.
    if (model::sign_constraint(parameter) > 0 && value < kPossible * size) value = size;
    if (model::sign_constraint(parameter) < 0) value = std::min(value, -kLightest * size);
    model_.theta[model::index(parameter)] = value;
  }
  // Scaled: parameters count by their relative uncertainty.
  const Eigen::MatrixXd scaled = scale.cwiseInverse().asDiagonal() * P * scale.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd before = inverse_symmetric(scaled + 1e-12 * Eigen::MatrixXd::Identity(n, n));
  const double log_before = log_det(before);
  const double sum_before = scaled.trace();

  std::vector<Segment> candidates = library();
  double best = -1.0;
  const Segment* chosen = nullptr;
  for (const Segment& candidate : candidates) {
    double bent = 0.0;
    if (!predict(candidate, state, turned, fence, trim_W, bent)) continue;
    const Eigen::MatrixXd after =
        before + Eigen::MatrixXd(scale.asDiagonal() * information_.matrix() * scale.asDiagonal());
    double gain = settings_.criterion == Criterion::kD ? 0.5 * (log_det(after) - log_before)
                                                       : sum_before - inverse_symmetric(after).trace();
    gain *= 1.0 - (1.0 - kBendWorth) * bent;
    if (gain > best) {
      best = gain;
      chosen = &candidate;
    }
  }
  gain_ = std::max(0.0, best);
  if (chosen != nullptr) return *chosen;
  return {.name = "none fits inside the fence: hold", .duration = 1.0};
}

}  // namespace fathom::excitation
