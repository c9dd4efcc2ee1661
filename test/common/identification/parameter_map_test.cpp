// A model's free numbers as one scaled vector: nothing is lost on the way there and back, and physics sets the bounds.
#include "common/identification/trajectories/parameter_map.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::identification;

namespace {

constexpr double kRounding = 1e-14;  // relative: one division and one multiplication

struct Fixture {
  model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  model::Model model = model::nominal_model(vehicle, false);
  Fixture() {
    model.add(test::active("tether_tension", {1.5, 1.0, -2.0, 0.5, 0.0}));
    model.add(test::active("thruster_lag", {0.25}));
  }
};

}  // namespace

TEST_CASE("parameter map: pack and unpack are inverses, and touch nothing else") {
  const Fixture fixture;
  const ParameterMap map{fixture.model};
  const Eigen::VectorXd x = map.pack(fixture.model);
  CHECK(static_cast<std::size_t>(x.size()) == map.size());
  model::Model other = fixture.model;
  other.theta.array() *= 1.7;
  for (auto& effect : other.effects) {
    for (double& value : effect.theta) value += 3.0;
  }
  // A base parameter that the vehicle does not enable.
  const int fixed = model::index(model::BaseParameter::G_x);
  other.theta[fixed] = 42.0;
  map.unpack(x, other);
  CHECK(other.theta[fixed] == 42.0);
  other.theta[fixed] = fixture.model.theta[fixed];
  CHECK((other.theta - fixture.model.theta).norm() < kRounding * fixture.model.theta.norm());
  for (std::size_t e = 0; e < other.effects.size(); ++e) {
    for (std::size_t i = 0; i < other.effects[e].theta.size(); ++i) {
      CHECK(other.effects[e].theta[i] == doctest::Approx(fixture.model.effects[e].theta[i]).epsilon(kRounding));
    }
  }
  CHECK((map.pack(other) - x).norm() < kRounding * x.norm());
}

TEST_CASE("parameter map: base parameters come first, then the effects' numbers, each under its name and unit") {
  const Fixture fixture;
  const ParameterMap map{fixture.model};
  REQUIRE(map.size() == fixture.vehicle.parameters.size() + 10);
  for (std::size_t i = 0; i < fixture.vehicle.parameters.size(); ++i) {
    CHECK(map[i].name == fixture.vehicle.parameters[i]);
    CHECK(map[i].base >= 0);
    CHECK(map[i].prior_mean == fixture.vehicle.priors[i].mean);
    CHECK(map[i].prior_sigma == fixture.vehicle.priors[i].sigma);
  }
  // The registry's order: the lag acts before the tether, though it was added after it.
  const std::size_t first = fixture.vehicle.parameters.size();
  CHECK(map[first].name == "thruster_lag.time_constant");
  CHECK(map[first].unit == "s");
  CHECK(map[first + 2].name == "tether_tension.stiffness");
  CHECK(map[first + 6].name == "tether_tension.anchor_D");
  for (std::size_t i = first; i < map.size(); ++i) {
    CHECK(map[i].base == -1);
    CHECK(map[i].prior_mean == 0.0);  // absent, until the data says otherwise
  }
}

TEST_CASE("parameter map: scales are of the number's own size, and never nothing") {
  const Fixture fixture;
  const ParameterMap map{fixture.model};
  const Eigen::VectorXd x = map.pack(fixture.model);
  for (std::size_t i = 0; i < map.size(); ++i) {
    CAPTURE(map[i].name);
    CHECK(map[i].scale > 0.0);
    CHECK(std::abs(x[static_cast<Eigen::Index>(i)]) <= 1.0 + kRounding);
  }
  CHECK(x[x.size() - 4] == 0.0);  // anchor_D
}

TEST_CASE("parameter map: masses stay positive and drag takes power") {
  const Fixture fixture;
  const ParameterMap map{fixture.model};
  for (std::size_t i = 0; i < map.size(); ++i) {
    CAPTURE(map[i].name);
    if (map[i].name.starts_with("m_") || map[i].name.starts_with("I_")) CHECK(map[i].low > 0.0);
    if (map[i].name == "X_u" || map[i].name == "N_r|r|") CHECK(map[i].high == 0.0);
    if (map[i].name == "W-B") CHECK((std::isinf(map[i].low) && std::isinf(map[i].high)));
    if (map[i].name == "thruster_lag.time_constant") CHECK(map[i].low == 0.0);
  }
}

TEST_CASE("parameter map: a number that takes no part keeps its value, and no prior pulls at it") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  model::Model model = model::nominal_model(vehicle, false);
  constexpr int kExponential = 2;
  model.add(test::active("bottom_effect", {2.0, 0.0, 0.3, 1.25}, kExponential));
  const ParameterMap map{model};
  const std::size_t own = map.size() - 4;
  CHECK(map[own].sought);
  CHECK_FALSE(map[own + 1].sought);
  CHECK(map[own + 2].sought);
  CHECK(map[own + 2].prior_mean == 0.0);
  CHECK_FALSE(map[own + 3].sought);
  CHECK(map[own + 3].prior_mean == 1.25);
}

TEST_CASE("parameter map: two forms of one effect keep their numbers apart by name") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  model::Model model = model::nominal_model(vehicle, false);
  for (const auto& [variant, thruster] : {std::pair{0, "T0"}, {2, "T2"}}) {
    model::ActiveEffect gain = test::active("thruster_gain", {0.1}, variant);
    gain.variant_name = thruster;
    model.add(gain);
  }
  const ParameterMap map{model};
  REQUIRE(map.size() == vehicle.parameters.size() + 2);
  CHECK(map[map.size() - 2].name == "thruster_gain.T0.gain_change");
  CHECK(map[map.size() - 1].name == "thruster_gain.T2.gain_change");
}

TEST_CASE("parameter map: what a form leaves open as it is computed counts, of that form alone") {
  constexpr int kOffset = 0, kStep = 1;
  for (const int form : {kOffset, kStep}) {
    Fixture fixture;
    fixture.model.add(test::active("thruster_deadband", {2.0}, form));
    const ParameterMap map{fixture.model};
    int found = 0;
    for (std::size_t i = 0; i < map.size(); ++i) {
      if (map[i].name != "thruster_deadband.half_width") continue;
      // A flank of a hundredth of the width, anywhere within which the edge may lie.
      CHECK(map[i].form_sigma == doctest::Approx(form == kStep ? 0.02 / std::sqrt(12.0) : 0.0));
      ++found;
    }
    CHECK(found == 1);
  }
}
