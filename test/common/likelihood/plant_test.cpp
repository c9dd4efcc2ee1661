// What a scan asks of one more effect is what the effect does.
#include "common/likelihood/plant.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "common/model/learned/learned_force.hpp"
#include "test/common/likelihood/noisy_dive.hpp"

using namespace fathom;
using namespace fathom::likelihood;

namespace {

/// The middle of a dive that the plain model flew.
struct Halfway {
  model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  test::VirtualDive dive = test::fly(vehicle, {.duration = 20.0});
  RunData run{dive.trial, vehicle, {}};
  std::size_t block = run.blocks().size() / 2;
  Vector6d nu{0.4, -0.2, 0.1, 0.05, -0.1, 0.3};
  Hypothesis plain{.model = dive.truth};
  Halfway() { plain.runs.resize(1); }
};

Vector6d acceleration_at(const Hypothesis& hypothesis, const RunData& run, std::size_t block, const Vector6d& nu) {
  const std::vector<Number> none;
  Plant plant{hypothesis, none, run, 0, false};
  plant.begin(run.start());
  plant.at_middle(block);
  return plant.acceleration(nu);
}

}  // namespace

TEST_CASE("plant: what an effect on the hull adds is the difference of the accelerations with and without it") {
  const auto [vehicle, dive, run, block, nu, hypothesis] = Halfway{};
  const model::Scene scene = model::scene_of(vehicle, {&dive.trial, 1});
  int asked = 0;
  for (const model::Effect* effect : model::all_effects()) {
    const std::vector<std::string> forms = effect->variants(scene);
    for (std::size_t v = 0; v < forms.size(); ++v) {
      if (forms[v] == "-") continue;
      model::ActiveEffect active{.effect = effect,
                                 .variant = static_cast<int>(v),
                                 .theta = effect->starts(scene, static_cast<int>(v)).front()};
      if (stage_of(active) != Stage::kHull) continue;
      CAPTURE(effect->name());
      CAPTURE(forms[v]);
      const std::vector<Number> none;
      Plant plant{hypothesis, none, run, 0, false};
      plant.begin(run.start());
      plant.at_middle(block);
      const Vector6d plain = plant.acceleration(nu);
      const Vector6d added = plant.added_by(active, plain, plant.inverse_inertia(nu, plain));
      Hypothesis with = hypothesis;
      with.model.add(active);
      const Vector6d whole = acceleration_at(with, run, block, nu) - plain;
      CHECK((added - whole).norm() <= 1e-9 + 1e-6 * whole.norm());
      // And it leaves the plant as it was.
      CHECK(plant.acceleration(nu) == plain);
      ++asked;
    }
  }
  CHECK(asked >= 10);
}

TEST_CASE("plant: a free force's stream pushes as water does, and its columns are its slopes") {
  const auto [vehicle, dive, run, block, nu, plain] = Halfway{};
  Hypothesis streams = plain;
  for (const int w : {0, 1}) {
    streams.force.features.push_back({.axis = model::kStream + w, .scale = 0.5});
    streams.force.groups.push_back({.axis = model::kStream + w, .first = w, .count = 1});
    streams.force.weights.push_back(0.3 - 0.4 * w);
  }
  Hypothesis told = plain;
  std::vector<double> theta(model::find_effect("current")->parameters().size(), 0.0);
  theta[0] = 0.15;
  theta[1] = -0.05;
  told.model.add({.effect = model::find_effect("current"), .theta = theta});
  const Vector6d here = acceleration_at(streams, run, block, nu);
  CHECK((here - acceleration_at(told, run, block, nu)).norm() < 1e-9);
  CHECK((here - acceleration_at(plain, run, block, nu)).norm() > 1e-3);

  // Water that swings has an acceleration besides.
  for (const int w : {0, 2}) {
    model::Feature swing{.axis = model::kStream + w, .count = 1, .scale = 0.2};
    swing.factors[0] = {.quantity = w == 0 ? model::Quantity::kToneCosine : model::Quantity::kToneSine, .a = 2.0};
    streams.force.groups.push_back(
        {.axis = swing.axis, .first = static_cast<int>(streams.force.features.size()), .count = 1});
    streams.force.features.push_back(swing);
    streams.force.weights.push_back(0.7);
  }
  std::vector<Number> numbers;
  for (int w = 0; w < 4; ++w) numbers.push_back({.kind = NumberKind::kWeight, .index = w});
  Plant plant{streams, numbers, run, 0, true};
  plant.begin(run.start());
  plant.at_middle(block);
  Columns columns(6, 4);
  plant.columns(block, nu, plant.acceleration(nu), columns);
  constexpr double kStep = 1e-3, kBend = 1e-3;  // of it, by what drag is bent over a step
  const model::FeatureState state = plant.features_at(nu, true);
  const Matrix6d inverse = plant.inverse_inertia(nu, plant.acceleration(nu));
  for (int w = 0; w < 4; ++w) {
    const auto at = static_cast<std::size_t>(w);
    Hypothesis more = streams, less = streams;
    more.force.weights[at] += kStep;
    less.force.weights[at] -= kStep;
    const Vector6d slope =
        (acceleration_at(more, run, block, nu) - acceleration_at(less, run, block, nu)) / (2.0 * kStep);
    CHECK((columns.col(w) - slope).norm() < kBend * slope.norm());
    // And what a screen is told of it.
    Vector6d wrench = Vector6d::Zero();
    streams.force.features[at].add(state, 1.0, wrench);
    CHECK((inverse * wrench - slope).norm() < kBend * slope.norm());
  }
}

TEST_CASE("plant: a free force's mass holds back as a load does that was taken up, and its column is its slope") {
  const auto [vehicle, dive, run, block, nu, plain] = Halfway{};
  Hypothesis loaded = plain, told = plain;
  model::Feature mass{.axis = model::kMass, .count = 1, .scale = 4.0};
  mass.factors[0] = {.quantity = model::Quantity::kAfter, .a = 3.0, .b = 0.3};
  loaded.force = {.features = {mass}, .groups = {{.axis = model::kMass, .count = 1}}, .weights = {0.75}};
  told.model.add({.effect = model::find_effect("payload_change"), .theta = {3.0, 0.0, 2.5}});
  const Vector6d here = acceleration_at(loaded, run, block, nu);
  CHECK((here - acceleration_at(told, run, block, nu)).norm() < 1e-12);
  CHECK((here - acceleration_at(plain, run, block, nu)).norm() > 1e-3);

  const std::vector<Number> numbers{{.kind = NumberKind::kWeight, .index = 0}};
  Plant plant{loaded, numbers, run, 0, true};
  plant.begin(run.start());
  plant.at_middle(block);
  Columns columns(6, 1);
  plant.columns(block, nu, plant.acceleration(nu), columns);
  constexpr double kStep = 1e-3;
  Hypothesis more = loaded, less = loaded;
  more.force.weights[0] += kStep;
  less.force.weights[0] -= kStep;
  const Vector6d slope =
      (acceleration_at(more, run, block, nu) - acceleration_at(less, run, block, nu)) / (2.0 * kStep);
  CHECK((columns.col(0) - slope).norm() < 1e-5 * slope.norm());  // to second order of the step
  // What a screen is told of it.
  Vector6d wrench = Vector6d::Zero();
  mass.add(plant.features_at(nu, true), 1.0, wrench);
  CHECK((plant.inverse_inertia(nu, plant.acceleration(nu)) * wrench - slope).norm() < 1e-5 * slope.norm());
}

TEST_CASE("plant: in a current a free force reads the velocity past the water, as the learned force does") {
  const auto [vehicle, dive, run, block, nu, plain] = Halfway{};
  Hypothesis hypothesis = plain;
  std::vector<double> theta(model::find_effect("current")->parameters().size(), 0.0);
  theta[0] = 0.25;
  theta[1] = -0.1;
  hypothesis.model.add({.effect = model::find_effect("current"), .theta = theta});
  const auto feature = [](int axis, std::initializer_list<model::Factor> factors) {
    model::Feature one{.axis = axis, .count = static_cast<int>(factors.size())};
    std::ranges::copy(factors, one.factors.begin());
    return one;
  };
  const model::Factor u{.quantity = model::Quantity::kVelocity, .index = 0},
      speed{.quantity = model::Quantity::kSpeed, .index = 0},
      slow{.quantity = model::Quantity::kSlowVelocity, .index = 1, .bank = 1};
  model::FreeForce& force = hypothesis.force;
  force.features = {feature(0, {u, speed}), feature(model::kHullDrag, {speed}), feature(1, {slow})};
  force.groups = {
      {.axis = 0, .count = 1}, {.axis = model::kHullDrag, .first = 1, .count = 1}, {.axis = 1, .first = 2, .count = 1}};
  force.weights = {-6.0, 0.4, -3.0};
  std::vector<Number> numbers;
  for (int w = 0; w < 3; ++w) numbers.push_back({.kind = NumberKind::kWeight, .index = w});
  Plant plant{hypothesis, numbers, run, 0, true};
  plant.begin(run.start());
  model::Motion start = plant.motion();
  plant.at_middle(0);
  const Vector6d here = plant.acceleration(nu);

  // The learned force that is made of it, on the same instant.
  model::Visited visited;
  visited.nu.setConstant(10.0);
  visited.tau.setConstant(1e3);
  visited.force = model::ActuatorForces::Constant(vehicle.allocation.cols(), 1e3);
  const model::LearnedForce learned{force, visited, hypothesis.model.allocation};
  model::Model model = hypothesis.model;
  model.add({.effect = &learned});
  model::Motion motion = plant.motion();
  for (model::Motion* each : {&start, &motion}) {
    each->v_WF_B.setZero();
    each->a_WF_B.setZero();
    each->w_memory.setZero();
  }
  motion.force = plant.mean_forces().col(0);
  std::vector<double> memory(static_cast<std::size_t>(model.memory_size()), 0.0);
  model::settle(model, start, memory);
  model::feel(model, motion, memory, 0.0);
  CHECK((here - model::acceleration(model, motion)).norm() < 1e-9);

  // Over the ground it would be another force; and its columns are its slopes.
  Hypothesis still = hypothesis;
  still.force.features = {feature(0, {u, speed})};
  still.force.groups.resize(1);
  still.force.weights.resize(1);
  Hypothesis none = still;
  none.force = {};
  Vector6d past = nu;
  past.head<3>() -= motion.R_WB.transpose() * Eigen::Vector3d(theta[0], theta[1], 0.0);
  const double share = (acceleration_at(still, run, 0, nu) - acceleration_at(none, run, 0, nu))[0] *
                       hypothesis.model.theta[0] / (-6.0 * past[0] * std::abs(past[0]));
  CHECK(share == doctest::Approx(1.0).epsilon(1e-6));
  Columns columns(6, 3);
  plant.columns(0, nu, here, columns);
  for (int w = 0; w < 3; ++w) {
    constexpr double kStep = 1e-3;
    Hypothesis more = hypothesis, less = hypothesis;
    more.force.weights[static_cast<std::size_t>(w)] += kStep;
    less.force.weights[static_cast<std::size_t>(w)] -= kStep;
    const Vector6d slope = (acceleration_at(more, run, 0, nu) - acceleration_at(less, run, 0, nu)) / (2.0 * kStep);
    CHECK((columns.col(w) - slope).norm() < 1e-5 * (slope.norm() + 1e-3));
  }
}
