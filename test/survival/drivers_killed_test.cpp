// Drivers that are killed, or stand still, in a trial by bytes in real time: each comes back and finds its instrument
// again, what is lost is only what it could not say, the thrusters stand still within half a second of the death of
// whoever moves them, and what is learnt is the same as in an undisturbed trial. The short form runs always;
// FATHOM_LONG=yes adds every driver in every mode of the full schedule (some ten minutes).
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "common/wire/log_reader.hpp"
#include "test/support/private_network.hpp"
#include "test/support/timing.hpp"
#include "test/survival/agree.hpp"
#include "test/survival/deeds.hpp"

namespace fathom {
namespace {

using test::Deed;
using test::deeds_in;
using test::on_a_network;
using test::private_network;
using test::Scratch;
using test::seconds;
using test::Trial;

/// Trials in deep water, where every driver has an instrument.
std::string trials(const std::string& excitation, int limit, const std::string& environment, const std::string& deeds) {
  const std::string words = "deep seabotix_lbv150 " + excitation, end = " 7 " + std::to_string(limit);
  return test::trials(words + " lockstep" + end, words + " bytes" + end, environment, deeds);
}

/// Times of a channel's samples [s of the run], in their order; without those of the beginning, while lines come up.
template <class Sample>
std::vector<double> times(const std::vector<Sample>& samples, double origin) {
  constexpr double kBegin = 0.5;  // s
  std::vector<double> t;
  for (const Sample& each : samples) {
    if (seconds(each.utime) - origin > kBegin) t.push_back(seconds(each.utime) - origin);
  }
  std::sort(t.begin(), t.end());
  return t;
}

long between(const std::vector<double>& t, double from, double to) {
  return std::lower_bound(t.begin(), t.end(), to) - std::lower_bound(t.begin(), t.end(), from);
}

/// The instruments draw the same numbers in both trials, drop-outs too: what `run` has less of than `still` was lost on
/// its way. Nothing may be, but while its driver was away and as long as it needs to find its instrument again.
/// Counted, not matched: instruments without a clock are stamped as they arrive, and a busy machine lets them arrive
/// late.
long lost(const std::string& driver, const std::vector<double>& run, const std::vector<double>& still, double origin,
          double period, const std::vector<Deed>& deeds) {
  constexpr double kBefore = 0.5;  // s that a sample may be under way
  constexpr double kBack = 1.5;    // s from a driver's start to its first measurement: configures, waits for the next
  constexpr long kJitter = 2;      // late stamps at either end
  REQUIRE(!run.empty());
  double from = 0.0;
  const auto quiet = [&](double to) {
    if (to <= from) return;
    const long lacking = between(still, from, to) - between(run, from, to);
    CHECK_MESSAGE(lacking <= kJitter,
                  driver << " lost " << lacking << " samples from " << from << " to " << to << " s");
  };
  for (const Deed& deed : deeds) {
    if (deed.name != driver) continue;
    quiet(deed.died - origin - kBefore - period);
    const double back = deed.back - origin;
    from = back + kBack + period;
    // What the instrument said to nobody is of then; its successor must not tell it as of now.
    CHECK_MESSAGE(between(run, back, from) <= between(still, back, from) + kJitter,
                  driver << " told old samples as new");
  }
  const double end = std::min(run.back(), still.back()) - kBefore;
  quiet(end);
  return std::max(0L, between(still, 0.0, end) - between(run, 0.0, end));
}

/// s from `died` until the vehicle felt no thrust any more, as the simulator knows it.
double still_after(const Recording& log, double died) {
  for (const Truth& each : log.truth) {
    if (seconds(each.utime) >= died && each.tau_felt.isZero()) return seconds(each.utime) - died;
  }
  return 1e9;
}

bool pushed(const Recording& log, double from, double to) {
  return std::any_of(log.truth.begin(), log.truth.end(), [&](const Truth& each) {
    const double t = seconds(each.utime);
    return t > from && t < to && !each.tau_felt.isZero();
  });
}

void check(const Scratch& scratch, const test::Ran& ran, std::size_t kills) {
  CHECK_MESSAGE(ran.says("code 0"), ran.text << test::read_bytes(scratch.path("live.txt")));
  CHECK_FALSE(ran.says("no new"));
  CHECK_FALSE(ran.says("no mode"));
  const std::vector<Deed> deeds = deeds_in(ran.text);
  CHECK_MESSAGE(deeds.size() == kills, ran.text);
  const Trial run{scratch.path("out")}, still{scratch.path("still")};

  std::map<std::string, long> counts;
  const auto count = [&](const std::string& driver, const auto& a, const auto& b, double period) {
    counts[driver] = lost(driver, times(a, run.origin), times(b, still.origin), run.origin, period, deeds);
  };
  count("ahrs_driver", run.log.ahrs, still.log.ahrs, 0.01);
  count("depth_driver", run.log.depth, still.log.depth, 0.05);
  count("dvl_driver", run.log.dvl, still.log.dvl, 0.125);
  count("load_driver", run.log.loads, still.log.loads, 0.1);
  count("range_driver", run.log.ranges, still.log.ranges, 2.0);
  count("usbl_driver", run.log.usbl, still.log.usbl, 1.0);
  for (const auto& [driver, number] : counts) MESSAGE(driver << ": " << number << " samples lost");

  // As far as can be seen: the truth is told every 50 ms, and a busy machine looks late at a line.
  constexpr double kLife = 0.5, kSeen = 0.15;  // s
  for (const Deed& deed : deeds) {
    if (deed.name != "thruster_driver" && deed.name != "supervisor") continue;
    CHECK(pushed(run.log, deed.died - 1.0, deed.died));
    const double after = still_after(run.log, deed.died);
    CHECK_MESSAGE(after < kLife + kSeen, deed.name);
    // And so it stays until somebody arms again.
    const auto armed =
        std::find_if(run.log.operator_orders.begin(), run.log.operator_orders.end(),
                     [&](const Operator& each) { return each.enable && seconds(each.utime) > deed.died; });
    REQUIRE(armed != run.log.operator_orders.end());
    CHECK_FALSE(pushed(run.log, deed.died + after, seconds(armed->utime)));
    CHECK(pushed(run.log, seconds(armed->utime), seconds(armed->utime) + 10.0));
    MESSAGE(deed.name << " died at " << deed.died - run.origin << " s: no thrust after " << after << " s");
  }
  REQUIRE(!run.log.model.empty());
  REQUIRE(!still.log.model.empty());
  test::check_agree(run.log.model.back(), still.log.model.back());
}

}  // namespace

TEST_CASE("drivers: each that is killed or stands still in a trial comes back, and the thrusters stand still in time") {
  if (!private_network()) return;
  const Scratch scratch;
  const auto ran = on_a_network(
      scratch,
      trials("optimal", 100, "FATHOM_LIVE_WHOLE=yes",
             "in_mode total; sleep 2\n"
             "for d in load range usbl depth dvl ahrs; do slay ${d}_driver; sleep 2.5; done\n"
             "in_mode total; sleep 6\n"  // beyond the simulated operator's last order
             "slay thruster_driver; sleep 3; $fathom status | head -n 1 | sed 's/^/found /'; arm; sleep 3\n"
             "slay supervisor; sleep 3; arm; sleep 3\n"
             "slay thruster_driver STOP; sleep 2; arm; sleep 3\n"
             "slay dvl_driver STOP\n"),
      260);
  constexpr std::size_t kKills = 10;
  check(scratch, ran, kKills);
  // The supervisor does not go on in vain: it is told that its thrusters obey nobody. At the sanitizers' pace the
  // driver has told by then that it is commanded unarmed, which ends the trial as well.
  CHECK_MESSAGE((ran.says("found lost") || (!test::kTimed && ran.says("found aborted"))), ran.text);
  for (const char* driver : {"thruster_driver", "dvl_driver"}) {
    const std::string said = test::read_bytes(scratch.path(std::string{"out/processes/played_"} + driver + ".txt"));
    CHECK_MESSAGE(said.find(" s and does nothing; killed, to be started again") != std::string::npos, said);
  }
}

TEST_CASE("drivers, long: every one in every mode of the whole schedule, which comes to its end" *
          doctest::skip(std::getenv("FATHOM_LONG") == nullptr)) {
  if (!private_network()) return;
  const Scratch scratch;
  const auto ran = on_a_network(scratch,
                                trials("paper", 1500, "",
                                       "for m in yaw surge sway heave total; do in_mode $m\n"
                                       "for d in load range usbl depth dvl ahrs; do slay ${d}_driver; sleep 1; done\n"
                                       "in_mode $m; sleep 1; slay thruster_driver; sleep 2; arm; done\n"),
                                2400);
  constexpr std::size_t kKills = 35;
  check(scratch, ran, kKills);
  const Recording log = wire::read_log(scratch.path("out/run.lcmlog")).recording;
  CHECK(std::any_of(log.excitation.begin(), log.excitation.end(), [](const auto& e) { return e.phase == "done"; }));
}

}  // namespace fathom
