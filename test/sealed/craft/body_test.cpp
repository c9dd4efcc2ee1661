// The benchmark's own physics: energy, steady states, and agreement with the base model that it is meant to contain.
#include "test/sealed/craft/body.hpp"

#include <doctest/doctest.h>

#include "test/sealed/craft/base_model.hpp"

namespace fathom::sealed {
namespace {

constexpr double kStep = 0.005;        // s, that of the dives
constexpr double kIntegration = 1e-6;  // relative: error of Runge-Kutta steps over half a minute
constexpr double kExact = 1e-9;        // of a wrench: rounding of a least-squares solution
constexpr double kSettled = 1e-3;      // of a speed after more than ten time constants

const Mechanisms kNone;

Craft craft_of(Family family, std::uint64_t seed = 5) {
  Random random(seed, "test");
  return draw_craft(family, random);
}

Commands still(const Craft& craft, const Eigen::VectorXd& force) {
  Commands commands;
  commands.force.assign(1,
                        force.size() > 0 ? force : Eigen::VectorXd::Zero(static_cast<Eigen::Index>(craft.jets.size())));
  return commands;
}

State tumbling(const Body& body) {
  State state = body.at_rest({0.0, 0.0, 3.0}, 0.4);
  state.segment<6>(3) << 0.2, -0.15, 0.4, 0.5, -0.3, 0.2;
  state.segment<3>(9) << 0.3, -0.2, 0.6;
  return state;
}

void run(Body& body, const Commands& commands, double seconds, State& state) {
  const auto steps = static_cast<int>(std::lround(seconds / kStep));
  for (int i = 0; i < steps; ++i) body.step(i * kStep, kStep, commands, state);
}

class Stream : public Mechanism {
 public:
  Stream() : Mechanism("stream") {}
  [[nodiscard]] double first_guess() const override { return 1.0; }
  [[nodiscard]] double largest() const override { return 1.0; }
  [[nodiscard]] std::map<std::string, double> parameters() const override { return {}; }
  void water(double, const Eigen::Vector3d&, Water& water) const override { water.velocity += kVelocity; }
  inline static const Eigen::Vector3d kVelocity{0.2, -0.1, 0.0};
};

}  // namespace

TEST_CASE("sealed body: without thrust only drag changes the energy, and only downward") {
  for (const Family family : {Family::kHeavy, Family::kSlender, Family::kVectored}) {
    const Craft craft = craft_of(family);
    Body body(craft, kNone);
    const Commands commands = still(craft, {});
    State state = tumbling(body);
    double energy = body.energy(state);
    for (int i = 0; i < 4000; ++i) {
      body.step(0.0, kStep, commands, state);
      const double now = body.energy(state);
      REQUIRE(now < energy + 1e-12 * std::abs(energy));
      energy = now;
    }
    body.hull.linear.setZero();
    body.hull.quadratic.setZero();
    state = tumbling(body);
    const double begin = body.energy(state), scale = begin - body.energy(body.at_rest({0.0, 0.0, 3.0}, 0.0));
    for (int i = 0; i < 1000; ++i) body.step(0.0, kStep, commands, state);
    CHECK(std::abs(body.energy(state) - begin) < kIntegration * std::max(std::abs(scale), std::abs(begin)));
  }
}

TEST_CASE("sealed body: a steady push ends at the speed at which drag holds it") {
  Craft craft = craft_of(Family::kAft);
  craft.hull.net_weight = 0.0;
  Body body(craft, kNone);
  Eigen::VectorXd force(4);
  force << 3.0, 3.0, 0.0, 0.0;
  State state = body.at_rest({0.0, 0.0, 3.0}, 0.7);
  run(body, still(craft, force), 120.0, state);
  const double u = state[kSpeed], push = (craft.allocation() * force)[0];
  const double a = craft.hull.quadratic[0], b = craft.hull.linear[0];
  // The jets' height pitches the vehicle a little; 1 % is more than its cosine.
  CHECK(u == doctest::Approx((-b + std::sqrt(b * b + 4.0 * a * push)) / (2.0 * a)).epsilon(0.01));
}

TEST_CASE("sealed body: who weighs more than it displaces sinks, and a low centre of mass rights") {
  Craft craft = craft_of(Family::kHeavy);
  craft.hull.net_weight = 4.0;
  craft.hull.first_moment = {0.0, 0.0, 2.0};
  Body body(craft, kNone);
  State state = body.at_rest({0.0, 0.0, 3.0}, 0.0), rate = state;
  state[3] = 0.3;
  body.rate(0.0, state, still(craft, {}), rate);
  CHECK(rate[kSpeed + 2] > 0.0);
  CHECK(rate[kSpeed + 3] < 0.0);
  state[3] = 0.0;
  state[4] = 0.3;
  body.rate(0.0, state, still(craft, {}), rate);
  CHECK(rate[kSpeed + 4] < 0.0);
}

TEST_CASE("sealed body: whoever drifts with the water feels nothing, however it turns, and all drift at last") {
  Craft craft = craft_of(Family::kVectored);
  craft.hull.net_weight = 0.0;
  Mechanisms stream;
  stream.push_back(std::make_unique<Stream>());
  Body body(craft, stream);
  State state = body.at_rest({0.0, 0.0, 3.0}, 0.9);
  state.segment<3>(kSpeed) = turn_of(state.segment<3>(3)).transpose() * Stream::kVelocity;
  state[kSpeed + 5] = 0.4;
  run(body, still(craft, {}), 5.0, state);
  const Eigen::Vector3d with = turn_of(state.segment<3>(3)) * state.segment<3>(kSpeed);
  CHECK((with - Stream::kVelocity).norm() < kIntegration);
  state = body.at_rest({0.0, 0.0, 3.0}, 0.9);
  run(body, still(craft, {}), 400.0, state);
  const Eigen::Vector3d at_last = turn_of(state.segment<3>(3)) * state.segment<3>(kSpeed);
  CHECK((at_last - Stream::kVelocity).norm() < 10.0 * kSettled);
}

TEST_CASE("sealed body: without mechanisms the base model's equation holds, number by number") {
  // Two derivations of the same physics: mass matrices here, components of Kirchhoff's equations there.
  for (int family = 0; family < kFamilies; ++family) {
    const Craft craft = craft_of(static_cast<Family>(family), 11);
    const Site site{.half = {3.0, 3.0, 1.5}, .centre = {0.0, 0.0, 2.5}};
    const std::vector<Dive> runs{dive(craft, site, kNone, {}, {.length = 120.0, .seed = 3, .purpose = "test"})};
    REQUIRE(runs.front().sound);
    const BaseFit fit = fit_base(craft, runs);
    CAPTURE(craft.family);
    for (int i = 0; i < 6; ++i) CHECK(fit.residual[i] <= kExact * fit.applied[i]);
    const Eigen::VectorXd truth = base_values(craft, craft.hull);
    for (Eigen::Index j = 0; j < truth.size(); ++j) {
      CAPTURE(base_names(craft)[static_cast<std::size_t>(j)]);
      CHECK(fit.values[j] == doctest::Approx(truth[j]).epsilon(1e-6));
    }
  }
}

}  // namespace fathom::sealed
