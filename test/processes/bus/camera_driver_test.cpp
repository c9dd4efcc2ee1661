// camera_driver at a camera of V4L2, by OpenCV, with the kernel's part played (test/support/fake_camera.cpp).
#include <doctest/doctest.h>

#include <chrono>
#include <fathom_lcm/camera_t.hpp>
#include <fstream>
#include <vector>

#include "common/base/event_log.hpp"
#include "common/vision/jpeg.hpp"
#include "test/common/vision/scene.hpp"
#include "test/support/bus.hpp"
#include "test/support/scratch.hpp"
#include "test/support/shell.hpp"

namespace fathom {
namespace {

using test::program;
using test::Scratch;
using test::shell;

struct Seen {
  test::Ran ran;
  std::vector<fathom_lcm::camera_t> pictures;
  double old{};   // s from the last picture's own time to the end
  double took{};  // s
};

// Writes the driver's settings, and gives the words that start it at the camera that is played.
std::string driver(const Scratch& scratch, const std::string& camera, const std::string& keys) {
  std::ofstream{scratch.path("camera.yaml")} << "camera_driver: {camera: down, device: /dev/video42, " << keys << "}\n";
  return "env FAKE_CAMERA_JPEG=" + scratch.path("own.jpg") + " FAKE_CAMERA=/dev/video42" + camera +
         " ASAN_OPTIONS=verify_asan_link_order=0 LD_PRELOAD='" + FATHOM_BINARY_DIR + "/test/libtest_fake_camera.so' " +
         program("camera_driver") + " --config " + scratch.path("camera.yaml");
}

// `camera`: what the camera is like, `keys`: of the driver, for so many seconds.
Seen drive(const Scratch& scratch, const std::string& camera, const std::string& keys, double time) {
  Seen seen;
  const auto begin = std::chrono::system_clock::now().time_since_epoch();
  seen.ran = shell("timeout -s INT " + std::to_string(time) + " " + driver(scratch, camera, keys) + " --out file://" +
                   scratch.path("camera.lcmlog"));
  const auto end = std::chrono::system_clock::now().time_since_epoch();
  seen.took = std::chrono::duration<double>(end - begin).count();
  EventLog log{scratch.path("camera.lcmlog")};
  while (const auto event = log.next()) {
    if (event->channel != "CAMERA") continue;
    fathom_lcm::camera_t message;
    REQUIRE(message.decode(event->data.data(), 0, static_cast<int>(event->data.size())) > 0);
    seen.pictures.push_back(message);
  }
  if (!seen.pictures.empty()) {
    seen.old =
        seconds_between(seen.pictures.back().utime, std::chrono::duration_cast<std::chrono::microseconds>(end).count());
  }
  return seen;
}

constexpr int kStopped = 124;  // of `timeout`, when it had to
constexpr double kBusy = 1.0;  // s from the last picture to the end of the process, on a busy machine

}  // namespace

TEST_CASE("camera_driver: pictures carry the kernel's time, whichever clock it stamps by, less the latency") {
  const Scratch scratch;
  for (const std::string clock : {"monotonic", "realtime"}) {
    CAPTURE(clock);
    const Seen seen = drive(scratch, ",age=1500,clock=" + clock, "stamp: kernel, latency: 0.1 s", 3.0);
    CHECK_MESSAGE(seen.ran.code == kStopped, seen.ran.text);
    REQUIRE(seen.pictures.size() > 3);
    CHECK(seen.old > 1.6);
    CHECK(seen.old < 1.6 + kBusy);
    CHECK(seen.pictures.front().width == 640);
    for (std::size_t i = 1; i < seen.pictures.size(); ++i) CHECK(seen.pictures[i].utime > seen.pictures[i - 1].utime);
  }
  const Seen arrival = drive(scratch, ",age=1500", "latency: 0.1 s", 3.0);
  REQUIRE(arrival.pictures.size() > 3);
  CHECK(arrival.old > 0.1);
  CHECK(arrival.old < 0.1 + kBusy);
  const Seen none = drive(scratch, ",clock=none", "stamp: kernel, latency: 0 s", 20.0);
  CHECK(none.ran.code == 1);
  CHECK_MESSAGE(none.ran.says("fits no clock of this host; state 'stamp: arrival'"), none.ran.text);
  const Seen ahead = drive(scratch, ",age=-80", "stamp: kernel, latency: 0 s", 20.0);
  CHECK(ahead.ran.code == 1);
  CHECK_MESSAGE(ahead.ran.says(" ms ahead of its arrival; state 'stamp: arrival'"), ahead.ran.text);
}

TEST_CASE("camera_driver: what a camera compressed itself is handed on byte for byte, else its half colour is said") {
  const Scratch scratch;
  std::vector<std::uint8_t> own;
  {
    using namespace vision::test_scene;
    vision::Renderer renderer{site(), lens(), laser(), {}, 3};
    own = vision::encode_jpeg(renderer.step(0.0, pose({0, 0, 0.4})), 70, true);
    std::ofstream out{scratch.path("own.jpg"), std::ios::binary};
    out.write(reinterpret_cast<const char*>(own.data()), static_cast<std::streamsize>(own.size()));
  }
  const Seen handed = drive(scratch, ",mjpg", "format: MJPG, latency: 0 s", 3.0);
  REQUIRE_MESSAGE(handed.pictures.size() > 1, handed.ran.text);
  for (const auto& picture : handed.pictures) CHECK(picture.jpeg == own);
  const Seen made = drive(scratch, "", "latency: 0 s", 3.0);
  REQUIRE_MESSAGE(made.pictures.size() > 1, made.ran.text);
  CHECK(vision::halves_colour(made.pictures.front().jpeg));
  std::ofstream{scratch.path("own.jpg"), std::ios::binary}.write(reinterpret_cast<const char*>(own.data()), 5000);
  const Seen torn = drive(scratch, ",mjpg", "format: MJPG, latency: 0 s", 3.0);
  CHECK(torn.pictures.empty());
  CHECK_MESSAGE(torn.ran.says("corrupt JPEG"), torn.ran.text);
  CHECK(torn.ran.code == kStopped);
}

TEST_CASE("camera_driver: busy, unplugged, silent, or not as asked: one line each, and what comes back is used") {
  const Scratch scratch;
  const Seen busy = drive(scratch, ",busy", "latency: 0 s", 20.0);
  CHECK(busy.ran.code == 1);
  CHECK(busy.ran.lines() == 1);
  CHECK_MESSAGE(busy.ran.says("/dev/video42: busy"), busy.ran.text);
  for (const std::string asked :
       {"width: 1280, height: 720", "format: MJPG", "format: MJ", "stamp: sometimes", "width: 0"}) {
    CAPTURE(asked);
    const Seen other = drive(scratch, "", "latency: 0 s, " + asked, 20.0);
    CHECK(other.ran.code == 1);
    CHECK_MESSAGE(other.ran.lines() == 1, other.ran.text);
  }
  const Seen back = drive(scratch, ",unplug=10,back=500", "stamp: kernel, latency: 0 s", 6.0);
  CHECK(back.ran.code == kStopped);
  CHECK_MESSAGE(back.ran.says("the camera gives no pictures any more; tried again every second"), back.ran.text);
  CHECK(back.ran.says("the camera is back"));
  CHECK(back.pictures.size() > 11);  // ten and what came after
  const Seen gone = drive(scratch, ",unplug=10", "stamp: kernel, latency: 0 s", 4.0);
  CHECK(gone.ran.code == kStopped);
  CHECK(gone.ran.lines() == 2);  // what it is and that it is gone: not once per attempt
  CHECK(gone.pictures.size() < 11);
  const Seen hung = drive(scratch, ",hang=10", "stamp: kernel, latency: 0 s", 3.0);
  CHECK(hung.ran.code == kStopped);  // and stops when told, while the camera is silent
  CHECK(hung.pictures.size() < 11);
}

TEST_CASE(
    "camera_driver: a camera that opens and gives nothing is waited for, said, and holds up neither bus nor end") {
  const Scratch scratch;
  const Seen never = drive(scratch, ",first=1e9", "stamp: kernel, latency: 0 s", 5.0);
  CHECK(never.ran.code == kStopped);
  CHECK(never.took < 5.0 + kBusy);  // OpenCV alone waits ten seconds
  CHECK(never.pictures.empty());
  CHECK(never.ran.lines() == 2);  // what it is, and that nothing comes
  CHECK_MESSAGE(never.ran.says("/dev/video42: opened, and gives no picture"), never.ran.text);
  const Seen late = drive(scratch, ",first=1500", "stamp: kernel, latency: 0 s", 4.0);
  CHECK(late.ran.code == kStopped);
  CHECK_MESSAGE(late.ran.lines() == 1, late.ran.text);
  CHECK(late.pictures.size() > 3);
}

TEST_CASE("camera_driver: HEALTH tells of a camera that opened and gives nothing, while it is waited for") {
  const Scratch scratch;
  test::Bus bus;
  const test::Background running{
      scratch, "driver", driver(scratch, ",first=1e9", "stamp: kernel, latency: 0 s") + " --in '" + bus.url + "'"};
  const auto told = [&] {
    return bus.health.size() > 2 && bus.health.back().state == "unhealthy" &&
           bus.health.back().detail.find("/dev/video42: no picture for") != std::string::npos;
  };
  CHECK_MESSAGE(bus.until(told), test::read_bytes(scratch.path("driver.text")));
}

}  // namespace fathom
