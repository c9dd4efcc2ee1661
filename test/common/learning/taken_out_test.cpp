// Listed effects that are taken out of the list: what is learned in their place does what they do, on data not fitted.
#include <doctest/doctest.h>

#include <algorithm>
#include <memory>

#include "test/common/learning/learned_case.hpp"

using namespace fathom;
using namespace fathom::learning;

namespace {

struct TakenOut {
  const char* name;
  int variant;
  std::vector<std::pair<std::size_t, double>> numbers;
  const char* words;  ///< in what is learned
  double of_base;     ///< most of the base model's error that is left
};

/// Where a dive goes that nothing disturbs.
struct NoisyDiveBox {
  test::NoisyDive settings;
  double north{-1e9}, width{};  // m
};
NoisyDiveBox where_it_goes() {
  NoisyDiveBox box{.settings = {.duration = 160.0, .seed = 11, .force = 0.01}};
  const test::VirtualDive dive = test::fly(test::bluerov(), box.settings);
  double south = 1e9;
  for (const Eigen::Vector3d& p : dive.trial.p_WB) {
    box.north = std::max(box.north, p.x());
    south = std::min(south, p.x());
  }
  box.width = box.north - south;
  return box;
}

model::Model base_of(const test::LearnedCase& dive) {
  return as_model(dive.conclusion.found.best.fit.hypothesis, dive.problem.input_step);
}
/// Open-loop error on the rest of the dive with what it is told, over another model's.
double over(const model::Model& other, const test::LearnedCase& dive, const Learned& learned,
            const std::shared_ptr<const model::LearnedForce>& told) {
  const model::Model with = as_model(learned.fit.hypothesis, dive.problem.input_step, told.get());
  return residual::error_over(other, with, {&dive.rest, 1}, residual::OpenLoop{}).value;
}

}  // namespace

TEST_CASE("taken out: a stream and a loss with speed are learned as what they are") {
  for (const TakenOut& one : {TakenOut{"current", 0, {{0, 0.15}, {1, -0.1}}, "a stream toward north", 0.3},
                              TakenOut{"thrust_loss", 0, {{0, 0.6}}, "all thrusters, by the speed of advance", 0.5}}) {
    CAPTURE(std::string{one.name});
    std::vector<double> theta(model::find_effect(one.name)->parameters().size(), 0.0);
    for (const auto& [place, value] : one.numbers) theta[place] = value;
    const test::LearnedCase dive{
        {.duration = 160.0,
         .seed = 11,
         .force = 0.01,
         .effects = {{.effect = model::find_effect(one.name), .variant = one.variant, .theta = theta}}},
        true,
        0.5};
    const Learned learned = dive.learned();
    test::show(one.name, learned.given);
    REQUIRE(learned.given.adopted);
    REQUIRE(learned.given.carried);
    CHECK(learned.given.words.find(one.words) != std::string::npos);
    const double over_base = over(base_of(dive), dive, learned, learned.elsewhere);
    MESSAGE(std::string{one.name} << ": " << over_base << " of the base model's error");
    CHECK(over_base < one.of_base);
  }
}

TEST_CASE("taken out: a dead band, with a step or without, is learned as a thrust curve that bends at its size") {
  constexpr double kSize = 1.0;  // N
  for (const auto& [variant, quantity] :
       {std::pair{0, model::Quantity::kThrustHeld}, {1, model::Quantity::kThrustBelow}}) {
    CAPTURE(variant);
    const model::Effect* effect = model::find_effect("thruster_deadband");
    std::vector<double> theta(effect->parameters().size(), 0.0);
    theta[0] = kSize;
    const test::LearnedCase dive{{.duration = 160.0,
                                  .seed = 11,
                                  .force = 0.01,
                                  .effects = {{.effect = effect, .variant = variant, .theta = theta}}},
                                 true,
                                 0.5};
    const Learned learned = dive.learned();
    test::show("dead band", learned.given);
    REQUIRE(learned.given.adopted);
    REQUIRE(learned.given.carried);
    const auto& factor = learned.given.terms.front().factors.front();
    CHECK(factor.quantity == model::word(quantity));
    CHECK(factor.a == doctest::Approx(kSize).epsilon(0.1));
    CHECK(over(dive.dive.truth, dive, learned, learned.elsewhere) < 1.3);
  }
}

TEST_CASE("taken out: a tether's drag is learned as one against the way, that goes with the distance to a point") {
  const NoisyDiveBox where = where_it_goes();
  test::NoisyDive settings = where.settings;
  // 30 N per m of line and (m/s)^2 at the middle of a tank is three times what the hull drags.
  settings.effects = {{.effect = model::find_effect("tether_drag"),
                       .variant = 0,
                       .theta = {30.0, where.north + 0.2 * where.width, 0.0, 0.0, 0.0, 0.0, 0.0}}};
  const test::LearnedCase dive{settings, true, 0.5};
  const Learned learned = dive.learned();
  test::show("tether's drag", learned.given);
  REQUIRE(learned.given.adopted);
  REQUIRE(learned.given.carried);
  CHECK(learned.given.words.find("drag against the way, of the speed, by the distance to a point") !=
        std::string::npos);
  const double over_truth = over(dive.dive.truth, dive, learned, learned.elsewhere);
  MESSAGE("tether's drag: " << over_truth << " of the truth's");
  CHECK(over_truth < 1.3);
}

TEST_CASE("taken out: a tether is learned as a pull toward where it is made fast, slack up to its length") {
  const NoisyDiveBox where = where_it_goes();
  const Eigen::Vector3d end{where.north + 0.3 * where.width, 0.0, -1.0};
  const double slack = 0.8 * where.width, stiffness = 8.0 / where.width;  // m, N/m
  test::NoisyDive settings = where.settings;
  settings.effects = {{.effect = model::find_effect("tether_tension"),
                       .variant = 0,
                       .theta = {stiffness, slack, end.x(), end.y(), end.z(), 0.0, 0.0, 0.0}}};
  const test::LearnedCase dive{settings, true, 0.5};
  const Learned learned = dive.learned();
  test::show("tether", learned.given);
  REQUIRE(learned.given.adopted);
  REQUIRE(learned.given.carried);
  CHECK(learned.given.words.find("a pull toward a point") != std::string::npos);
  const double over_base = over(base_of(dive), dive, learned, learned.elsewhere),
               over_truth = over(dive.dive.truth, dive, learned, learned.elsewhere);
  MESSAGE("tether: " << over_base << " of the base model's error, " << over_truth << " of the truth's");
  CHECK(over_base < 0.3);
  CHECK(over_truth < 1.3);
}

TEST_CASE("taken out: waves are learned as water that swings, and foretold beyond what was fitted") {
  // Cosine, sine m/s, bearing rad, frequency rad/s; orbital.
  const test::LearnedCase dive{
      {.duration = 300.0,
       .seed = 11,
       .force = 0.01,
       .effects = {{.effect = model::find_effect("wave"), .variant = 2, .theta = {0.08, 0.05, 0.6, 0.93}}}},
      true,
      0.6};
  const Learned learned = dive.learned(false);
  test::show("wave", learned.given);
  REQUIRE(learned.given.adopted);
  CHECK(learned.given.words.find("a swing of the water") != std::string::npos);
  CHECK(learned.given.words.find("a period of 6.76 s, 7") != std::string::npos);  // 2 pi / .93; 2 pi g / .93^2 = 71 m
  REQUIRE(learned.given.goes_on);
  const double over_base = over(base_of(dive), dive, learned, learned.later);
  MESSAGE("wave: " << over_base << " of the base model's error");
  CHECK(over_base < 0.25);  // .15 is the noise
}

TEST_CASE("taken out: drag that grows toward a wall is learned as drag near an edge, wherever the wall is") {
  const NoisyDiveBox box = where_it_goes();
  // Strength, bearing (north), distance, reach, at distance: three times the hull's drag at the edge.
  const std::vector<double> theta{3.0, 0.0, 0.0, box.width / 8.0, box.north};
  test::NoisyDive settings = box.settings;
  settings.effects = {{.effect = model::find_effect("wall_effect"), .variant = 3, .theta = theta}};
  const test::LearnedCase dive{settings, true, 0.5};
  const Learned learned = dive.learned();
  test::show("wall", learned.given);
  REQUIRE(learned.given.adopted);
  REQUIRE(learned.given.carried);
  CHECK(learned.given.words.find("near the north") != std::string::npos);
  const double over_base = over(base_of(dive), dive, learned, learned.elsewhere);
  MESSAGE("wall: " << over_base << " of the base model's error");
  CHECK(learned.given.held_out_carried < 0.6);
  CHECK(over_base < 0.75);  // the rest of the dive comes seldom so near
}

TEST_CASE("taken out: thrust that goes with the voltage is learned as that, and told to who logs it") {
  const auto sags = [](double t) { return 15.5 + 1.2 * std::sin(0.17 * t) - 0.004 * t; };  // V: load and use
  const test::LearnedCase dive{
      {.duration = 160.0,
       .seed = 11,
       .force = 0.01,
       .effects = {{.effect = model::find_effect("battery_sag"), .variant = 0, .theta = {2.0}}},
       .voltage = sags},
      true,
      0.5};
  const Learned learned = dive.learned();
  test::show("voltage", learned.given);
  REQUIRE(learned.given.adopted);
  REQUIRE(learned.given.carried);
  CHECK(learned.given.words.find("the whole thrust, by the voltage") != std::string::npos);
  const double over_truth = over(dive.dive.truth, dive, learned, learned.elsewhere);
  MESSAGE("voltage: " << over_truth << " of the truth's");
  CHECK(over_truth < 1.3);
}

TEST_CASE("taken out: a force that settles is learned with its time constant") {
  constexpr double kEnd = 0.5, kWithin = 30.0;  // m/s^2, s
  const auto fills = [](double t, const Vector6d&) {
    Vector6d nu_dot = Vector6d::Zero();
    nu_dot[2] = kEnd * -std::expm1(-t / kWithin);
    return nu_dot;
  };
  const test::LearnedCase dive{{.duration = 120.0, .seed = 11, .force = 0.01, .outside = fills}};
  const Learned learned = dive.learned();
  test::show("settling", learned.given);
  REQUIRE(learned.given.adopted);
  REQUIRE(learned.given.carried);
  CHECK(learned.given.words.find("growing with time, ever more slowly") != std::string::npos);
  CHECK(learned.given.held_out_carried < 0.3);
  const auto& factors = learned.given.terms.front().factors;
  const auto settling = std::ranges::find_if(factors, [](const CorrectionFactor& factor) {
    return factor.quantity == model::word(model::Quantity::kSettling);
  });
  REQUIRE(settling != factors.end());
  CHECK(settling->b == doctest::Approx(kWithin).epsilon(0.3));
}
