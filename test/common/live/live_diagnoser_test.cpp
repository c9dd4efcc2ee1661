// The diagnoser on line against `fathom diagnose`: the same answer at the end, the same rankings whatever the order of
// arrival and however quick the machine, a beginning anew, and what is said before there is anything to say.
#include "common/live/live_diagnoser.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <random>
#include <thread>

#include "common/estimation/smoothing/state_as_measured.hpp"
#include "common/live/ranking.hpp"
#include "common/verdict/of_recordings.hpp"
#include "common/wire/log_reader.hpp"
#include "common/wire/log_writer.hpp"
#include "test/support/scratch.hpp"
#include "test/support/virtual_dive.hpp"

namespace fathom::live {
namespace {

using Late = LiveDiagnoser::Late;

constexpr Utime kStart = 1'600'000'000'000'000;
constexpr int kPatience = 600'000;  // ms: a search of lower priority, beside others and under sanitizers
constexpr LiveSettings kSettings{.first_look = 30.0, .interval = 5.0, .max_skew = 0.5, .threads = 2};

/// A dive as the minds hear it: STATE, thrusters, gyro.
Recording dive(const model::Vehicle& vehicle, double duration, std::vector<model::ActiveEffect> hidden) {
  const Trial trial = test::make_dive(vehicle, {.duration = duration, .seed = 5, .effects = std::move(hidden)}).trial;
  Recording recording{.name = "run"};
  for (std::size_t k = 0; k < trial.size(); ++k) {
    const Utime utime = utime_after(kStart, trial.t[k]);
    recording.state.push_back(
        {.utime = utime, .p_WB = trial.p_WB[k], .q_WB = trial.q_WB[k], .nu = trial.nu[k], .valid = true});
    recording.thrusters.push_back({.utime = utime});
    recording.thrusters.back().force.assign(trial.input[k].data(), trial.input[k].data() + trial.input[k].size());
    recording.ahrs.push_back({.utime = utime, .w_WB_B = trial.nu[k].tail<3>(), .has_rates = true});
  }
  return recording;
}

enum class Order { kAsRecorded, kJitter };

/// All rankings before the end. `late`: however late they come.
std::vector<EffectRanking> listen(LiveDiagnoser& diagnoser, const Recording& recording, Order order, Late late) {
  struct Message {
    Utime arrival;
    int channel;
    std::size_t sample;
  };
  std::vector<Message> messages;
  std::mt19937 random{9};
  std::uniform_int_distribution<Utime> behind{0, 400'000};  // us: below the skew that is promised
  std::array<Utime, 3> newest{};
  for (std::size_t k = 0; k < recording.state.size(); ++k) {
    for (const int channel : {0, 1, 2}) {
      const Utime utime = recording.state[k].utime + (order == Order::kJitter ? behind(random) : 0);
      Utime& last = newest[static_cast<std::size_t>(channel)];  // channels keep their own order
      last = std::max(last, utime);
      messages.push_back({last, channel, k});
    }
  }
  std::ranges::stable_sort(messages, {}, &Message::arrival);
  std::vector<EffectRanking> rankings;
  const auto say = [&](const std::optional<EffectRanking>& ranking) {
    if (ranking) rankings.push_back(*ranking);
  };
  for (const Message& message : messages) {
    if (message.channel == 0) say(diagnoser.step(recording.state[message.sample]));
    if (message.channel == 1) diagnoser.hear(recording.thrusters[message.sample]);
    if (message.channel == 2) diagnoser.hear(recording.ahrs[message.sample]);
  }
  // Rankings that have not come yet follow with the states to come: such as were heard already change nothing.
  const double seconds = seconds_between(recording.state.front().utime, recording.state.back().utime);
  const auto expected = static_cast<std::size_t>(seconds / kSettings.interval + 1e-9);
  for (int k = 0; k < kPatience && late == Late::kIsToldLate && rankings.size() < expected; ++k) {
    say(diagnoser.step({.utime = recording.state.front().utime, .valid = true}));
    std::this_thread::sleep_for(std::chrono::milliseconds{1});
  }
  return rankings;
}

void check_same(const EffectRanking& a, const EffectRanking& b) {
  CHECK(a.verdict == b.verdict);
  CHECK(a.against == b.against);
  REQUIRE(a.candidates.size() == b.candidates.size());
  for (std::size_t i = 0; i < a.candidates.size(); ++i) {
    CHECK(a.candidates[i].name == b.candidates[i].name);
    CHECK(a.candidates[i].variant == b.candidates[i].variant);
    CHECK(a.candidates[i].log_odds == doctest::Approx(b.candidates[i].log_odds).epsilon(1e-9));
    CHECK(a.candidates[i].error_reduction == doctest::Approx(b.candidates[i].error_reduction).epsilon(1e-9));
    REQUIRE(a.candidates[i].numbers.size() == b.candidates[i].numbers.size());
    for (std::size_t j = 0; j < a.candidates[i].numbers.size(); ++j)
      CHECK(a.candidates[i].numbers[j] == doctest::Approx(b.candidates[i].numbers[j]).epsilon(1e-9));
  }
}

void check_same(const std::vector<EffectRanking>& a, const std::vector<EffectRanking>& b) {
  REQUIRE(a.size() == b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    CHECK(a[k].utime == b[k].utime);
    check_same(a[k], b[k]);
  }
}

}  // namespace

TEST_CASE("live diagnoser: at the trial's end it says what the log says afterwards") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const Recording run = dive(vehicle, 100.0, {test::active("current", {0.15, -0.1})});
  LiveDiagnoser diagnoser{kSettings, vehicle};
  const std::vector<EffectRanking> rankings = listen(diagnoser, run, Order::kAsRecorded, Late::kIsWaitedFor);
  const std::optional<EffectRanking> last = diagnoser.finish();
  REQUIRE(last);
  CHECK(last->utime == run.state.back().utime);
  CHECK(last->verdict == "effect");
  REQUIRE_FALSE(last->candidates.empty());
  CHECK(last->candidates[0].name == "current");
  CHECK(last->candidates[0].numbers[0] == doctest::Approx(0.15).epsilon(0.1));  // m/s toward north

  const test::Scratch scratch;
  wire::LogWriter log{scratch.path("run.lcmlog")};
  log.append(run);
  static_cast<void>(log.finish());
  Recording read = wire::read_log(scratch.path("run.lcmlog")).recording;
  REQUIRE(estimation::take_state_as_measured(read));
  std::vector<std::string> notes;
  const auto afterwards = verdict::of_recordings(vehicle, {.recordings = {read}, .fitted = 1}, {}, {}, notes);
  check_same(*last, ranking_of(afterwards.answer));

  // Half a minute is searched, and told from 45 s on; a minute, and told from 90 s on. Before there is nothing to say.
  REQUIRE(rankings.size() == 20);
  for (std::size_t k = 0; k < rankings.size(); ++k) {
    CHECK(rankings[k].utime == utime_after(kStart, 5.0 * static_cast<double>(k + 1)));
    CHECK((rankings[k].verdict == "collecting") == (k < 8));
    if (k > 8) check_same(rankings[k], rankings[k < 17 ? 8 : 17]);
  }
  CHECK(rankings.back().verdict == "effect");
  CHECK(rankings.back().candidates.at(0).name == "current");
}

TEST_CASE("live diagnoser: neither the order of arrival nor the machine's speed changes a ranking") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const Recording run = dive(vehicle, 95.0, {test::active("current", {0.15, -0.1})});
  LiveDiagnoser reference{kSettings, vehicle};
  const auto waited = listen(reference, run, Order::kAsRecorded, Late::kIsWaitedFor);
  REQUIRE(waited.size() == 19);
  CHECK(waited[9].verdict != "collecting");
  SUBCASE("channels behind one another") {
    LiveDiagnoser other{kSettings, vehicle};
    check_same(listen(other, run, Order::kJitter, Late::kIsWaitedFor), waited);
  }
  SUBCASE("answers that come late: a second's worth of messages is through before a search has begun") {
    LiveDiagnoser other{kSettings, vehicle, {}, Late::kIsToldLate};
    check_same(listen(other, run, Order::kAsRecorded, Late::kIsToldLate), waited);
  }
  SUBCASE("one thread") {
    LiveSettings one = kSettings;
    one.threads = 1;
    LiveDiagnoser other{one, vehicle};
    check_same(listen(other, run, Order::kAsRecorded, Late::kIsWaitedFor), waited);
  }
  SUBCASE("a second trial after the first, begun anew") {
    reference.reset();
    check_same(listen(reference, run, Order::kAsRecorded, Late::kIsWaitedFor), waited);
  }
}

TEST_CASE("live diagnoser: of a trial that is too short nothing is said but that") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  LiveDiagnoser diagnoser{kSettings, vehicle};
  CHECK_FALSE(diagnoser.finish());
  const Recording run = dive(vehicle, 12.0, {});
  const auto rankings = listen(diagnoser, run, Order::kAsRecorded, Late::kIsWaitedFor);
  REQUIRE(rankings.size() == 2);
  for (const EffectRanking& ranking : rankings) {
    CHECK(ranking.verdict == "collecting");
    CHECK(ranking.candidates.empty());
  }
  const auto last = diagnoser.finish();
  REQUIRE(last);
  CHECK(last->verdict == "not_judged");
  CHECK_FALSE(diagnoser.take_notes().empty());
}

TEST_CASE("live diagnoser: asked to stop it waits for nothing, and says no more") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  bool go_on = true;
  LiveDiagnoser diagnoser{kSettings, vehicle, {}, Late::kIsWaitedFor, [&] { return go_on; }};
  const Recording run = dive(vehicle, 40.0, {});
  CHECK(listen(diagnoser, run, Order::kAsRecorded, Late::kIsWaitedFor).size() == 8);
  go_on = false;
  CHECK_FALSE(diagnoser.finish());
}

}  // namespace fathom::live
