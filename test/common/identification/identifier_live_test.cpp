// What a live trial needs of the identifier: pauses by time stamp, metrics, residuals, an honest common scale, and a
// restart that goes on where the process was killed.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "common/identification/identifier.hpp"
#include "test/common/identification/karras_vehicle.hpp"

using namespace fathom;
using namespace fathom::identification;

namespace {

constexpr Utime kStart = 1'600'000'000'000'000;

model::Vehicle vehicle() {
  model::Vehicle v;
  v.name = "table";
  v.dof = {true, true, true, false, false, true};
  v.allocation = Eigen::Matrix<double, 6, Eigen::Dynamic>::Identity(6, 6);
  for (const std::string& name : test::kTableNames) {
    v.parameters.push_back(name);
    v.priors.push_back({.mean = 0.0, .sigma = 100.0});
  }
  return v;
}

IdentifierSettings settings() {
  IdentifierSettings s;
  s.window = 1.0;
  s.stride = 0.25;
  s.noise_force = 0.2;
  s.noise_moment = 0.02;
  s.from_zero = true;
  return s;
}

struct Streams {
  std::vector<StateEstimate> states;
  std::vector<Thrusters> thrusters;
};

// 20 Hz; `push` [N] acts on the vehicle and is not in the thrusters' account.
Streams streams(double duration, unsigned seed = 5, double push = 0.0, double scale = 1.0) {
  Streams all;
  std::mt19937 engine{seed};
  std::normal_distribution<double> normal{0.0, 0.003};
  for (const test::Truth& truth : test::karras_run(duration, 0.05, seed)) {
    const Utime utime = utime_after(kStart, truth.t);
    StateEstimate state{.utime = utime,
                        .q_WB = Eigen::Quaterniond{Eigen::AngleAxisd{truth.yaw, Eigen::Vector3d::UnitZ()}},
                        .valid = true};
    state.nu << scale * truth.nu(0), scale * truth.nu(1), scale * truth.nu(2), 0.0, 0.0, truth.nu(3);
    for (const int k : {0, 1, 2, 5}) state.nu(k) += normal(engine);
    all.states.push_back(state);
    Thrusters t{.utime = utime, .has_tau = true};
    t.tau = {truth.tau(0) - push, truth.tau(1), truth.tau(2), 0.0, 0.0, truth.tau(3)};
    all.thrusters.push_back(t);
  }
  return all;
}

void feed(Identifier& identifier, const Streams& all, double from, double to,
          const std::function<void(const ModelEstimate&)>& see = {}) {
  for (std::size_t k = 0; k < all.states.size(); ++k) {
    const double t = seconds_between(kStart, all.states[k].utime);
    if (t < from || t >= to) continue;
    (void)identifier.step(all.thrusters[k]);
    for (const auto& model : identifier.step(all.states[k]).models) {
      if (see) see(model);
    }
  }
}

double value(const ModelEstimate& model, const std::string& name) {
  for (const auto& p : model.parameters) {
    if (p.name == name) return p.value;
  }
  return std::nan("");
}

const ModeMetric& metric(const ModelEstimate& model, const std::string& mode) {
  return *std::find_if(model.modes.begin(), model.modes.end(), [&](const auto& m) { return m.mode == mode; });
}

}  // namespace

TEST_CASE("identifier: MODEL carries the paper's metrics, their scaled companions and the covariance") {
  Identifier identifier{settings(), vehicle()};
  const ModelEstimate before = identifier.model();
  CHECK(metric(before, "surge").sum == doctest::Approx(300.0));  // three parameters of P_0 = 100 I
  CHECK(metric(before, "heave").sum == doctest::Approx(400.0));  // W-B is heave's fourth
  CHECK(metric(before, "total").sum == doctest::Approx(1300.0));
  feed(identifier, streams(120.0), 0.0, 1e9);
  const ModelEstimate model = identifier.model();
  const auto P = identifier.estimator().covariance();
  CHECK(metric(model, "total").sum == doctest::Approx(P.trace()));
  CHECK(metric(model, "yaw").sum == doctest::Approx(P(3, 3) + P(7, 7) + P(11, 11)));
  REQUIRE(model.covariance.size() == 169);
  double scaled = 0.0;
  for (std::size_t i = 0; i < 13; ++i) {
    const NamedValue& p = model.parameters[i];
    CHECK(std::sqrt(model.covariance[i * 13 + i]) == doctest::Approx(p.std));
    scaled = std::max(scaled, p.std / std::abs(p.value));
  }
  CHECK(metric(model, "total").scaled == doctest::Approx(scaled));
  for (const int axis : {0, 1, 2, 5}) {
    CHECK(model.residual_ratio[axis] > 0.0);
    CHECK(model.residual_ratio[axis] < 1.0);  // the stated noise is generous here
    CHECK(std::abs(model.residual_mean[axis]) < 4.0);
  }
  CHECK(model.residual_ratio[3] == 0.0);
}

TEST_CASE("identifier: a pull that nobody declared shows in the residual's power, not in the metric") {
  Identifier plain{settings(), vehicle()}, pulled{settings(), vehicle()};
  const Streams clean = streams(120.0);
  Streams spoilt = clean;
  for (std::size_t k = 0; k < spoilt.thrusters.size(); ++k) {  // 3 N to and fro over 14 s
    spoilt.thrusters[k].tau[0] += 3.0 * std::sin(0.45 * seconds_between(kStart, spoilt.thrusters[k].utime));
  }
  feed(plain, clean, 0.0, 1e9);
  feed(pulled, spoilt, 0.0, 1e9);
  CHECK(metric(pulled.model(), "surge").sum == doctest::Approx(metric(plain.model(), "surge").sum));
  CHECK(pulled.model().residual_ratio[0] > 20.0);
  CHECK(pulled.model().residual_ratio[1] < 2.0);
}

TEST_CASE("identifier: EXCITATION pauses and resumes parameters by its time, whenever it arrives") {
  const Streams all = streams(60.0);
  std::vector<ModelEstimate> results;
  for (const double lateness : {0.0, 0.4}) {
    Identifier identifier{settings(), vehicle()};
    double frozen_value = std::nan("");
    feed(identifier, all, 0.0, 20.0 + lateness);
    identifier.hear(Excitation{.utime = utime_after(kStart, 20.0), .frozen = {"m_X", "X_u", "nobody's"}});
    feed(identifier, all, 20.0 + lateness, 40.0 + lateness, [&](const ModelEstimate& model) {
      if (seconds_between(kStart, model.utime) < 22.0) return;
      CHECK(model.frozen.size() == 3);
      if (std::isnan(frozen_value)) frozen_value = identifier.estimator().unconstrained()(0);
      CHECK(identifier.estimator().unconstrained()(0) == frozen_value);
    });
    identifier.hear(Excitation{.utime = utime_after(kStart, 40.0)});
    feed(identifier, all, 40.0 + lateness, 1e9);
    CHECK(identifier.estimator().unconstrained()(0) != frozen_value);
    CHECK(identifier.model().frozen.empty());
    results.push_back(identifier.model());
  }
  for (std::size_t i = 0; i < 13; ++i) {
    CHECK(results[0].parameters[i].value == results[1].parameters[i].value);
    CHECK(results[0].parameters[i].std == results[1].parameters[i].std);
  }
}

TEST_CASE("identifier: a process that was killed goes on where it was, but for the windows it lost") {
  const Streams all = streams(120.0);
  Identifier whole{settings(), vehicle()};
  feed(whole, all, 0.0, 1e9);
  Identifier first{settings(), vehicle()};
  feed(first, all, 0.0, 60.0);
  const std::string saved = first.save_text();
  Identifier second{settings(), vehicle()};
  second.offer(saved, 120.0);
  feed(second, all, 62.0, 1e9);  // two seconds until it was back
  CHECK(second.resumed());
  const ModelEstimate a = whole.model(), b = second.model();
  CHECK(b.updates > a.updates - 60);
  for (std::size_t i = 0; i < 13; ++i) {
    CAPTURE(a.parameters[i].name);
    CHECK(std::abs(a.parameters[i].value - b.parameters[i].value) < 1.96 * a.parameters[i].std);
    CHECK(b.parameters[i].std < 1.2 * a.parameters[i].std);
  }
  // To the last bit when nothing was lost.
  Identifier copy{settings(), vehicle()};
  copy.offer(saved, 120.0);
  feed(copy, all, 60.0, 60.04);
  CHECK(copy.save_text() == saved);
}

TEST_CASE("identifier: a saved state of another time, another vehicle, or a damaged one is left alone") {
  const Streams all = streams(30.0);
  Identifier first{settings(), vehicle()};
  feed(first, all, 0.0, 1e9);
  const std::string saved = first.save_text();
  const auto takes = [&](const std::string& text, const model::Vehicle& v, double within) {
    Identifier identifier{settings(), v};
    identifier.offer(text, within);
    feed(identifier, streams(32.0), 30.5, 1e9);
    return identifier.resumed();
  };
  CHECK(takes(saved, vehicle(), 10.0));
  CHECK_FALSE(takes(saved, vehicle(), 0.1));  // too long ago
  model::Vehicle other = vehicle();
  std::swap(other.parameters[0], other.parameters[1]);
  CHECK_FALSE(takes(saved, other, 10.0));
  CHECK_FALSE(takes(saved.substr(0, saved.size() / 2), vehicle(), 10.0));
  CHECK_FALSE(takes("rubbish\n1 2 3", vehicle(), 10.0));
  Identifier newer{settings(), vehicle()};
  newer.offer("fathom identifier 4" + saved.substr(saved.find('\n')), 10.0);
  feed(newer, streams(32.0), 30.5, 1e9);
  CHECK_FALSE(newer.resumed());
  CHECK(newer.rejected().at("saved state of another version") == 1);
  std::string poisoned = saved;
  poisoned.replace(poisoned.find("0x"), 4, "nan ");
  CHECK_FALSE(takes(poisoned, vehicle(), 10.0));
  // A log replayed from its start: the file is from later.
  Identifier replay{settings(), vehicle()};
  replay.offer(saved, 1e6);
  feed(replay, all, 0.0, 5.0);
  CHECK_FALSE(replay.resumed());
}

TEST_CASE("identifier: velocities that are all half a percent high leave no residual, so the intervals must know") {
  auto blind = settings();
  blind.noise_force = 0.05;
  auto knowing = blind;
  knowing.velocity_scale = 0.005;
  const Streams high = streams(200.0, 5, 0.0, 1.01);
  Identifier a{blind, vehicle()}, b{knowing, vehicle()};
  feed(a, high, 0.0, 1e9);
  feed(b, high, 0.0, 1e9);
  const auto off = [](const ModelEstimate& model) {
    return std::abs(value(model, "m_X") - test::kTable[0]) / model.parameters[0].std;
  };
  CHECK(off(a.model()) > 3.0);
  CHECK(off(b.model()) < 3.0);
  CHECK(b.model().parameters[12].std == doctest::Approx(a.model().parameters[12].std));  // W-B has no velocity in it
}

TEST_CASE("identifier: a heave speed that is off all the time becomes a weight, which the interval must know") {
  auto blind = settings();
  blind.noise_force = 0.05;
  auto knowing = blind;
  knowing.velocity_offset = 0.004;
  Streams off = streams(200.0);
  for (StateEstimate& state : off.states) state.nu[2] += 0.008;
  Identifier a{blind, vehicle()}, b{knowing, vehicle()};
  feed(a, off, 0.0, 1e9);
  feed(b, off, 0.0, 1e9);
  const auto deviations = [](const ModelEstimate& model) {
    return std::abs(value(model, "W-B") - test::kTable[12]) / model.parameters[12].std;
  };
  CHECK(deviations(a.model()) > 3.0);
  CHECK(deviations(b.model()) < 3.0);  // two standard deviations by construction
  for (std::size_t i = 0; i < 12; ++i) CHECK(b.model().parameters[i].std == a.model().parameters[i].std);
}

TEST_CASE("identifier: noise of the accelerations draws masses to zero; where it is stated it is given back") {
  // White noise of 3 cm/s at 20 Hz: by the regressor's own account 44 sigma^2 dt / T^3, 4.5 cm/s^2 in a window of 1 s.
  Streams noisy = streams(300.0);
  std::mt19937 engine{11};
  std::normal_distribution<double> normal{0.0, 0.03};
  for (StateEstimate& state : noisy.states) {
    for (const int k : {0, 1, 2}) state.nu(k) += normal(engine);
  }
  auto blind = settings();
  blind.noise_force = 0.01;  // all of the residual is the acceleration's
  auto knowing = blind;
  knowing.noise_acceleration = 0.06;
  model::Vehicle sized = vehicle();
  for (std::size_t i = 0; i < 4; ++i) sized.priors[i].mean = test::kTable[i];
  Identifier a{blind, sized}, b{knowing, sized};
  feed(a, noisy, 0.0, 1e9);
  feed(b, noisy, 0.0, 1e9);
  for (std::size_t i = 0; i < 3; ++i) {
    const double truth = test::kTable[i];
    const double drawn = truth - a.model().parameters[i].value, left = truth - b.model().parameters[i].value;
    CAPTURE(i);
    CAPTURE(drawn);
    CAPTURE(left);
    CHECK(drawn > 0.007 * truth);
    CHECK(std::abs(left) < 0.3 * drawn);
    CHECK(std::abs(left) < 2.5 * b.model().parameters[i].std);
  }
  // Only as much as the residual shows: without the noise the statement alone changes next to nothing.
  Identifier c{knowing, sized};
  feed(c, streams(300.0), 0.0, 1e9);
  for (std::size_t i = 0; i < 3; ++i)
    CHECK(c.model().parameters[i].value == doctest::Approx(test::kTable[i]).epsilon(0.005));
}

TEST_CASE("identifier: settings for the paper's vehicle grow with the mass that is expected") {
  auto s = settings();
  s.noise_acceleration = 0.1;
  s.noise_force = 0.3;
  model::Vehicle heavy = vehicle();
  for (std::size_t i = 0; i < 3; ++i) heavy.priors[i].mean = 4.0 * test::kTable[i];
  const ModelEstimate light = Identifier{s, vehicle()}.model(), start = Identifier{s, heavy}.model();
  CHECK(metric(start, "surge").sum == doctest::Approx(16.0 * metric(light, "surge").sum));
  CHECK(metric(start, "yaw").sum == doctest::Approx(metric(light, "yaw").sum));
  // A window's noise on X: 0.3 N and 0.1 m/s^2 times 39 kg; the other axes, with other masses, hardly matter to it.
  Identifier identifier{s, heavy};
  feed(identifier, streams(60.0), 0.0, 1e9);
  auto alone = s;
  alone.noise_acceleration = 0.0;
  alone.noise_force = std::hypot(0.3, 0.1 * 4.0 * test::kTable[0]);
  Identifier same{alone, heavy};
  feed(same, streams(60.0), 0.0, 1e9);
  CHECK(metric(identifier.model(), "surge").sum == doctest::Approx(metric(same.model(), "surge").sum).epsilon(0.01));
}

TEST_CASE("identifier: a held input is right to the half step, wherever between the states it jumps") {
  // 100 Hz states, a force that jumps at or behind state times and holds: trapezoids would be half a step off.
  for (const double behind : {0.0, 0.0002, 0.003, 0.0098}) {
    CAPTURE(behind);
    auto s = settings();
    s.interpolate_input = false;
    s.noise_force = 0.05;
    s.max_gap = 0.1;
    Identifier identifier{s, vehicle()};
    const double m = 10.0, d = -12.0, dt = 0.01;
    std::mt19937 engine{3};
    double u = 0.0, force = 0.0;
    for (int k = 0; k < 12'000; ++k) {
      const Utime utime = utime_after(kStart, k * dt);
      StateEstimate state{.utime = utime, .valid = true};
      state.nu[0] = u;
      (void)identifier.step(state);
      const auto hold = [&](double seconds) {  // exact for a held force
        const double settled = -force / d;
        u = settled + (u - settled) * std::exp(d / m * seconds);
      };
      hold(behind);
      if (k % 37 == 0) force = std::uniform_real_distribution<double>{-8.0, 8.0}(engine);
      hold(dt - behind);
      Thrusters t{.utime = utime_after(utime, behind), .has_tau = true};
      t.tau[0] = force;
      (void)identifier.step(t);
    }
    CHECK(value(identifier.model(), "m_X") == doctest::Approx(m).epsilon(0.002));
    CHECK(value(identifier.model(), "X_u") == doctest::Approx(d).epsilon(0.01));
  }
}
