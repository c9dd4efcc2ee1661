// Bad pictures: each costs itself alone.
#include <doctest/doctest.h>

#include "common/vision/jpeg.hpp"
#include "common/vision/jpeg_stream.hpp"
#include "common/vision/watch.hpp"
#include "test/common/vision/scene.hpp"

namespace fathom::vision {
namespace {

using namespace test_scene;

Camera compressed(const cv::Mat& picture, Utime utime) {
  return {.utime = utime,
          .camera = "down",
          .width = picture.cols,
          .height = picture.rows,
          .jpeg = encode_jpeg(picture, 90)};
}

model::CameraMount mount() { return {.name = "down", .width = 640, .height = 480, .focal = 540, .lens = lens()}; }

}  // namespace

TEST_CASE("JPEG: what was written is read, colour and grey") {
  Renderer renderer{site(), lens(), laser(), {}, 13};
  const cv::Mat bgr = renderer.step(0.0, pose({0, 0, 0.4})).clone();
  cv::Mat grey, back;
  CHECK(decode_jpeg(encode_jpeg(bgr, 95), true, grey, back).empty());
  CHECK(cv::norm(bgr, back, cv::NORM_L1) / (640.0 * 480 * 3) < 4.0);  // brightness: noise and colour at half resolution
  CHECK(decode_jpeg(encode_jpeg(grey, 95), true, grey, back).empty());
  CHECK(back.empty());
  CHECK(grey.cols == 640);
}

TEST_CASE("JPEG: whether colour is halved is read from the file") {
  Renderer renderer{site(), lens(), laser(), {}, 13};
  const cv::Mat& bgr = renderer.step(0.0, pose({0, 0, 0.4}));
  CHECK_FALSE(halves_colour(encode_jpeg(bgr, 90)));
  CHECK(halves_colour(encode_jpeg(bgr, 90, true)));
  CHECK_FALSE(halves_colour(encode_jpeg(grey_of(bgr), 90, true)));
  CHECK_FALSE(halves_colour(std::vector<std::uint8_t>{0xff, 0xd8, 0xff}));
  CHECK_FALSE(halves_colour({}));
}

TEST_CASE("JPEG: out of a stream come whole pictures, in whatever pieces they arrive and whatever is between") {
  Renderer renderer{site(), lens(), std::nullopt, {}, 14};
  std::vector<std::uint8_t> one = encode_jpeg(renderer.step(0.0, pose({0, 0, 0.4})), 90);
  const std::vector<std::uint8_t> two = encode_jpeg(renderer.step(0.1, pose({0.1, 0, 0.4})), 90);
  // A thumbnail in a segment of its own has an end before the end.
  const std::vector<std::uint8_t> thumbnail{0xff, 0xe1, 0x00, 0x08, 0xff, 0xd8, 0xff, 0xd9, 0x00, 0x00};
  one.insert(one.begin() + 2, thumbnail.begin(), thumbnail.end());
  const std::string between = "\r\n--part\r\nContent-Type: image/jpeg\r\n\r\n";
  std::vector<std::uint8_t> all;
  const auto add = [&](const auto& bytes) { all.insert(all.end(), bytes.begin(), bytes.end()); };
  add(between);
  add(one);
  add(between);
  add(std::vector<std::uint8_t>(two.begin(), two.begin() + 5000));  // torn: the line was full
  add(two);
  add(one);
  add(std::vector<std::uint8_t>(100, 0xff));
  add(two);
  for (const std::size_t piece : {std::size_t{1}, std::size_t{7}, std::size_t{4096}, all.size()}) {
    CAPTURE(piece);
    JpegStream stream;
    std::vector<std::vector<std::uint8_t>> found;
    for (std::size_t at = 0; at < all.size(); at += piece) {
      stream.feed(std::span{all}.subspan(at, std::min(piece, all.size() - at)),
                  [&](std::vector<std::uint8_t> bytes) { found.push_back(std::move(bytes)); });
    }
    REQUIRE(found.size() == 4);
    CHECK(found[0] == one);
    CHECK(found[1] == two);
    CHECK(found[2] == one);
    CHECK(found[3] == two);
    CHECK(stream.torn() == 1);
    CHECK_FALSE(stream.inside());
  }
}

TEST_CASE("JPEG: a stream that never ends a picture is given up, and one that is opened anew begins anew") {
  JpegStream stream;
  int found = 0;
  const auto count = [&](const std::vector<std::uint8_t>&) { ++found; };
  stream.feed(std::vector<std::uint8_t>{0xff, 0xd8, 0xff, 0xda, 0x00, 0x02}, count);
  const std::vector<std::uint8_t> endless(1U << 20U, 0x55);
  for (int i = 0; i < 17; ++i) stream.feed(endless, count);
  CHECK(stream.torn() == 1);
  CHECK_FALSE(stream.inside());
  stream.feed(std::vector<std::uint8_t>{0xff, 0xd8, 0xff}, count);
  CHECK(stream.inside());
  stream.restart();
  stream.feed(std::vector<std::uint8_t>{0xff, 0xd9}, count);
  CHECK(found == 0);
  CHECK(stream.torn() == 2);
}

TEST_CASE("JPEG: damaged bytes are told as such, wherever the damage is") {
  Renderer renderer{site(), lens(), std::nullopt, {}, 14};
  const std::vector<std::uint8_t> good = encode_jpeg(renderer.step(0.0, pose({0, 0, 0.4})), 90);
  cv::Mat grey, bgr;
  CHECK_FALSE(decode_jpeg({}, true, grey, bgr).empty());
  CHECK_FALSE(decode_jpeg(std::vector<std::uint8_t>{1, 2, 3, 4}, true, grey, bgr).empty());
  for (const double share : {0.01, 0.3, 0.9, 0.999}) {
    const auto length = static_cast<std::size_t>(share * static_cast<double>(good.size()));
    CHECK_FALSE(decode_jpeg(std::span{good}.first(length), true, grey, bgr).empty());
  }
  std::vector<std::uint8_t> bad = good;
  for (std::size_t i = bad.size() / 2; i < bad.size() / 2 + 400; ++i) bad[i] = 0xff;
  CHECK_FALSE(decode_jpeg(bad, true, grey, bgr).empty());
}

TEST_CASE("watch: corrupt, black, saturated, frozen and other pictures are said, and the next good one is read") {
  const model::Site place = site();
  Renderer renderer{place, lens(), laser(), {}, 15};
  Watch watch{place, mount(), laser(), {}};
  const auto good = [&](double t) { return renderer.step(t, pose({0.05, 0.0, 0.4}, 0.05, 0.0, 0.2)).clone(); };
  Utime utime = 1'000'000;
  const auto see = [&](const cv::Mat& picture) { return watch.see(compressed(picture, utime += 33'000)); };
  CHECK(see(good(0.0)));
  CHECK(watch.complaint().empty());
  CHECK(watch.front_end().tag_poses("down").size() >= 2);
  CHECK(watch.front_end().laser_range("down"));

  Camera broken = compressed(good(0.1), utime += 33'000);
  broken.jpeg.resize(broken.jpeg.size() / 2);
  CHECK_FALSE(watch.see(broken));
  CHECK(watch.complaint().starts_with("corrupt JPEG"));
  CHECK(watch.front_end().tag_poses("down").empty());

  CHECK(see(cv::Mat(480, 640, CV_8UC3, cv::Scalar{1, 2, 1})));
  CHECK(watch.complaint().find("black") != std::string::npos);
  CHECK(see(cv::Mat(480, 640, CV_8UC3, cv::Scalar{255, 255, 255})));
  CHECK(watch.complaint().find("saturated") != std::string::npos);
  CHECK(see(cv::Mat(240, 320, CV_8UC3, cv::Scalar{90, 120, 60})));
  CHECK(watch.complaint().find("320 x 240") != std::string::npos);
  CHECK(see(good(0.2)));
  CHECK(watch.complaint().empty());
  const cv::Mat still = good(0.3);
  for (int i = 0; i < 4; ++i) CHECK(see(still));
  CHECK(watch.complaint().find("frozen") != std::string::npos);
  CHECK(watch.front_end().tag_poses("down").empty());
  CHECK(see(good(0.4)));
  CHECK(watch.complaint().empty());
  CHECK_FALSE(watch.front_end().tag_poses("down").empty());
}

TEST_CASE("watch: a picture that comes again and again tells nothing new, and flow goes on from the last new one") {
  const model::Site place = site();
  constexpr double kSpeed = 0.2;  // m/s
  for (const bool sensor : {true, false}) {
    CAPTURE(sensor);
    Renderer renderer{place, lens(), std::nullopt, {.caustics = 0.0}, 18};
    Watch watch{place, mount(), std::nullopt, {}};
    int flows = 0;
    cv::Mat picture;
    for (int i = 0; i < 24; ++i) {
      const Utime utime = utime_after(1'000'000, i / 30.0);
      if (sensor) watch.hear({.utime = utime, .has_attitude = true});
      // Every other one twice, and once a stop of a fifth of a second.
      const int taken = i >= 12 && i < 18 ? 12 : i - i % 2;
      const bool again = taken != i;
      if (!again) picture = renderer.step(i / 30.0, pose({kSpeed * i / 30.0, 0.0, 0.4})).clone();
      CHECK(watch.see(compressed(picture, utime)));
      const auto flow = watch.front_end().optical_flow("down");
      CHECK(watch.front_end().tag_poses("down").empty() == again);
      if (again) CHECK_FALSE(flow);
      if (!flow) continue;
      CHECK(flow->flow_C.x() == doctest::Approx(-kSpeed / 1.1).epsilon(0.06));  // -v / z
      ++flows;
    }
    CHECK(flows == 9);  // of ten new pictures
    CHECK(watch.complaint().empty());
  }
}

TEST_CASE("watch: flow needs the attitude sensor where tags are missing, and is then the camera's motion") {
  model::Site bare = site();
  bare.tags.clear();
  Renderer renderer{bare, lens(), laser(), {.caustics = 0.0}, 16};
  Watch watch{bare, mount(), laser(), {}};
  Utime utime = 1'000'000;
  for (int i = 0; i < 6; ++i) {
    utime += 33'333;
    watch.hear({.utime = utime, .has_attitude = true});
    watch.see(compressed(renderer.step(i / 30.0, pose({0.01 * i, 0.0, 0.38 + 0.004 * i})), utime));
  }
  const auto flow = watch.front_end().optical_flow("down");
  REQUIRE(flow);
  CHECK(flow->flow_C.x() == doctest::Approx(-0.3 / 1.1).epsilon(0.05));  // -v / z
  REQUIRE(flow->tells_approach());
  CHECK(std::abs(flow->flow_C.z() + 0.12 / 1.1) < 4.0 * std::sqrt(flow->covariance(2, 2)));
  CHECK(std::sqrt(flow->covariance(2, 2)) < 0.1);
  REQUIRE(watch.front_end().sight().v_C);
  CHECK(watch.front_end().sight().v_C->x() == doctest::Approx(0.3).epsilon(0.05));
  CHECK(watch.drawing(80));
}

TEST_CASE("attitude: between samples, a little ahead, by rates; nothing where the sensor was silent") {
  constexpr double kExact = 1e-9;
  AttitudeHistory history;
  const Eigen::Vector3d w{0.1, -0.2, 0.5};
  for (int i = 0; i <= 20; ++i) {
    history.hear({.utime = 10'000 * i,
                  .w_WB_B = w,
                  .q_WB = quaternion_from_rotation_vector(0.01 * i * w),
                  .has_rates = true,
                  .has_attitude = true});
  }
  const auto angle = [](const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) { return a.angularDistance(b); };
  REQUIRE(history.at(123'456));
  CHECK(angle(*history.at(123'456), quaternion_from_rotation_vector(0.123456 * w)) < kExact);
  REQUIRE(history.at(230'000));
  CHECK(angle(*history.at(230'000), quaternion_from_rotation_vector(0.23 * w)) < kExact);
  CHECK_FALSE(history.at(400'000));
  REQUIRE(history.turn(33'333, 166'667));
  CHECK(angle(*history.turn(33'333, 166'667), quaternion_from_rotation_vector(0.133334 * w)) < kExact);
  REQUIRE(history.turn(190'000, 220'000));
  CHECK(angle(*history.turn(190'000, 220'000), quaternion_from_rotation_vector(0.03 * w)) < kExact);
  CHECK_FALSE(history.turn(-5'000, 50'000));
  CHECK_FALSE(history.turn(100'000, 300'000));
}

TEST_CASE("watch: two tags of one number in the map cost these two and are said") {
  model::Site place = site();
  place.doubtful_tags = {{"tag36h11", 12}};
  std::erase_if(place.tags, [](const model::Tag& t) { return t.id == 12; });
  Renderer renderer{site(), lens(), std::nullopt, {}, 17};
  Watch watch{place, mount(), std::nullopt, {}};
  CHECK(watch.see(compressed(renderer.step(0.0, pose({0, 0, 0.4})), 1'000'000)));
  CHECK(watch.complaint().find("12") != std::string::npos);
  CHECK(watch.front_end().tag_poses("down").size() >= 2);
}

}  // namespace fathom::vision
