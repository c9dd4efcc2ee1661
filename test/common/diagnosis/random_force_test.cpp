// A pilot holds a depth against a random force: depth then goes with the force, as a buoyancy would that changes with
// depth, and only the force's own past tells the two apart.
#include "common/diagnosis/random_force.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "common/diagnosis/moved.hpp"
#include "common/residual/force_residual.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::diagnosis;

namespace {

constexpr double kDt = 0.04, kDuration = 200.0;  // s

struct Dive {
  double random_force{};     ///< N, RMS
  double memory{1.5};        ///< s
  double compressibility{};  ///< N/m
};

const model::Vehicle& vehicle() {
  static const model::Vehicle kVehicle = test::vehicle_from_repository("seabotix_lbv150");
  return kVehicle;
}

model::Model base() {
  model::Model model = model::nominal_model(vehicle(), false);
  model.input_hold = 0.5;  // each input until the next
  return model;
}

/// Heave of the LBV150, integrated by itself, under a proportional pilot with excitation.
Trial fly(const Dive& dive, unsigned seed) {
  std::mt19937 random{seed};
  std::normal_distribution<double> normal;
  const auto number = [model = base()](model::BaseParameter name) { return model.theta[model::index(name)]; };
  const double m_Z = number(model::BaseParameter::m_Z), Z_w = number(model::BaseParameter::Z_w),
               Z_ww = number(model::BaseParameter::Z_ww), weight = number(model::BaseParameter::W_B);
  Trial trial;
  trial.name = "hold";
  trial.dt = trial.input_step = kDt;
  trial.observed = {true, true, true, true};
  double z = 0.0, w = 0.0, force = 0.0, level = 0.0;
  constexpr int kSubsteps = 10;
  const double h = kDt / kSubsteps, keep = std::exp(-h / dive.memory);
  for (int k = 0; k * kDt < kDuration; ++k) {
    if (k % 40 == 0) level = 6.0 * normal(random);
    const double thrust = level - 6.0 * z - weight;
    Vector6d nu = Vector6d::Zero();
    for (Eigen::Index i = 0; i < 6; ++i) nu[i] = 0.0025 * normal(random);
    nu[2] += w;
    trial.t.push_back(k * kDt);
    trial.p_WB.emplace_back(0.0, 0.0, z);
    trial.q_WB.push_back(Eigen::Quaterniond::Identity());
    trial.nu.push_back(nu);
    trial.input.emplace_back(Eigen::Vector4d{0.0, 0.0, thrust, 0.0});
    for (int s = 0; s < kSubsteps; ++s) {
      force = keep * force + dive.random_force * std::sqrt(1.0 - keep * keep) * normal(random);
      const double load = thrust + weight + force + dive.compressibility * z;
      w += h * (load + Z_w * w + Z_ww * w * std::abs(w)) / m_Z;
      z += h * w;
    }
  }
  trial.pose_valid.assign(trial.size(), 1);
  trial.velocity_valid = trial.rates_valid = trial.pose_valid;
  trial.nu_sigma.setConstant(0.0025);
  return trial;
}

/// As a fit has it to which every sample is unforeseen: what the base model leaves, on depth.
double seeming_compressibility(const Trial& trial) {
  const std::vector<Vector6d> left = wrench_residuals(base(), trial);
  double zz = 0.0, zr = 0.0, z = 0.0, r = 0.0, n = 0.0;
  for (std::size_t k = 0; k < trial.size(); ++k) {
    if (!std::isfinite(left[k][2])) continue;
    const double depth = trial.p_WB[k].z();
    zz += depth * depth, zr += depth * left[k][2], z += depth, r += left[k][2], n += 1.0;
  }
  return (zr - z * r / n) / (zz - z * z / n);
}

RandomForce::Answer asked(const Trial& trial, double compressibility) {
  const model::Model reference = base();
  model::Model with = reference;
  with.effects = {test::active("compressibility", {compressibility})};
  return RandomForce{reference, {&trial, 1}}.ask(with);
}

}  // namespace

TEST_CASE("random force: what it seems to be is nothing beside a memory, and would have shown") {
  double mean = 0.0;
  unsigned would_have_shown = 0;
  constexpr unsigned kSets = 30;
  for (unsigned seed = 1; seed <= kSets; ++seed) {
    const Trial trial = fly({.random_force = 1.5}, seed);
    const RandomForce::Answer answer = asked(trial, seeming_compressibility(trial));
    CAPTURE(seed);
    CHECK(answer.memory > 40.0);
    CHECK(answer.memory > 3.0 * answer.effect);
    CHECK(answer.both - answer.memory < 6.6);  // half of chi squared with one degree of freedom: 3 in 10000 beyond
    mean += (answer.both - answer.memory) / kSets;
    would_have_shown += asked(trial, 3.0).expected > 20.0 ? 1 : 0;
  }
  CHECK(mean < 1.5);  // .5 +- .13, were means over half a second foretold exactly by four of them
  CHECK(would_have_shown == kSets);
}

TEST_CASE("random force: a true effect outlasts a memory, beside a random force too") {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    CAPTURE(seed);
    const RandomForce::Answer alone = asked(fly({.compressibility = 3.0}, seed), 3.0);
    CHECK(alone.both - alone.memory > 0.2 * alone.effect);  // a slow force is foretold by its past too
    CHECK(alone.both - alone.memory > 40.0);
    const RandomForce::Answer beside = asked(fly({.random_force = 0.5, .compressibility = 4.0}, seed), 4.0);
    CHECK(beside.both - beside.memory > 15.0);
  }
}
