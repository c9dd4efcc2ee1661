// The identifier on streams: the same numbers whatever the order of arrival, and the vehicle's own numbers in the end.
#include "common/identification/identifier.hpp"

#include <doctest/doctest.h>

#include <Eigen/LU>
#include <algorithm>
#include <functional>
#include <limits>
#include <random>
#include <variant>

#include "common/base/error.hpp"
#include "test/common/identification/karras_vehicle.hpp"

using namespace fathom;
using namespace fathom::identification;

namespace {

constexpr double kRounding = 1e-6;  // sigmas: forces are interpolated before or after they become a wrench

constexpr Utime kStart = 1'600'000'000'000'000;

// Four thrusters port, starboard, vertical, lateral (Karras et al., eq. 1.7 with the columns in this order).
Eigen::Matrix4d four_by_four() {
  Eigen::Matrix4d T;
  T << 1, 1, 0, 0,  //
      0, 0, 0, 1,   //
      0, 0, 1, 0,   //
      0.0475, -0.0475, 0, 0.05;
  return T;
}

model::Vehicle vehicle() {
  model::Vehicle v;
  v.name = "table";
  v.dof = {true, true, true, false, false, true};
  v.allocation = Eigen::Matrix<double, 6, Eigen::Dynamic>::Zero(6, 4);
  v.allocation.topRows(3) = four_by_four().topRows(3);
  v.allocation.row(5) = four_by_four().row(3);
  for (const std::string& name : test::kTableNames) {
    v.parameters.push_back(name);
    v.priors.push_back({.mean = 0.0, .sigma = 100.0});
  }
  return v;
}

IdentifierSettings settings() {
  IdentifierSettings s;
  s.noise_force = 0.1;
  s.noise_moment = 0.02;
  return s;
}

struct Event {
  Utime arrival{};
  std::variant<StateEstimate, Thrusters> sample;
};

// States at 20 Hz and thrusters at 25 Hz, never at the same instant, with a lost stretch in each and an invalid state.
std::vector<Event> events(double duration) {
  const std::vector<test::Truth> run = test::karras_run(duration, 0.005, 17);
  const Eigen::Matrix4d inverse = four_by_four().inverse();
  std::mt19937 engine{4};
  std::normal_distribution<double> normal{0.0, 0.003};
  std::vector<Event> list;
  for (std::size_t i = 0; i < run.size(); ++i) {
    const test::Truth& truth = run[i];
    const Utime utime = utime_after(kStart, truth.t);
    if (i % 10 == 0 && !(truth.t > 40.0 && truth.t < 42.0)) {
      StateEstimate state;
      state.utime = utime;
      state.q_WB = Eigen::AngleAxisd{truth.yaw, Eigen::Vector3d::UnitZ()};
      state.nu << truth.nu(0), truth.nu(1), truth.nu(2), 0.0, 0.0, truth.nu(3);
      for (int k = 0; k < 6; ++k) state.nu(k) += normal(engine);
      state.valid = i != 3000;
      list.push_back({utime, state});
    }
    if (i % 8 == 3 && !(truth.t > 60.0 && truth.t < 63.0)) {
      Thrusters thrusters;
      thrusters.utime = utime;
      const Eigen::Vector4d force = inverse * truth.tau;
      thrusters.force.assign(force.data(), force.data() + 4);
      list.push_back({utime, thrusters});
    }
  }
  return list;
}

std::vector<Event> arriving(std::vector<Event> list, const std::function<Utime(bool is_state, Utime)>& arrival) {
  for (Event& event : list) {
    event.arrival = arrival(std::holds_alternative<StateEstimate>(event.sample), event.arrival);
  }
  std::stable_sort(list.begin(), list.end(), [](const Event& a, const Event& b) { return a.arrival < b.arrival; });
  return list;
}

struct Run {
  std::vector<ModelEstimate> models;
  std::vector<Residual> residuals;
};

Run feed(Identifier& identifier, const std::vector<Event>& list) {
  Run run;
  for (const Event& event : list) {
    const Identifier::Output& out = std::visit(
        [&](const auto& sample) -> const Identifier::Output& { return identifier.step(sample); }, event.sample);
    run.models.insert(run.models.end(), out.models.begin(), out.models.end());
    run.residuals.insert(run.residuals.end(), out.residuals.begin(), out.residuals.end());
  }
  return run;
}

bool same(const Run& a, const Run& b) {
  if (a.models.size() != b.models.size() || a.residuals.size() != b.residuals.size()) return false;
  for (std::size_t i = 0; i < a.models.size(); ++i) {
    if (a.models[i].utime != b.models[i].utime || a.models[i].updates != b.models[i].updates) return false;
    if (a.residuals[i].utime != b.residuals[i].utime || a.residuals[i].wrench != b.residuals[i].wrench) return false;
    for (std::size_t k = 0; k < a.models[i].parameters.size(); ++k) {
      if (a.models[i].parameters[k].value != b.models[i].parameters[k].value) return false;
      if (a.models[i].parameters[k].std != b.models[i].parameters[k].std) return false;
    }
  }
  return true;
}

}  // namespace

TEST_CASE("identifier: the order of arrival changes nothing, to the last bit") {
  const std::vector<Event> list = events(100.0);
  Identifier direct{settings(), vehicle()};
  const Run expected = feed(direct, list);
  REQUIRE(expected.models.size() > 150);
  CHECK(direct.rejected().at("no input") > 50);
  CHECK(direct.rejected().at("state invalid") == 1);

  std::mt19937 engine{1};
  std::uniform_int_distribution<Utime> jitter{0, 450'000};
  Utime last_state = 0;
  Utime last_input = 0;
  const std::vector<std::function<Utime(bool, Utime)>> orders{
      [](bool is_state, Utime t) { return is_state ? t + 450'000 : t; },  // states late
      [](bool is_state, Utime t) { return is_state ? t : t + 450'000; },  // inputs late
      [&](bool is_state, Utime t) {                                       // bursts; each channel keeps its own order
        Utime& last = is_state ? last_state : last_input;
        return last = std::max(last, t + jitter(engine));
      }};
  for (const auto& order : orders) {
    Identifier identifier{settings(), vehicle()};
    const std::vector<Event> shuffled = arriving(list, order);
    CHECK(same(feed(identifier, shuffled), expected));
    IdentifierSettings hold = settings();
    hold.interpolate_input = false;
    Identifier a{hold, vehicle()};
    Identifier b{hold, vehicle()};
    CHECK(same(feed(a, shuffled), feed(b, list)));
  }
  direct.reset();
  CHECK(same(feed(direct, list), expected));
}

TEST_CASE("identifier: finds the vehicle's numbers and leaves a small residual") {
  constexpr double kMassTolerance = 0.03;
  Identifier identifier{settings(), vehicle()};
  const Run run = feed(identifier, events(300.0));
  const ModelEstimate& last = run.models.back();
  CHECK(last.updates > 4 * 500);
  REQUIRE(last.parameters.size() == 13);
  for (std::size_t i = 0; i < 13; ++i) {
    const NamedValue& p = last.parameters[i];
    CHECK(p.name == test::kTableNames[i]);
    if (i < 3) CHECK(std::abs(p.value / test::kTable[i] - 1.0) < kMassTolerance);
    CHECK_MESSAGE(std::abs(p.value - test::kTable[i]) < 4.0 * p.std, p.name);
  }
  CHECK(last.parameters[0].unit == "kg");
  constexpr double kLeft =
      0.1;  // N: 3 mm/s through the window is 0.02 N on 10 kg; commands of 10 N are explained to 1 %
  for (std::size_t i = run.residuals.size() / 2; i < run.residuals.size(); ++i) {
    CHECK(run.residuals[i].wrench.cwiseAbs().maxCoeff() < kLeft);
    CHECK(run.residuals[i].wrench(3) == 0.0);
    CHECK(run.residuals[i].utime < run.models[i].utime);  // centre of the window, not its end
  }
}

TEST_CASE("identifier: a wrench serves where forces are missing, and neither is refused") {
  Identifier identifier{settings(), vehicle()};
  Thrusters t;
  t.utime = kStart;
  identifier.step(t);
  CHECK(identifier.rejected().at("no force") == 1);
  t.has_tau = true;
  t.tau[0] = std::numeric_limits<double>::quiet_NaN();
  identifier.step(t);
  CHECK(identifier.rejected().at("not finite") == 1);
  t.tau[0] = 1.0;
  identifier.step(t);
  identifier.step(t);  // the same stamp twice
  CHECK(identifier.rejected().at("late") == 1);

  std::vector<Event> list = events(60.0);
  Identifier by_force{settings(), vehicle()};
  const Run expected = feed(by_force, list);
  for (Event& event : list) {
    if (auto* thrusters = std::get_if<Thrusters>(&event.sample)) {
      const Vector6d tau = vehicle().allocation * Eigen::Map<const Eigen::Vector4d>(thrusters->force.data());
      std::copy_n(tau.data(), 6, thrusters->tau.begin());
      thrusters->has_tau = true;
      thrusters->force.clear();
    }
  }
  Identifier by_wrench{settings(), vehicle()};
  const Run run = feed(by_wrench, list);
  REQUIRE(run.models.size() == expected.models.size());
  for (std::size_t k = 0; k < expected.models.back().parameters.size(); ++k) {
    CHECK(std::abs(run.models.back().parameters[k].value - expected.models.back().parameters[k].value) <
          kRounding * expected.models.back().parameters[k].std);
  }
}

TEST_CASE("identifier: a frozen parameter stays at its prior") {
  model::Vehicle v = vehicle();
  v.priors[9] = {.mean = -1.0594, .sigma = 0.5};
  Identifier identifier{settings(), v};
  CHECK(identifier.freeze("Y_v|v|"));
  CHECK_FALSE(identifier.freeze("K_p"));
  const Run run = feed(identifier, events(100.0));
  CHECK(run.models.back().parameters[9].value == -1.0594);
  CHECK(run.models.back().parameters[9].std >= 0.5 * (1.0 - 1e-12));
  CHECK(std::abs(run.models.back().parameters[0].value / test::kTable[0] - 1.0) < 0.03);
}

TEST_CASE("identifier: a vehicle without sense is refused in one line that names it") {
  model::Vehicle v = vehicle();
  v.parameters[3] = "X_uu";
  CHECK_THROWS_WITH_AS((Identifier{settings(), v}), doctest::Contains("unknown parameter 'X_uu'"), InputError);
  v = vehicle();
  v.priors[2].sigma = 0.0;
  CHECK_THROWS_WITH_AS((Identifier{settings(), v}), doctest::Contains("prior of m_Z"), InputError);
  v = vehicle();
  v.parameters.clear();
  CHECK_THROWS_AS((Identifier{settings(), v}), InputError);
}
