// Pictures through the processes: camera_driver reads a folder, vision its log, and fathom track the same without LCM.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "common/base/event_log.hpp"
#include "common/wire/log_reader.hpp"
#include "test/common/vision/picture_folder.hpp"
#include "test/support/channels.hpp"
#include "test/support/scratch.hpp"
#include "test/support/shell.hpp"
#include "test/support/timing.hpp"

namespace fathom {
namespace {

using test::file;
using test::program;
using test::Scratch;
using test::shell;
using namespace vision::test_scene;

constexpr int kPictures = 12;
constexpr double kPlace = 0.01;  // m: a tag at 1.3 m, 0.2 px, JPEG

// The tank of config/sites/tank.yaml seen by the camera of the SeaBotix, as JPEG files.
void make_pictures(const std::string& folder) {
  const model::Site place = model::Site::load(std::string{FATHOM_SOURCE_DIR} + "/config/sites/tank.yaml");
  write_pictures(vision::Renderer{place, lens(), laser(), {}, 21}, folder, kPictures, [](int i) {
    return pose({0.02 * i, 0.01 * i, 0.2}, 0.0, 0.0, 1.5708);
  });
  std::fstream damaged{folder + "/5.jpg", std::ios::in | std::ios::out | std::ios::binary};
  damaged.seekp(2000);
  damaged.write("garbage garbage garbage", 23);
}

std::map<std::string, std::vector<std::string>> messages(const std::string& path) {
  std::map<std::string, std::vector<std::string>> found;
  EventLog log{path};
  while (const auto event = log.next())
    found[std::string{event->channel}].emplace_back(event->data.begin(), event->data.end());
  return found;
}

std::vector<std::string> lines(const std::string& path) {
  std::ifstream in{path};
  std::vector<std::string> all;
  for (std::string line; std::getline(in, line);) all.push_back(line);
  return all;
}

const std::string kConfig = " --log-level warning --config " + file("config/pipelines/tank.yaml") + " --config " +
                            file("config/vehicles/seabotix_lbv150.yaml") + " --config " +
                            file("config/sites/tank.yaml");

}  // namespace

TEST_CASE("vision: hears and says what docs/messages.md tells, as does camera_driver") {
  const Scratch scratch;
  std::ofstream{scratch.path("camera.yaml")} << "camera_driver: {camera: down, pictures: x, rate: 10 Hz}\n";
  const std::vector<std::pair<std::string, std::string>> all{
      {"vision", kConfig}, {"camera_driver", " --config " + scratch.path("camera.yaml")}};
  for (const auto& process : all) {
    const std::string& name = process.first;
    CAPTURE(name);
    const auto ran = shell(program(name) + process.second + " --interface");
    REQUIRE_MESSAGE(ran.code == 0, ran.text);
    const test::Channels actual = test::channels_of(ran.text), stated = test::channels_in_docs(name);
    CHECK(actual.hears == stated.hears);
    CHECK(actual.says == stated.says);
  }
}

TEST_CASE("vision: a folder through camera_driver and vision: tags where they are, twice the same, debug pictures") {
  const Scratch scratch;
  make_pictures(scratch.path("pictures"));
  std::ofstream{scratch.path("camera.yaml")} << "camera_driver: {camera: down, pictures: " << scratch.path("pictures")
                                             << ", rate: 30 Hz}\n";
  const auto drove = shell(program("camera_driver") + " --log-level error --config " + scratch.path("camera.yaml") +
                           " --out file://" + scratch.path("camera.lcmlog"));
  REQUIRE_MESSAGE(drove.code == 0, drove.text);
  CHECK(messages(scratch.path("camera.lcmlog"))["CAMERA"].size() == kPictures - 1);
  const auto see = [&](const std::string& name, const std::string& options) {
    const auto ran = shell(program("vision") + kConfig + " --in file://" + scratch.path("camera.lcmlog") +
                           " --out file://" + scratch.path(name) + options);
    REQUIRE_MESSAGE(ran.code == 0, ran.text);
    return messages(scratch.path(name));
  };
  auto seen = see("one.lcmlog", "");
  CHECK(seen["TAG_POSE"].size() >= 4 * (kPictures - 1));
  CHECK(seen["LASER_RANGE"].size() >= kPictures - 3);
  CHECK(seen["CAMERA_DEBUG"].empty());
  CHECK(see("two.lcmlog", "")["TAG_POSE"] == seen["TAG_POSE"]);
  CHECK_FALSE(see("debug.lcmlog", " --debug")["CAMERA_DEBUG"].empty());
  const Recording recording = wire::read_log(scratch.path("one.lcmlog")).recording;
  const model::Site place = model::Site::load(std::string{FATHOM_SOURCE_DIR} + "/config/sites/tank.yaml");
  const TagPose& first = recording.tag_pose.front();
  const vision::Pose truth = pose({0.0, 0.0, 0.2}, 0.0, 0.0, 1.5708);
  const Eigen::Vector3d p_CT = truth.R_WC.transpose() * (place.tag(first.tag)->p_WT - truth.p_WC);
  CHECK((first.p_CT - p_CT).norm() < kPlace);
}

TEST_CASE("camera_driver: a camera that is missing or none at all is told in one line") {
  const Scratch scratch;
  for (const auto& [device, words] : {std::pair{"/dev/video987", ": no such device; "}, {"/dev/null", ": no camera"}}) {
    std::ofstream{scratch.path("camera.yaml")} << "camera_driver: {camera: down, device: " << device
                                               << ", latency: 0 s}\n";
    const auto ran = shell(program("camera_driver") + " --config " + scratch.path("camera.yaml") + " --out file://" +
                           scratch.path("camera.lcmlog"));
    CHECK(ran.code == 1);
    CHECK_MESSAGE(ran.lines() == 1, ran.text);
    CHECK_MESSAGE(ran.says(device + std::string{words}), ran.text);
  }
}

TEST_CASE("fathom track: pictures of which none can be read are an error; each has its row all the same") {
  const Scratch scratch;
  std::filesystem::create_directories(scratch.path("pictures"));
  for (const char* name : {"/a.png", "/b.jpg"}) std::ofstream{scratch.path("pictures") + name} << "no picture";
  const auto ran =
      shell(program("fathom") + " track " + scratch.path("pictures") + " --csv " + scratch.path("out.csv"));
  CHECK(ran.code == 1);
  CHECK_MESSAGE(ran.says("none of its pictures can be read"), ran.text);
  CHECK(lines(scratch.path("out.frames.csv")).size() == 3);
}

TEST_CASE("fathom track: a row per detection and per picture, a damaged one said and left out, drawings") {
  const Scratch scratch;
  make_pictures(scratch.path("pictures"));
  const auto ran = shell(program("fathom") + " track " + scratch.path("pictures") + " --site " +
                         file("config/sites/tank.yaml") + " --vehicle " + file("config/vehicles/seabotix_lbv150.yaml") +
                         " --csv " + scratch.path("out.csv") + " --pictures " + scratch.path("drawn"));
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  CHECK(ran.says("5.jpg: corrupt JPEG"));
  CHECK(ran.says("the lens has no distortion"));  // as rendered; a real one wants calibrating
  const auto frames = lines(scratch.path("out.frames.csv")), detections = lines(scratch.path("out.csv"));
  CHECK(frames.size() == kPictures + 1);
  CHECK(detections.size() > 4 * kPictures);
  CHECK(detections.front().starts_with("frame,family,id,x0_px,y0_px"));
  for (const std::string& row : frames) {
    CHECK(std::count(row.begin(), row.end(), ',') == std::count(frames[0].begin(), frames[0].end(), ','));
  }
  for (const std::string& row : detections) {
    CHECK(std::count(row.begin(), row.end(), ',') == std::count(detections[0].begin(), detections[0].end(), ','));
  }
  CHECK(frames[2].find("1.jpg,0.1") == 0);
  CHECK(frames[11].find("10.jpg") == 0);  // numbers by value: 10 after 9
  CHECK(std::filesystem::exists(scratch.path("drawn/3.jpg")));
}

TEST_CASE("fathom track: without map or lens there are detections; nonsense is one clear line") {
  const Scratch scratch;
  make_pictures(scratch.path("pictures"));
  const std::string to = " --csv " + scratch.path("out.csv");
  const auto bare = shell(program("fathom") + " track " + scratch.path("pictures") + to);
  REQUIRE_MESSAGE(bare.code == 0, bare.text);
  CHECK(lines(scratch.path("out.csv")).size() > 4 * kPictures);
  std::ofstream{scratch.path("site.yaml")} << "site: bare\ntag_search: {families: [tag36h11, tag16h5]}\n";
  const auto no_map =
      shell(program("fathom") + " track " + scratch.path("pictures") + " --site " + scratch.path("site.yaml") + to);
  CHECK_MESSAGE(no_map.code == 0, no_map.text);
  std::filesystem::create_directories(scratch.path("empty"));
  std::ofstream{scratch.path("text.mp4")} << "no video";
  std::ofstream{scratch.path("wrong.yaml")} << "site: x\ntag_search: {families: [tag99]}\n";
  for (const std::string& what : {scratch.path("nowhere"), scratch.path("empty"), scratch.path("text.mp4"),
                                  scratch.path("pictures") + " --site " + scratch.path("wrong.yaml")}) {
    CAPTURE(what);
    const auto ran = shell(program("fathom") + " track " + what + to);
    CHECK(ran.code == 1);
    CHECK(ran.says("fathom: "));
  }
  CHECK(shell(program("fathom") + " track").code == 2);
  CHECK(shell(program("fathom") + " track --help").says("--csv"));
  for (const char* rate : {"nan", "-nan", "inf", "0", "-5", "1e999", "fast"}) {
    CAPTURE(rate);
    const auto ran = shell(program("fathom") + " track " + scratch.path("pictures") + to + " --rate " + rate);
    CHECK(ran.code == 2);
    CHECK(ran.says("fathom: --rate"));
  }
  const auto lens = shell(program("fathom") + " calibrate " + scratch.path("pictures") + " --out " +
                          scratch.path("lens.yaml") + " --focal nan");
  CHECK(lens.code == 2);
  CHECK(lens.says("nan is not a finite number"));
  CHECK(shell(program("vision") + " --debug-every nan").says("nan is not a finite number"));
}

TEST_CASE("vision: in a simulated tank the estimator flies by rendered pictures as well as it says") {
  if (shell("unshare -rn ip link set lo up").code != 0) {
    MESSAGE("skipped: this machine allows no private network (unshare -rn)");
    return;
  }
  const Scratch scratch;
  const std::string all = kConfig + " --config " + file("config/operators/simulated.yaml") + " --config " +
                          file("config/corrections/none.yaml");
  const std::string script =
      "ip link set lo up; ip route add 224.0.0.0/4 dev lo; "
      "export LCM_DEFAULT_URL='udpm://239.255.76.67:7667?ttl=0&recv_buf_size=2097152'\n" +
      program("vision") + " --lockstep" + all + " &\n" + program("estimator") + " --lockstep" + all + " &\n" +
      program("recorder") + " --lockstep --file " + scratch.path("run.lcmlog") + " &\n" + program("simulator") + all +
      " --config " + file("config/simulation/seabotix_lbv150.yaml") +
      " --camera --speed 0 --duration 8 --seed 3 --wait-for vision,estimator,recorder\ncode=\\$?\nwait\nexit \\$code";
  const auto ran = shell(test::limit(120) + "unshare -rn sh -c \"" + script + "\"");
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  const Recording run = wire::read_log(scratch.path("run.lcmlog")).recording;
  CHECK(run.tag_pose.size() > 400);
  CHECK(run.optical_flow.size() > 150);
  CHECK(run.laser_range.size() > 150);
  REQUIRE(run.truth.size() > 100);
  constexpr double kSettled = 3.0, kNear = 0.04;  // s; m: what the pipeline states for tags, four times
  constexpr double kSameTime = 0.006;  // s: STATE lies half a sample of AHRS beside TRUTH, in which 2 mm are swum
  std::size_t compared = 0;
  for (const StateEstimate& state : run.state) {
    const auto truth = std::find_if(run.truth.begin(), run.truth.end(), [&](const Truth& each) {
      return std::abs(seconds_between(each.utime, state.utime)) < kSameTime;
    });
    if (truth == run.truth.end() || seconds_between(run.truth.front().utime, state.utime) < kSettled) continue;
    ++compared;
    CHECK((state.p_WB - truth->p_WB).norm() < kNear);
  }
  CHECK(compared > 20);
}

}  // namespace fathom
