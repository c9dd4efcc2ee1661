// camera_driver and vision, killed or halted in a trial by pictures in real time: the camera sends on, the successor
// connects by itself, and of the pictures only those are lost that came while nobody was there. Blind for the seconds
// of a halt, the vehicle floats up without thrust: the trial goes on, or ends at the fence.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <fathom_lcm/camera_t.hpp>
#include <string>
#include <vector>

#include "common/base/event_log.hpp"
#include "common/runtime/bus.hpp"
#include "test/support/private_network.hpp"
#include "test/support/timing.hpp"
#include "test/survival/agree.hpp"
#include "test/survival/deeds.hpp"

namespace fathom {
namespace {

using test::Deed;
using test::seconds;

constexpr double kPeriod = 1.0 / 30.0;  // s, of the camera

/// When the pictures of a log were taken [s since the epoch]. The camera tells no time: the driver stamps what arrives.
std::vector<double> taken(const std::string& path) {
  std::vector<double> t;
  EventLog log{path};
  while (const auto event = log.next()) {
    if (event->channel != "CAMERA") continue;
    if (const auto picture = runtime::message_of<fathom_lcm::camera_t>(event->data))
      t.push_back(seconds(picture->utime));
  }
  return t;
}

/// Pictures that are not there between `from` and `to`; stamps are late by a little at times.
long lacking(const std::vector<double>& t, double from, double to) {
  const auto count = std::count_if(t.begin(), t.end(), [&](double each) { return each >= from && each < to; });
  return std::lround((to - from) / kPeriod) - count;
}

/// Excites again soon after `back`, the way to the mode's place included.
bool goes_on(const Recording& log, double back) {
  return std::any_of(log.excitation.begin(), log.excitation.end(), [&](const Excitation& each) {
    const double after = seconds(each.utime) - back;
    return each.active && after > 0.0 && after < 18.0;
  });
}

/// Found outside of the fence after a halt, the vehicle is thrust nowhere any more.
bool ends_safely(const Recording& log, double back) {
  const Excitation& last = log.excitation.back();
  const bool pushed = std::any_of(log.wrench_command.begin(), log.wrench_command.end(), [&](const WrenchCommand& each) {
    return seconds(each.utime) > back + 2.0 && !each.tau.isZero();
  });
  return last.phase == "aborted" && last.reason.find("too far up") != std::string::npos && !pushed;
}

}  // namespace

TEST_CASE("drivers, pictures: camera_driver and vision are killed and halted, come back, and only their time is lost") {
  if (!test::private_network()) return;
  const test::Scratch scratch;
  const std::string words = "tank seabotix_lbv150 optimal ";
  const auto ran = test::on_a_network(
      scratch,
      test::trials(words + "lockstep 7 75 --camera", words + "real 7 75 --camera", "FATHOM_LIVE_WHOLE=yes",
                   "${deputy%deputy}recorder --file camera.lcmlog 2>recorder.txt & r=$!; in_mode total; sleep 5\n"
                   "slay camera_driver; sleep 4; slay vision; sleep 4; slay camera_driver\n"
                   "sleep 25; in_mode total; slay camera_driver STOP\n") +
          "kill -INT $r; wait $r\n",
      260);
  const std::string live = test::read_bytes(scratch.path("live.txt"));
  CHECK_MESSAGE(ran.says("code 0"), ran.text << live);
  const std::vector<Deed> deeds = test::deeds_in(ran.text);
  REQUIRE_MESSAGE(deeds.size() == 4, ran.text);
  const test::Trial run{scratch.path("out")}, still{scratch.path("still")};
  REQUIRE(!run.log.excitation.empty());
  REQUIRE(!run.log.model.empty());
  REQUIRE(!still.log.model.empty());
  // Pictures are stamped as they arrive: on a busy machine late, by what no interval contains.
  constexpr double kStamps = 0.1;
  test::check_agree(run.log.model.back(), still.log.model.back(), kStamps);

  const std::vector<double> pictures = taken(scratch.path("camera.lcmlog"));
  REQUIRE(pictures.size() > 1000);
  constexpr double kBefore = 0.1, kBack = 0.6;  // s: under way; until the successor has connected and the next one came
  constexpr long kJitter = 3;                   // pictures at both ends of a stretch, on a busy machine
  for (const Deed& deed : deeds) {
    if (deed.name != "camera_driver") continue;
    const long lost = lacking(pictures, deed.died - kBefore, deed.back + kBack);
    CHECK(lost <= std::lround((deed.back + kBack - deed.died + kBefore) / kPeriod));
    CHECK(lost >= -kJitter);  // what was sent to nobody is not told as new
    MESSAGE("away for " << deed.back - deed.died << " s: " << lost << " pictures lost");
  }

  if (!test::kTimed) return;  // with rendered pictures at 30 Hz the sanitizers are too slow for the wall's clock
  CHECK_FALSE(ran.says("no new"));
  CHECK_FALSE(ran.says("no mode"));
  const std::string said = test::read_bytes(scratch.path("out/processes/played_camera_driver.txt"));
  CHECK_MESSAGE(said.find(" s and does nothing; killed, to be started again") != std::string::npos, said);
  double from = pictures.front() + 1.0;
  for (const Deed& deed : deeds) {
    if (deed.name != "camera_driver") continue;
    CHECK(lacking(pictures, from, deed.died - kBefore) <= kJitter);
    from = deed.back + kBack;
  }
  CHECK(lacking(pictures, from, pictures.back()) <= kJitter);

  // Vision measures in what is there, and the vehicle goes on.
  for (const Deed& deed : deeds) {
    const auto& flow = run.log.optical_flow;
    CHECK_MESSAGE(std::any_of(flow.begin(), flow.end(),
                              [&](const OpticalFlow& each) {
                                const double after = seconds(each.utime) - deed.back;
                                return after > 0.0 && after < 2.0;
                              }),
                  deed.name);
    const bool halted = &deed == &deeds.back();
    const bool on = goes_on(run.log, deed.back);
    CHECK_MESSAGE((on || (halted && ends_safely(run.log, deed.back))), deed.name);
    if (!on) MESSAGE("after the halt the trial ended: " << run.log.excitation.back().reason);
  }
}

}  // namespace fathom
