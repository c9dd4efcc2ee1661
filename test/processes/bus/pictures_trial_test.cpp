// A live trial by rendered pictures, as ./trial --live --camera runs it, against the same one by simulated
// measurements.
#include <doctest/doctest.h>

#include <algorithm>

#include "common/base/event_log.hpp"
#include "common/wire/log_reader.hpp"
#include "test/support/live.hpp"

namespace fathom {
namespace {

using test::live;
using test::live_network;
using test::program;
using test::Scratch;
using test::shell;

constexpr double kSeconds = 25.0, kRate = 30.0;  // of the trial; pictures a second
constexpr double kLatency = 0.04;                // s, of the camera
constexpr double kFrontEnd = 0.25;               // px: a fitted corner; a simulated one errs by half a pixel

double median_reprojection(const Recording& run) {
  std::vector<double> errors;
  for (const TagPose& each : run.tag_pose) errors.push_back(each.reprojection_error);
  REQUIRE(errors.size() > 500);
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  return *middle;
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

}  // namespace

TEST_CASE("live: by rendered pictures the same vehicle is identified") {
  if (!live_network()) return;
  const Scratch scratch, plain;
  const auto ran = shell(live(scratch, "tank seabotix_lbv150 optimal lockstep 1008 25 --camera"));
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  CHECK(test::nothing_left(scratch));
  const std::string log = scratch.path("out/run.lcmlog");
  const Recording run = wire::read_log(log).recording;

  // What vision measured is there, once for each picture, and nothing that was simulated in its place.
  const auto pictures = static_cast<std::size_t>((kSeconds - kLatency) * kRate);
  CHECK(run.laser_range.size() > pictures * 9 / 10);
  CHECK(run.laser_range.size() <= pictures + 1);
  CHECK(run.optical_flow.size() > pictures * 9 / 10);
  CHECK(run.optical_flow.size() <= pictures);
  CHECK(median_reprojection(run) < kFrontEnd);
  CHECK(std::any_of(run.health.begin(), run.health.end(), [](const Health& each) {
    return each.process == "vision" && each.detail.find("tags accepted") != std::string::npos;
  }));

  // The log keeps a few drawn pictures, and the page shows a dozen.
  CHECK(wire::read_pictures(log, "CAMERA", 1).empty());
  const std::size_t drawn = wire::read_pictures(log, "CAMERA_DEBUG", 1000).size();
  CHECK(drawn >= 12);
  CHECK(drawn <= 16);
  const std::string page = test::read_bytes(scratch.path("out/report.html"));
  CHECK(page.find("What the camera saw") != std::string::npos);
  CHECK(count(page, "data:image/jpeg;base64,/9j/") == 12);
  for (const char* word : {"http:", "https:", "<script"}) CHECK(page.find(word) == std::string::npos);

  // Of thirteen 95 % intervals two may miss the truth by chance, and of thirteen pairs one may not meet.
  const nlohmann::json result = test::result_of(scratch);
  std::size_t inside = 0;
  for (const auto& each : result["compared_with_truth"]["parameters"])
    inside += each["inside_interval"] == true ? 1 : 0;
  CHECK_MESSAGE(inside >= 11, ran.text);
  const auto again = shell(live(plain, "tank seabotix_lbv150 optimal lockstep 1008 25"));
  REQUIRE_MESSAGE(again.code == 0, again.text);
  CHECK(median_reprojection(wire::read_log(plain.path("out/run.lcmlog")).recording) > kFrontEnd);
  const auto compared =
      shell(program("fathom") + " compare --intervals '" + log + "' '" + plain.path("out/run.lcmlog") + "'");
  CHECK_MESSAGE((compared.says("13 of 13 parameters agree") || compared.says("12 of 13 parameters agree")),
                compared.text);
}

TEST_CASE("live: pictures where there are none, and pictures beside byte-true instruments, are refused in one line") {
  const Scratch scratch;
  for (const std::string words :
       {"deep seabotix_lbv150 paper lockstep 1 10 --camera", "tank seabotix_lbv150 paper bytes 1 10 --camera"}) {
    const auto ran = shell(live(scratch, words));
    CHECK(ran.code == 1);
    CHECK_MESSAGE(ran.lines() == 1, ran.text);
    CHECK_MESSAGE(ran.says("--camera: "), ran.text);
  }
}

}  // namespace fathom
