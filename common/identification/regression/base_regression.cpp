#include "common/identification/regression/base_regression.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/error.hpp"
#include "common/model/actuators.hpp"
#include "common/model/parameters.hpp"
#include "common/model/regressor.hpp"

namespace fathom::identification {
namespace {

constexpr double kLongestGap = 0.5;  // s between neighbours
constexpr int kRounds = 20;
constexpr double kSettled = 1e-9;  // change, in the priors' sigmas
constexpr double kLargestPhi = 0.9999;

/// In this motion, which matters to rudders and weights.
Vector6d wrench_of(const Thrusters& one, const model::Vehicle& vehicle, const SmoothedState& state) {
  if (!one.force.empty() && static_cast<Eigen::Index>(one.force.size()) == vehicle.allocation.cols()) {
    const Eigen::Map<const Eigen::VectorXd> force{one.force.data(), static_cast<Eigen::Index>(one.force.size())};
    if (!vehicle.flow_matters && !vehicle.weight_moves) return vehicle.allocation * force;
    model::Motion motion{.R_WB = state.q_WB.toRotationMatrix(), .nu = state.nu, .vehicle = &vehicle};
    motion.force = force;
    return model::acting_wrench(vehicle, motion);
  }
  if (one.has_tau) return Eigen::Map<const Vector6d>(one.tau.data());
  throw InputError("THRUSTERS hold neither forces nor a wrench");
}

/// Adds a run's rows, axis by axis, in stretches of neighbours.
void add(const BaseRun& run, const model::Vehicle& vehicle, const std::vector<int>& columns, double rate,
         std::array<LaggedGram, 6>& grams) {
  const auto p = static_cast<Eigen::Index>(columns.size());
  std::vector<std::array<Eigen::RowVectorXd, 6>> stretch;
  const auto close = [&] {
    for (std::size_t axis = 0; axis < 6 && stretch.size() > 2; ++axis) {
      Eigen::MatrixXd z(static_cast<Eigen::Index>(stretch.size()), p + 1);
      for (std::size_t k = 0; k < stretch.size(); ++k) z.row(static_cast<Eigen::Index>(k)) = stretch[k][axis];
      grams[axis].add(z, static_cast<int>(2.0 * rate));
    }
    stretch.clear();
  };
  std::size_t input = 0;
  Utime last = 0;
  for (const SmoothedState& state : run.states) {
    if (last != 0 && seconds_between(last, state.utime) < 0.9 / rate) continue;
    if (last != 0 && seconds_between(last, state.utime) > kLongestGap) close();
    while (input + 1 < run.thrusters.size() && run.thrusters[input + 1].utime <= state.utime) ++input;
    if (input + 1 >= run.thrusters.size() || run.thrusters[input].utime > state.utime) continue;
    last = state.utime;
    const Thrusters &before = run.thrusters[input], &after = run.thrusters[input + 1];
    const double share = seconds_between(before.utime, state.utime) / seconds_between(before.utime, after.utime);
    const Vector6d from = wrench_of(before, vehicle, state);
    const Vector6d tau = from + share * (wrench_of(after, vehicle, state) - from);
    const model::BaseRegressor Y = model::base_regressor(state.nu_dot, state.nu, state.q_WB.toRotationMatrix());
    auto& rows = stretch.emplace_back();
    for (int axis = 0; axis < 6; ++axis) {
      Eigen::RowVectorXd& row = rows[static_cast<std::size_t>(axis)];
      row.resize(p + 1);
      for (Eigen::Index j = 0; j < p; ++j) row[j] = Y(axis, columns[static_cast<std::size_t>(j)]);
      row[p] = tau[axis];
    }
  }
  close();
}

}  // namespace

BaseFit fit_base(const model::Vehicle& vehicle, std::span<const BaseRun> runs, double rate) {
  std::vector<int> columns;
  for (const std::string& name : vehicle.parameters) {
    const auto parameter = model::parameter_from_name(name);
    if (!parameter) throw InputError(vehicle.name + ": no base parameter is called " + name);
    columns.push_back(model::index(*parameter));
  }
  const auto p = static_cast<Eigen::Index>(columns.size());
  const LaggedGram empty{p + 1};
  std::array<LaggedGram, 6> grams{empty, empty, empty, empty, empty, empty};
  for (const BaseRun& run : runs) add(run, vehicle, columns, rate, grams);

  BaseFit fit;
  Eigen::VectorXd mean(p), sigma(p);
  for (Eigen::Index j = 0; j < p; ++j) {
    mean[j] = vehicle.priors[static_cast<std::size_t>(j)].mean;
    sigma[j] = vehicle.priors[static_cast<std::size_t>(j)].sigma;
  }
  // Signs that physics wants (drag dissipates): what violates them most is held at zero, and the rest fitted again.
  Eigen::VectorXd held = Eigen::VectorXd::Zero(p);
  constexpr double kHeld = 1e12;  // information of a number that is held, in units of its prior's
  fit.sigma.setOnes();
  Eigen::VectorXd theta = mean;
  Eigen::MatrixXd covariance;
  for (int round = 0, settled = 0; round < kRounds * static_cast<int>(p); ++round) {
    // In units of the priors' sigmas, so that kilograms and Newtons weigh alike in the factor.
    Eigen::MatrixXd N = Eigen::MatrixXd::Identity(p, p);
    Eigen::VectorXd g = mean.cwiseQuotient(sigma);
    for (std::size_t axis = 0; axis < 6; ++axis) {
      const auto i = static_cast<Eigen::Index>(axis);
      if (!vehicle.dof[axis] || grams[axis].samples() == 0) continue;
      const Eigen::MatrixXd G = grams[axis].whitened(fit.phi[i]) / (fit.sigma[i] * fit.sigma[i]);
      N += sigma.asDiagonal() * G.topLeftCorner(p, p) * sigma.asDiagonal();
      g += sigma.cwiseProduct(G.col(p).head(p));
    }
    g = g.cwiseProduct(Eigen::VectorXd::Ones(p) - held);
    for (Eigen::Index j = 0; j < p; ++j) {
      if (held[j] == 0.0) continue;
      N.row(j).setZero();
      N.col(j).setZero();
      N(j, j) = kHeld;
    }
    const Eigen::LLT<Eigen::MatrixXd> factor{N};
    const Eigen::VectorXd next = sigma.cwiseProduct(factor.solve(g));
    covariance = sigma.asDiagonal() * factor.solve(Eigen::MatrixXd::Identity(p, p)) * sigma.asDiagonal();
    const double change = (next - theta).cwiseQuotient(sigma).norm();
    theta = next;
    Eigen::VectorXd c(p + 1);
    c << -theta, 1.0;
    for (std::size_t axis = 0; axis < 6; ++axis) {
      const auto i = static_cast<Eigen::Index>(axis);
      if (!vehicle.dof[axis] || grams[axis].samples() == 0) continue;
      const LaggedGram::Residual e = grams[axis].residual(c);
      fit.phi[i] = std::clamp(e.cross / std::max(e.lagged - e.first, 1e-300), -kLargestPhi, kLargestPhi);
      fit.sigma[i] = std::sqrt(std::max(c.dot(grams[axis].whitened(fit.phi[i]) * c), 1e-12) / grams[axis].samples());
    }
    if (++settled < 4 || (change > kSettled && settled < kRounds)) continue;
    settled = 0;
    Eigen::Index worst = -1;
    double most = 0.0;
    for (Eigen::Index j = 0; j < p; ++j) {
      const int sign = model::sign_constraint(static_cast<model::BaseParameter>(columns[static_cast<std::size_t>(j)]));
      const double wrong = -sign * theta[j] / std::sqrt(covariance(j, j));
      if (held[j] != 0.0 || wrong <= most) continue;
      most = wrong;
      worst = j;
    }
    if (worst < 0) break;
    held[worst] = 1.0;
  }
  for (Eigen::Index j = 0; j < p; ++j) {
    const auto parameter = static_cast<model::BaseParameter>(columns[static_cast<std::size_t>(j)]);
    fit.parameters.push_back({std::string{model::name(parameter)}, theta[j], std::sqrt(covariance(j, j)),
                              std::string{model::unit(parameter)}});
  }
  return fit;
}

}  // namespace fathom::identification
