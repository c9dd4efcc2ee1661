// The streaming diagnoser on simulated dives: order of arrival does not matter, hidden effects are found, and clean
// data convict nobody.
#include "common/diagnosis/live_diagnoser.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "common/base/spatial.hpp"
#include "test/support/timing.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::diagnosis;

namespace {

constexpr Utime kStart = 1'600'000'000'000'000;
constexpr double kDuration = 240.0;  // s: twenty blocks

struct Message {
  Utime arrival{};
  int kind{};  // 0 state, 1 thrusters, 2 battery
  std::size_t sample{};
};

enum class Order { kTogether, kInputsFirst, kStatesFirst, kJitter };

std::vector<EffectRanking> listen(LiveDiagnoser& diagnoser, const Trial& trial, Order order = Order::kTogether) {
  std::mt19937 random{9};
  std::uniform_int_distribution<Utime> late{0, 400'000};  // us: below the skew that is promised
  std::vector<Message> messages;
  std::array<Utime, 3> newest{};
  for (std::size_t k = 0; k < trial.size(); ++k) {
    for (const int kind : {0, 1, 2}) {
      if (kind == 2 && k % 10 != 3) continue;
      Utime arrival = utime_after(kStart, trial.t[k]);
      if (order == Order::kStatesFirst && kind > 0) arrival += 300'000;
      if (order == Order::kInputsFirst && kind == 0) arrival += 300'000;
      if (order == Order::kJitter) arrival += late(random);
      auto& last = newest[static_cast<std::size_t>(kind)];  // channels keep their own order
      last = std::max(last, arrival);
      messages.push_back({last, kind, k});
    }
  }
  std::stable_sort(messages.begin(), messages.end(),
                   [](const auto& a, const auto& b) { return a.arrival < b.arrival; });
  std::vector<EffectRanking> rankings;
  for (const Message& message : messages) {
    const std::size_t k = message.sample;
    const Utime utime = utime_after(kStart, trial.t[k]);
    std::optional<EffectRanking> ranking;
    if (message.kind == 0) {
      ranking = diagnoser.step(StateEstimate{
          .utime = utime, .p_WB = trial.p_WB[k], .q_WB = trial.q_WB[k], .nu = trial.nu[k], .valid = true});
    } else if (message.kind == 1) {
      Thrusters thrusters{.utime = utime};
      thrusters.force.assign(trial.input[k].data(), trial.input[k].data() + trial.input[k].size());
      ranking = diagnoser.step(thrusters);
    } else {
      ranking = diagnoser.step(Battery{.utime = utime, .voltage = trial.voltage[k]});
    }
    if (ranking) rankings.push_back(*ranking);
  }
  if (const auto last = diagnoser.finish()) rankings.push_back(*last);
  return rankings;
}

std::string told(const EffectRanking& ranking) {
  std::string text = ranking.verdict + ":";
  for (const EffectEvidence& one : ranking.candidates) {
    text += " " + one.name + " " + std::to_string(one.log_odds) + " (" + std::to_string(one.error_reduction) + ")";
  }
  return text;
}

EffectRanking verdict_on(const model::Vehicle& vehicle, std::vector<model::ActiveEffect> hidden, unsigned seed) {
  const test::VirtualDive dive =
      test::make_dive(vehicle, {.duration = kDuration, .seed = seed, .effects = std::move(hidden)});
  LiveDiagnoser diagnoser{LiveSettings{}, vehicle};
  return listen(diagnoser, dive.trial).back();
}

}  // namespace

TEST_CASE("live diagnoser: hidden effects are ranked first") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const auto coupling = [&](const std::string& name) {
    LiveDiagnoser diagnoser{LiveSettings{}, vehicle};
    model::Scene scene{.vehicle = &vehicle};
    scene.nu_rms.setOnes();
    const auto names = model::find_effect("cross_coupling")->variants(scene);
    return static_cast<int>(std::find(names.begin(), names.end(), name) - names.begin());
  };
  std::mt19937 random{3};
  std::uniform_real_distribution<double> factor{0.8, 1.2};
  const std::vector<model::ActiveEffect> cases{
      test::active("current", {0.15 * factor(random), -0.2 * factor(random)}),
      test::active("thruster_lag", {0.4 * factor(random)}),
      test::active("thruster_delay", {0.3 * factor(random)}),
      test::active("thruster_gain", {-0.4 * factor(random)}, 1),
      test::active("thrust_asymmetry", {-0.25 * factor(random)}),
      test::active("cross_coupling", {8.0 * factor(random)}, coupling("N_v")),
      test::active("tether_tension", {2.0 * factor(random), 0.0, 3.0, 2.0, -1.0}),
      test::active("battery_sag", {1.5 * factor(random)}),
      test::active("asymmetric_drag", {25.0 * factor(random)}, 0),
      test::active("thruster_deadband", {2.0 * factor(random)})};
  unsigned seed = 20;
  for (const model::ActiveEffect& hidden : cases) {
    const EffectRanking ranking = verdict_on(vehicle, {hidden}, ++seed);
    CAPTURE(hidden.effect->name());
    CAPTURE(told(ranking));
    REQUIRE_FALSE(ranking.candidates.empty());
    CHECK(ranking.candidates.front().name == hidden.effect->name());
    CHECK((ranking.verdict == "effect" || ranking.verdict == "ambiguous"));
  }
}

TEST_CASE("live diagnoser: what the warm-up could not show is found once the trial has shown it") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const test::VirtualDive dive = test::make_dive(
      vehicle, {.duration = kDuration, .seed = 16, .effects = {test::active("payload_change", {0.0, 6.0, 170.0})}});
  LiveDiagnoser diagnoser{LiveSettings{}, vehicle};
  const EffectRanking ranking = listen(diagnoser, dive.trial).back();
  CAPTURE(told(ranking));
  REQUIRE_FALSE(ranking.candidates.empty());
  CHECK(ranking.candidates.front().name == "payload_change");
  REQUIRE(ranking.candidates.front().numbers.size() == 3);
  CHECK(ranking.candidates.front().numbers[2] == doctest::Approx(170.0).epsilon(0.05));
}

TEST_CASE("live diagnoser: a fault of a sensor is no force, and comes before all that its motion accuses") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const test::VirtualDive dive =
      test::make_dive(vehicle, {.duration = kDuration, .seed = 31, .effects = {test::active("current", {0.2, -0.2})}});
  const Trial& trial = dive.trial;
  constexpr std::size_t kLate = 8;  // samples
  LiveDiagnoser diagnoser{LiveSettings{}, vehicle};
  for (std::size_t k = kLate; k < trial.size(); ++k)
    diagnoser.hear(
        Ahrs{.utime = utime_after(kStart, trial.t[k]), .w_WB_B = trial.nu[k - kLate].tail<3>(), .has_rates = true});
  const EffectRanking ranking = listen(diagnoser, trial).back();
  CAPTURE(told(ranking));
  REQUIRE(ranking.candidates.size() > 1);
  CHECK(ranking.verdict == "effect");
  CHECK(ranking.candidates.front().name == "sensor_latency");
  CHECK(ranking.candidates.front().numbers.front() == doctest::Approx(kLate * trial.dt).epsilon(0.1));
  CHECK(ranking.candidates[1].name == "current");
  CHECK(ranking.against.empty());

  LiveDiagnoser strict{LiveSettings{.accept_log_odds = 1e4}, vehicle};  // a fault that convinces nobody
  for (std::size_t k = kLate; k < trial.size(); ++k)
    strict.hear(
        Ahrs{.utime = utime_after(kStart, trial.t[k]), .w_WB_B = trial.nu[k - kLate].tail<3>(), .has_rates = true});
  CHECK(listen(strict, trial).back().verdict != "effect");
}

// A velocity log turned by 2 degrees shows surge in sway, which forces alone call coupling.
TEST_CASE("live diagnoser: a sensor that is turned accuses no water") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  test::VirtualDive dive = test::make_dive(vehicle, {.duration = kDuration, .seed = 33});
  Trial& trial = dive.trial;
  const Eigen::Matrix3d turned = rotation_from_euler({0.0, 0.0, 0.035});
  for (Vector6d& nu : trial.nu) nu.head<3>() = turned * Eigen::Vector3d{nu.head<3>()};
  const auto verdict = [&](bool heard) {
    LiveDiagnoser diagnoser{LiveSettings{}, vehicle};
    if (heard) {
      for (std::size_t k = 0; k < trial.size(); ++k)
        diagnoser.hear(Dvl{.utime = utime_after(kStart, trial.t[k]), .v_WB_B = trial.nu[k].head<3>()});
    }
    return listen(diagnoser, trial);
  };
  const std::vector<EffectRanking> alone = verdict(false), compared = verdict(true);
  CAPTURE(told(alone.back()));
  CAPTURE(told(compared.back()));
  CHECK(alone.back().verdict != "adequate");
  CHECK(compared.back().verdict == "adequate");
  // From when the turn is known until all has been heard again, nothing is said.
  const auto again = std::ranges::find_if(compared.begin() + 6, compared.end(),
                                          [](const EffectRanking& one) { return one.verdict == "collecting"; });
  CHECK(again != compared.end());
}

TEST_CASE("live diagnoser: an attitude sensor whose axes are turned a little accuses no coupling of the water") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const double degree = M_PI / 180.0;
  int accused = 0;
  for (const Eigen::Vector3d& turn : {Eigen::Vector3d{0.8, 0.0, 0.0}, {0.0, -0.8, 0.0}, {0.6, 0.6, -0.6}}) {
    const test::VirtualDive dive = test::make_dive(vehicle, {.duration = kDuration, .seed = 41});
    Trial trial = dive.trial;
    const Eigen::Matrix3d R = quaternion_from_rotation_vector(degree * turn).toRotationMatrix();
    for (Vector6d& nu : trial.nu) nu.tail<3>() = R * nu.tail<3>();
    for (const double mounting : {0.0, 0.5 * degree}) {
      LiveDiagnoser diagnoser{{.mounting = mounting}, vehicle};
      const EffectRanking ranking = listen(diagnoser, trial).back();
      CAPTURE(turn.transpose());
      CAPTURE(mounting);
      CAPTURE(told(ranking));
      const bool coupling = ranking.verdict == "effect" && ranking.candidates.front().name == "cross_coupling";
      if (mounting == 0.0) {
        accused += coupling ? 1 : 0;
      } else {
        CHECK(ranking.verdict == "adequate");
      }
    }
  }
  CHECK(accused > 0);  // else nothing was asked
}

TEST_CASE("live diagnoser: nothing is adopted on clean data") {
  // The LBV150 has one vertical thruster: losing its thrust and the heave masses together explains nothing.
  for (const char* name : {"bluerov2", "seabotix_lbv150"}) {
    const model::Vehicle vehicle = test::vehicle_from_repository(name);
    for (unsigned seed = 1; seed <= test::seeds(10); ++seed) {
      const EffectRanking ranking = verdict_on(vehicle, {}, seed);
      CAPTURE(name);
      CAPTURE(seed);
      CAPTURE(told(ranking));
      CHECK(ranking.verdict == "adequate");
    }
  }
}

TEST_CASE("live diagnoser: the order of arrival changes nothing, to the last bit") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const test::VirtualDive dive =
      test::make_dive(vehicle, {.duration = 120.0, .seed = 5, .effects = {test::active("thruster_lag", {0.3})}});
  LiveDiagnoser reference{LiveSettings{}, vehicle};
  const std::vector<EffectRanking> expected = listen(reference, dive.trial);
  CHECK(expected.front().verdict == "collecting");
  CHECK(expected.back().candidates.front().name == "thruster_lag");
  CHECK(expected.back().candidates.front().log_odds > 3.0);
  for (const Order order : {Order::kInputsFirst, Order::kStatesFirst, Order::kJitter}) {
    LiveDiagnoser diagnoser{LiveSettings{}, vehicle};
    for (int run = 0; run < 2; ++run) {  // the second after a reset
      const std::vector<EffectRanking> rankings = listen(diagnoser, dive.trial, order);
      REQUIRE(rankings.size() == expected.size());
      for (std::size_t i = 0; i < rankings.size(); ++i) {
        CHECK(rankings[i].utime == expected[i].utime);
        CHECK(rankings[i].verdict == expected[i].verdict);
        REQUIRE(rankings[i].candidates.size() == expected[i].candidates.size());
        for (std::size_t c = 0; c < rankings[i].candidates.size(); ++c) {
          CHECK(rankings[i].candidates[c].name == expected[i].candidates[c].name);
          CHECK(rankings[i].candidates[c].log_odds == expected[i].candidates[c].log_odds);
        }
      }
      diagnoser.reset();
    }
  }
}

TEST_CASE("live diagnoser: a cause outside the registry is unexplained") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  test::VirtualDive dive = test::make_dive(vehicle, {.duration = kDuration, .seed = 11});
  // A pull that comes and goes every 25 s along surge, which no log shows: the vehicle moves as if thrust were other.
  for (std::size_t k = 0; k < dive.trial.size(); ++k) {
    dive.trial.input[k].head<4>().array() += 3.0 * std::sin(2.0 * 3.14159265358979 * dive.trial.t[k] / 25.0);
  }
  LiveDiagnoser diagnoser{LiveSettings{}, vehicle};
  const EffectRanking ranking = listen(diagnoser, dive.trial).back();
  CAPTURE(told(ranking));
  CHECK(ranking.verdict == "unexplained");
}

TEST_CASE("live diagnoser: bad samples are counted, gaps survived, silence yields no verdict") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  LiveDiagnoser silent{LiveSettings{}, vehicle};
  CHECK_FALSE(silent.finish());
  test::VirtualDive dive = test::make_dive(vehicle, {.duration = 150.0, .seed = 12});
  dive.trial.nu[700][0] = std::nan("");
  dive.trial.input[900][1] = std::nan("");
  for (std::size_t k = 1000; k < dive.trial.size(); ++k) dive.trial.t[k] += 40.0;
  LiveDiagnoser diagnoser{LiveSettings{}, vehicle};
  const EffectRanking ranking = listen(diagnoser, dive.trial).back();
  CHECK(diagnoser.rejected().at("not finite") == 2);
  CHECK(ranking.verdict == "adequate");
}

TEST_CASE("live diagnoser: many hours need no more memory than blocks, and merging keeps the verdict") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const test::VirtualDive dive =
      test::make_dive(vehicle, {.duration = 400.0, .seed = 13, .effects = {test::active("thruster_lag", {0.4})}});
  LiveSettings settings;
  settings.most_blocks = 12;
  LiveDiagnoser diagnoser{settings, vehicle};
  const EffectRanking ranking = listen(diagnoser, dive.trial).back();
  CAPTURE(told(ranking));
  REQUIRE_FALSE(ranking.candidates.empty());
  CHECK(ranking.candidates.front().name == "thruster_lag");
  CHECK((ranking.verdict == "effect" || ranking.verdict == "ambiguous"));
}
