// Is the instrument well, and what an operator is told; the lever arm from instrument to origin.
#include "common/driver/watch.hpp"

#include <doctest/doctest.h>

#include "common/base/spatial.hpp"
#include "common/driver/lever_arm.hpp"

using namespace fathom;
using namespace fathom::driver;

namespace {

constexpr Utime kStart = 1'700'000'000'000'000;

bool says(const std::string& text, const char* words) { return text.find(words) != std::string::npos; }

}  // namespace

TEST_CASE("watch: silence of a fast instrument is said within a second") {
  Watch watch{0.01, "ig500"};
  CHECK(says(watch.unhealthy(0.0, "", ""), "not open"));
  watch.link(true, "", 0.0);
  for (int i = 0; i < 100; ++i) {
    const double now = 0.01 * i;
    watch.bytes(52, now);
    watch.frame(now);
    watch.sample(utime_after(kStart, now), now);
    CHECK(watch.unhealthy(now, "", "").empty());
  }
  CHECK(watch.patience() < 1.0);
  CHECK(says(watch.unhealthy(0.99 + watch.patience() + 0.01, "", ""), "silent"));
  watch.link(false, "/dev/ttyUSB0: the device is gone", 3.0);
  CHECK(says(watch.unhealthy(3.0, "", ""), "gone"));
}

TEST_CASE("watch: rubbish, frames without measurement and a refusing instrument are told apart") {
  Watch watch{0.1, "pd0"};
  watch.link(true, "", 0.0);
  for (int i = 0; i < 20; ++i) watch.bytes(40, 0.1 * i);
  CHECK(says(watch.unhealthy(2.0, "", ""), "baud"));
  CHECK(says(watch.unhealthy(2.0, "", "a frame claims more bytes than PD0 has"), "claims more bytes"));
  watch.frame(2.0);
  CHECK(says(watch.unhealthy(2.0, "", ""), "none with a measurement"));
  CHECK(says(watch.unhealthy(2.0, "", "state 'beam_angle'"), "beam_angle"));
  CHECK(says(watch.unhealthy(2.0, "its firmware is older", ""), "firmware"));
}

TEST_CASE("watch: a line that opens and closes again and again is never called well") {
  Watch watch{0.1, "pd0"};
  watch.link(false, "tcp://192.168.2.95:16171: the other side closed the line; trying again", 0.0);
  for (double t = 1.0; t < 5.0; t += 1.0) {
    watch.link(true, "", t);
    CHECK(says(watch.unhealthy(t + 0.1, "", ""), "closed the line"));
    watch.link(false, "tcp://192.168.2.95:16171: the other side closed the line; trying again", t + 0.2);
  }
  watch.link(true, "", 6.0);
  watch.sample(utime_after(kStart, 6.1), 6.1);
  CHECK(watch.unhealthy(6.1, "", "").empty());
}

TEST_CASE("watch: a sample that is late makes a gap, a new line does not") {
  Watch watch{0.1, "pd0"};
  watch.link(true, "", 0.0);
  for (const double t : {0.0, 0.1, 0.2, 0.5, 0.6}) watch.sample(utime_after(kStart, t), t);
  CHECK(watch.gaps() == 1);
  watch.link(true, "", 5.0);
  watch.sample(utime_after(kStart, 5.0), 5.0);
  CHECK(watch.gaps() == 1);
}

TEST_CASE("lever arm: turning about down moves an instrument ahead of the origin sideways") {
  LeverArm arm{{0.5, 0.0, 0.0}};
  Dvl sample{.utime = kStart, .v_WB_B = {1.0, 0.1, 0.0}};
  Dvl early = sample;
  arm.remove(early);
  CHECK_FALSE(early.valid);  // without rates nothing can be said of the origin
  arm.hear(Ahrs{.utime = kStart - 100'000, .w_WB_B = {0.0, 0.0, 0.2}, .has_rates = true});
  arm.remove(sample);
  CHECK(sample.v_WB_B.isApprox(Eigen::Vector3d{1.0, 0.0, 0.0}));  // 0.2 rad/s times 0.5 m is the 0.1 m/s
  Dvl late{.utime = kStart + 2'000'000};
  arm.remove(late);
  CHECK_FALSE(late.valid);
}

TEST_CASE("lever arm: a port behind and below the origin, level and bow up") {
  LeverArm arm{{-1.0, 0.0, 0.2}};
  Depth level{.utime = kStart, .z = 5.0};
  arm.remove(level);
  CHECK(level.z == doctest::Approx(4.8));
  arm.hear(Ahrs{.utime = kStart,
                .q_WB = Eigen::Quaterniond{rotation_from_euler({0.0, 0.5235987756, 0.0})},
                .has_attitude = true});
  Depth bow_up{.utime = kStart, .z = 5.0};
  arm.remove(bow_up);
  CHECK(bow_up.z == doctest::Approx(5.0 - 0.5 - 0.2 * 0.8660254).epsilon(1e-6));  // the stern hangs half a metre lower
}

TEST_CASE("lever arm: between two samples of AHRS the rates and the attitude are between theirs") {
  LeverArm arm{{0.5, 0.0, 0.0}};
  const auto turned = [](double heading) { return Eigen::Quaterniond{rotation_from_euler({0.0, 0.0, heading})}; };
  // Heard late, and in the wrong order.
  arm.hear(Ahrs{
      .utime = kStart + 10'000, .w_WB_B = {0, 0, 0.4}, .q_WB = turned(0.2), .has_rates = true, .has_attitude = true});
  arm.hear(Ahrs{.utime = kStart, .w_WB_B = {0, 0, 0.2}, .q_WB = turned(0.0), .has_rates = true, .has_attitude = true});
  Dvl sample{.utime = kStart + 2'500, .v_WB_B = {1.0, 0.125, 0.0}};
  arm.remove(sample);
  CHECK(sample.v_WB_B.isApprox(Eigen::Vector3d{1.0, 0.0, 0.0}));  // 0.25 rad/s times 0.5 m
  Usbl fix{.utime = kStart + 5'000, .p_WB = {0.5 * std::cos(0.1), 0.5 * std::sin(0.1), 3.0}, .valid = true};
  arm.remove(fix);
  CHECK((fix.p_WB - Eigen::Vector3d{0.0, 0.0, 3.0}).norm() < 1e-9);
}

TEST_CASE("lever arm: of many samples the one at the measurement's own time counts, however late it comes") {
  LeverArm arm{{0.0, 0.0, -1.0}};  // a transponder above the origin
  for (int k = 0; k <= 200; ++k) {
    const double t = 0.01 * k;  // on its side after the first second
    arm.hear(Ahrs{.utime = utime_after(kStart, t),
                  .q_WB = Eigen::Quaterniond{rotation_from_euler({k > 100 ? 1.5707963268 : 0.0, 0.0, 0.0})},
                  .has_attitude = true});
  }
  Usbl upright{.utime = utime_after(kStart, 0.5), .p_WB = {1.0, 2.0, 3.0}, .valid = true};
  arm.remove(upright);
  CHECK(upright.p_WB.isApprox(Eigen::Vector3d{1.0, 2.0, 4.0}));
  Usbl aside{.utime = utime_after(kStart, 1.5), .p_WB = {1.0, 2.0, 3.0}, .valid = true};
  arm.remove(aside);
  CHECK((aside.p_WB - Eigen::Vector3d{1.0, 1.0, 3.0}).norm() <
        1e-9);  // rolled to starboard its top points to starboard
  Usbl late{.utime = utime_after(kStart, 5.0), .p_WB = {1.0, 2.0, 3.0}, .valid = true};
  arm.remove(late);
  CHECK_FALSE(late.valid);
}
