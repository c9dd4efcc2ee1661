// The simulated vehicle as a whole: what physics says by hand, time, seeds, and what may not depend on what.
#include "common/simulation/simulator.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>

#include "common/base/error.hpp"
#include "test/support/dive_site.hpp"

using namespace fathom;
using namespace fathom::simulation;

namespace {

constexpr Utime kOrigin = 1'700'000'000'000'000;

// Bytes of a sample that two runs must share.
void put(std::string& bytes, const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); }
void put(std::string& bytes, const Eigen::Ref<const Eigen::VectorXd>& v) {
  for (const double x : v) put(bytes, &x, sizeof x);
}
std::string bytes_of(const Sample& sample) {
  std::string bytes;
  std::visit(
      [&](const auto& s) {
        put(bytes, &s.utime, sizeof s.utime);
        using T = std::decay_t<decltype(s)>;
        if constexpr (std::is_same_v<T, Ahrs>) {
          put(bytes, s.w_WB_B);
          put(bytes, s.f_B);
          put(bytes, s.q_WB.coeffs());
        } else if constexpr (std::is_same_v<T, Dvl>) {
          put(bytes, s.v_WB_B);
        } else if constexpr (std::is_same_v<T, Depth>) {
          put(bytes, &s.z, sizeof s.z);
        } else if constexpr (std::is_same_v<T, Usbl>) {
          put(bytes, s.p_WB);
        } else if constexpr (std::is_same_v<T, Truth>) {
          put(bytes, s.p_WB);
          put(bytes, s.nu);
          put(bytes, s.nu_dot);
        } else if constexpr (std::is_same_v<T, TagPose>) {
          put(bytes, s.p_CT);
          put(bytes, s.q_CT.coeffs());
        } else if constexpr (std::is_same_v<T, OpticalFlow>) {
          put(bytes, s.flow_C);
        } else if constexpr (std::is_same_v<T, LaserRange>) {
          put(bytes, s.p_CL);
        } else if constexpr (std::is_same_v<T, Thrusters>) {
          put(bytes, s.tau.data(), sizeof s.tau);
        }
      },
      sample);
  return bytes;
}

// A lively run: every kind of sample, commands that change.
std::vector<std::string> lively(Simulator& simulator, double seconds, std::size_t kinds) {
  std::vector<std::string> streams(kinds);
  const Utime end = utime_after(simulator.now(), seconds);
  while (simulator.now() < end) {
    const double t = seconds_between(kOrigin, simulator.now());
    Vector6d tau = Vector6d::Zero();
    tau << 6.0 * std::sin(2.0 * t), 4.0 * std::cos(1.3 * t), 1.2 + std::sin(t), 0.0, 0.0, 0.4 * std::sin(0.7 * t);
    simulator.command({.utime = simulator.now(), .tau = tau, .life = 0.5});
    for (const Sample& sample : simulator.step()) streams[sample.index()] += bytes_of(sample);
  }
  return streams;
}

constexpr std::size_t kKinds = std::variant_size_v<Sample>;

}  // namespace

TEST_CASE("simulator: the LBV150 floats up at the paper's rate and comes to rest at the surface") {
  // Table 1.1: |W-B| = 17.1828 w + 3.6482 w^2 at w = 0.0682 m/s; 1.5 m then take 22 s.
  auto deep = test::make_simulator("seabotix_lbv150", "deep", {});
  static_cast<void>(test::run<Truth>(*deep, 5.0));
  const double below = deep->moment().p_WB.z();
  static_cast<void>(test::run<Truth>(*deep, 22.0));
  CHECK(std::abs(deep->moment().nu[2] + 0.0682) < 2e-4);
  CHECK(std::abs(below - deep->moment().p_WB.z() - 1.5) < 0.01);

  auto tank = test::make_simulator("seabotix_lbv150", "tank", {});
  static_cast<void>(test::run<Truth>(*tank, 40.0));
  const Moment rest = tank->moment();
  CHECK(rest.nu.norm() < 1e-3);
  // Floating: what emerges weighs as much as the excess buoyancy, 1.1881 N of 107.9 N over 0.254 m of height.
  CHECK(std::abs(rest.p_WB.z() - (0.127 - 1.1881 / 107.91 * 0.254)) < 1e-4);
  CHECK(tank->contacts().surface == 1);
  CHECK(tank->contacts().walls == 0);
}

TEST_CASE("simulator: a steady thrust gives the speed at which drag balances it") {
  // 12 N of surge: 8.604 u + 17.8534 u^2 = 12 at u = 0.6135 m/s. Deep water, no wall in the way.
  auto simulator = test::make_simulator("seabotix_lbv150", "deep", {});
  Vector6d tau = Vector6d::Zero();
  tau[0] = 12.0;
  static_cast<void>(test::run<Truth>(*simulator, 30.0, tau));
  const Moment moment = simulator->moment();
  CHECK(std::abs(moment.nu[0] - 0.6135) < 5e-3);  // it also rises slowly, which tilts it a little
}

TEST_CASE("simulator: a step ten times shorter gives the same way within a millimetre, contacts and roll included") {
  const auto end_of = [](const std::string& step) {
    auto simulator = test::make_simulator("seabotix_lbv150", "tank", {.hide = {"thruster_lag=time_constant:0.15"}},
                                          {{"step: 2.5 ms", "step: " + step}});
    static_cast<void>(lively(*simulator, 20.0, kKinds));
    return simulator->moment();
  };
  const Moment coarse = end_of("2.5 ms"), fine = end_of("0.2 ms");
  CHECK((coarse.p_WB - fine.p_WB).norm() < 1e-3);
  CHECK((coarse.nu - fine.nu).norm() < 2e-3);
  CHECK(std::abs(fine.nu[3]) + std::abs(fine.R_WB(2, 1)) > 1e-4);  // it does roll
}

TEST_CASE("simulator: released with a list it swings in roll as its righting moment says, and the swing dies") {
  // omega = sqrt(G_z / I_X) = sqrt(3.2 / 0.2) = 4 rad/s, a little less by the drag: half a period is 0.79 s.
  auto simulator = test::make_simulator("seabotix_lbv150", "deep", {}, {{"G_y: 0 N m", "G_y: 0.6 N m"}});
  double first = 0.0, later = 0.0;
  for (int tick = 0; tick < 1000; ++tick) {
    simulator->step();
    const double p = std::abs(simulator->moment().nu[3]);
    (tick < 100 ? first : later) = std::max(tick < 100 ? first : (tick < 900 ? 0.0 : later), p);
  }
  CHECK(first > 0.2);
  CHECK(later < 1e-3);
}

TEST_CASE("simulator: a command acts one interval after the samples that it answers, and what was applied is told") {
  auto simulator = test::make_simulator("seabotix_lbv150", "deep", {});
  std::vector<Thrusters> told;
  Vector6d tau = Vector6d::Zero();
  tau[0] = 40.0;  // 20 N from each of two: 13 N is the limit
  test::collect(simulator->step(), told);
  simulator->command({.utime = simulator->now(), .tau = tau, .life = 0.1});
  for (int i = 0; i < 8; ++i) test::collect(simulator->step(), told);
  REQUIRE(told.size() == 9);
  for (std::size_t k = 0; k < told.size(); ++k) CHECK(told[k].utime == kOrigin + static_cast<Utime>(20'000 * k));
  CHECK(told[0].tau[0] == 0.0);
  CHECK(told[1].tau[0] == 0.0);
  CHECK(told[2].tau[0] == doctest::Approx(26.0));  // applied, not asked
  CHECK(told[6].tau[0] == doctest::Approx(26.0));  // heard at 20 ms, so it lives until 120 ms
  CHECK(told[7].tau[0] == 0.0);
}

TEST_CASE(
    "simulator: told directly, thrusters follow from the next step on, within their limit, until told otherwise") {
  auto simulator = test::make_simulator("seabotix_lbv150", "deep", {});
  std::vector<Thrusters> told;
  simulator->drive({5.0, 50.0, 0.0, -2.0});
  for (int i = 0; i < 100; ++i) test::collect(simulator->step(), told);
  REQUIRE(told.size() == 100);
  CHECK(told.front().force == std::vector<double>{5.0, 13.0, 0.0, -2.0});
  CHECK(told.back().force == told.front().force);
  CHECK(told.back().tau[0] == doctest::Approx(18.0));
  auto bluerov = test::make_simulator("bluerov2", "deep", {});
  bluerov->drive(std::vector<double>(6, 1600.0));
  told.clear();
  test::collect(bluerov->step(), told);
  CHECK(told.front().pwm_us == std::vector<double>(6, 1600.0));
  CHECK(told.front().tau[2] == doctest::Approx(2.0 * 8.1).epsilon(0.02));  // the curve at 1600 us
}

TEST_CASE("simulator: raw instruments speak for their own places, what they see is the same, and each has its due") {
  auto plain = test::make_simulator("seabotix_lbv150", "deep", {});
  auto raw = test::make_simulator("seabotix_lbv150", "deep", {.raw = true});
  raw->begin_at(kOrigin + 5'000'000);
  CHECK(raw->now() == kOrigin + 5'000'000);
  std::vector<Depth> z, z_port;
  for (int i = 0; i < 200; ++i) {
    test::collect(plain->step(), z);
    const std::vector<Sample>& samples = raw->step();
    test::collect(samples, z_port);
    REQUIRE(raw->due().size() == samples.size());
    for (std::size_t k = 0; k < samples.size(); ++k) {
      CHECK(raw->due()[k] > raw->now() - raw->interval() - 1);
      CHECK(raw->due()[k] <= raw->now());
      if (const auto* ahrs = std::get_if<Ahrs>(&samples[k])) CHECK(raw->due()[k] == ahrs->utime + 6000);
    }
  }
  REQUIRE(z.size() == z_port.size());
  REQUIRE(z.size() > 50);
  // The port sits 3 cm above the origin; tilts and the error of AHRS move it by a millimetre or two.
  for (std::size_t k = 0; k < z.size(); ++k) CHECK(std::abs(z_port[k].z - (z[k].z - 0.03)) < 5e-3);
}

TEST_CASE("simulator: the same seed gives the same bits, another seed other ones") {
  for (const std::string site : {"tank", "deep"}) {
    CAPTURE(site);
    const auto first = lively(*test::make_simulator("seabotix_lbv150", site, {.seed = 5}), 12.0, kKinds);
    CHECK(first == lively(*test::make_simulator("seabotix_lbv150", site, {.seed = 5}), 12.0, kKinds));
    CHECK(first != lively(*test::make_simulator("seabotix_lbv150", site, {.seed = 6}), 12.0, kKinds));
  }
}

TEST_CASE("simulator: an instrument less changes not one bit of the others") {
  const test::Changes without{{"    depth:\n      rate: 20 Hz", "    depth:\n      sites: []\n      rate: 20 Hz"},
                              {"    loads: {rate", "    loads: {sites: [], rate"}};
  for (const std::string site : {"tank", "deep"}) {
    CAPTURE(site);
    const auto all = lively(*test::make_simulator("seabotix_lbv150", site, {.seed = 5}), 12.0, kKinds);
    const auto fewer = lively(*test::make_simulator("seabotix_lbv150", site, {.seed = 5}, without), 12.0, kKinds);
    for (std::size_t kind = 0; kind < kKinds; ++kind) {
      CAPTURE(kind);
      const bool removed = Sample{Depth{}}.index() == kind || Sample{Loads{}}.index() == kind;
      if (removed) {
        CHECK(fewer[kind].empty());
        CHECK_FALSE(all[kind].empty());
      } else {
        CHECK(fewer[kind] == all[kind]);
      }
    }
  }
}

TEST_CASE("simulator: every rate is exact to the microsecond, and samples come out late by their latency") {
  auto simulator = test::make_simulator("seabotix_lbv150", "tank", {},
                                        {{"loss: 3 %", "loss: 0 %"}, {"drop_out: 0.05 %", "drop_out: 0 %"}});
  std::int64_t ahrs = 0, lasers = 0, depths = 0;
  Utime newest_ahrs = 0, newest_laser = 0;
  for (int tick = 0; tick < 500; ++tick) {
    for (const Sample& sample : simulator->step()) {
      const Utime now = simulator->now();
      if (const auto* a = std::get_if<Ahrs>(&sample)) {
        CHECK(a->utime == kOrigin + 5'000 + 10'000 * ahrs++);
        CHECK(now >= a->utime + 6'000);
        CHECK(now < a->utime + 6'000 + simulator->interval());
        newest_ahrs = a->utime;
      } else if (const auto* l = std::get_if<LaserRange>(&sample)) {
        CHECK(l->utime == utime_after(kOrigin, static_cast<double>(lasers++) / 30.0));
        CHECK(now >= l->utime + 40'000);
        CHECK(now < l->utime + 40'000 + simulator->interval());
        newest_laser = l->utime;
      } else if (std::holds_alternative<Depth>(sample)) {
        ++depths;
      }
    }
  }
  CHECK(ahrs == 999);    // 10 s: the one of 9.985 s is the last that is there by now
  CHECK(lasers == 299);  // those up to 9.96 s
  CHECK(depths == 200);
  CHECK(newest_laser < newest_ahrs);
}

TEST_CASE("simulator: hidden effects act on the truth and leave what is told alone") {
  auto plain = test::make_simulator("seabotix_lbv150", "deep", {});
  auto weak =
      test::make_simulator("seabotix_lbv150", "deep", {.hide = {"thruster_gain=variant:port,gain_change:-0.5"}});
  Vector6d tau = Vector6d::Zero();
  tau[0] = 10.0;
  const auto told = test::run<Thrusters>(*weak, 5.0, tau);
  static_cast<void>(test::run<Thrusters>(*plain, 5.0, tau));
  CHECK(told.back().tau[0] == doctest::Approx(10.0));
  CHECK(weak->moment().tau_felt[0] == doctest::Approx(7.5));
  CHECK(weak->moment().tau_felt[5] == doctest::Approx(-0.0475 * 2.5));  // port pushes less: the bow turns to port
  CHECK(weak->moment().nu[5] < -0.02);
  CHECK(std::abs(plain->moment().nu[5]) < 1e-6);
}

TEST_CASE("simulator: every registered effect can be hidden with drawn sizes, and the run stays finite") {
  constexpr double kMast = 0.05;  // m^2 above the water, for what only such craft can feel
  for (const model::Effect* effect : model::all_effects()) {
    CAPTURE(effect->name());
    for (const std::string vehicle : {"seabotix_lbv150", "bluerov2"}) {
      CAPTURE(vehicle);
      model::Vehicle craft = test::vehicle_of_file(vehicle);
      // One thruster in another's jet, which not every frame has.
      craft.thrusters[1].p_BJ = craft.thrusters[0].p_BJ + 0.3 * craft.thrusters[0].axis_B;
      const Config config = Config::parse(test::simulation_text(vehicle, {}), vehicle + ".yaml");
      const auto made = [&](double windage) {
        craft.windage = windage;
        return std::make_unique<simulation::Simulator>(
            craft, test::site_of_file("tank"), config.section("simulator"),
            simulation::Setup{.seed = 3, .hide = {std::string{effect->name()}}});
      };
      std::unique_ptr<simulation::Simulator> simulator;
      try {
        simulator = made(kMast);
      } catch (const InputError&) {
        simulator = made(0.0);  // what is asked of no craft that lives by its flow
      }
      const auto truth = [&] {
        std::vector<Truth> found;
        for (int tick = 0; tick < 500; ++tick) {
          Vector6d tau = Vector6d::Zero();
          tau[0] = tick / 50 % 2 == 0 ? 3.0 : -3.0;
          tau[5] = tick / 25 % 2 == 0 ? 0.3 : -0.3;
          simulator->command({.utime = simulator->now(), .tau = tau, .life = 0.5});
          test::collect(simulator->step(), found);
        }
        return found;
      }();
      CHECK(simulator->secrets().effects.size() == 1);
      CHECK(truth.back().nu.allFinite());
      CHECK(truth.back().nu.cwiseAbs().maxCoeff() < 3.0);
    }
  }
}

TEST_CASE("simulator: what --hide does not know is answered in one line") {
  const auto complaint = [](const std::string& text) {
    return test::complaint_of<InputError>(
        [&] { static_cast<void>(test::make_simulator("seabotix_lbv150", "tank", {.hide = {text}})); });
  };
  CHECK(complaint("ghost").find("no effect 'ghost'; there are thruster_delay, ") != std::string::npos);
  CHECK(complaint("current=v_X:1").find("current has no 'v_X'; it has v_N, v_E, variant") != std::string::npos);
  CHECK(complaint("current=v_N:fast").find("'fast' is no number") != std::string::npos);
  CHECK(complaint("current=v_N:9").find("outside of what v_N can be") != std::string::npos);
  CHECK(complaint("current=v_N").find("is not parameter:value") != std::string::npos);
  CHECK(complaint("thruster_gain=variant:bow").find("no variant 'bow'; there are ") != std::string::npos);
}

TEST_CASE("simulator: bad lines of its settings are refused with file and line") {
  const auto complaint = [](const test::Changes& changes) {
    return test::complaint_of<InputError>(
        [&] { static_cast<void>(test::make_simulator("seabotix_lbv150", "tank", {}, changes)); });
  };
  CHECK(complaint({{"interval: 20 ms", "interval: 21 ms"}}).find("'interval' must be a multiple of 'step'") !=
        std::string::npos);
  CHECK(complaint({{"m_X: 9.7532 kg", "m_X: -9.7532 kg"}}).find("'m_X' must be positive") != std::string::npos);
  CHECK(complaint({{"X_u: -8.6040", "X_u: 8.6040"}}).find("drag opposes motion") != std::string::npos);
  CHECK(complaint({{"    I_X: 0.20 kg m^2\n", ""}}).find("'I_X' is missing") != std::string::npos);
  CHECK(complaint({{"rate: 100 Hz", "rate: 100"}}).find("seabotix_lbv150.yaml:") != std::string::npos);
  CHECK(complaint({{"gyro_noise", "giro_noise"}}).find("did you mean 'gyro_noise'") != std::string::npos);
  CHECK(complaint({{"loss: 3 %", "loss: 3"}}).find("is a probability") != std::string::npos);
  CHECK(complaint({{"position: 0 0 0.75 m", "position: 0 0 1.45 m"}}).find("leaves no room") != std::string::npos);
  CHECK(complaint({{"    tank: {position", "    pool: {position"}}).find("no start is stated for the site 'tank'") !=
        std::string::npos);
}

TEST_CASE("simulator: feedback of drives without errors tells what their driver would, at the moment it changes too") {
  const auto told = [](const test::Changes& changes) {
    auto simulator = test::make_simulator("seabotix_lbv150", "tank", {.seed = 4}, changes);
    std::vector<Thrusters> all;
    Vector6d tau = Vector6d::Zero();
    for (int k = 0; k < 200; ++k) {  // another command in every interval
      tau[0] = 0.05 * k;
      simulator->command({.utime = simulator->now(), .tau = tau, .life = 1.0});
      test::collect(simulator->step(), all);
    }
    return all;
  };
  const auto driver = told({});
  const auto drives =
      told({{"    depth:", "    thrusters: {rate: 50 Hz, latency: 0 s, noise: 0 N, gain_error: 0 %}\n    depth:"}});
  REQUIRE(drives.size() > 190);
  for (std::size_t k = 0; k < std::min(driver.size(), drives.size()); ++k) {
    CHECK(drives[k].utime == driver[k].utime);
    CHECK(drives[k].force == driver[k].force);
    for (std::size_t i = 0; i < 6; ++i) CHECK(drives[k].tau[i] == doctest::Approx(driver[k].tau[i]));
  }
}
