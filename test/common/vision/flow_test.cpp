// Optical flow and the laser's dot in rendered pictures, where the truth is known.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <random>

#include "common/vision/flow/light_change.hpp"
#include "common/vision/flow/plane_flow.hpp"
#include "common/vision/flow/reduced_view.hpp"
#include "common/vision/jpeg.hpp"
#include "test/common/vision/scene.hpp"

namespace fathom::vision {
namespace {

using namespace test_scene;

constexpr double kPeriod = 1.0 / 30.0;
constexpr double kRate = 0.012;  // 1/s: 0.2 px of 540 in a thirtieth second
constexpr double kDivergence = 0.03;
constexpr double kRange = 0.01;  // of the range: 0.25 px of the dot at 1.2 m on a baseline of 6 cm

/// The camera on its way: velocity [m/s, in W] and turning rate [rad/s, in C].
struct Way {
  Eigen::Vector3d v_W, w_C;
};

Pose along(const Pose& start, const Way& way, double t) {
  return {.p_WC = start.p_WC + t * way.v_W,
          .R_WC = start.R_WC * quaternion_from_rotation_vector(t * way.w_C).toRotationMatrix()};
}

/// What flow says of each pair of pictures on a way, all of them valid, beside the truth v_C / z_C in the middle.
template <typename Use>
void look_along(Renderer& renderer, FlowTracker& tracker, const Pose& start, const Way& way, double floor, int pictures,
                Use use) {
  for (int i = 0; i < pictures; ++i) {
    const Pose now = along(start, way, i * kPeriod), before = along(start, way, (i - 1) * kPeriod);
    const Picture seen = picture(renderer, i * kPeriod, now);
    const Flow flow = tracker.step(seen.utime, seen.grey, before.R_WC.transpose() * now.R_WC, now.R_WC.row(2));
    REQUIRE(flow.state == (i == 0 ? FlowState::kFirst : FlowState::kValid));
    if (i == 0) continue;
    const Pose middle = along(start, way, (i - 0.5) * kPeriod);
    const double z = (floor - middle.p_WC.z()) / middle.R_WC(2, 2);
    use(flow, Eigen::Vector3d{middle.R_WC.transpose() * way.v_W / z});
  }
}

}  // namespace

TEST_CASE("flow: velocity over distance in all three directions while the camera turns and looks aslant") {
  const model::Site place = site();
  const std::vector<Way> ways{{{0.3, -0.2, 0.0}, {0.0, 0.0, 0.0}},
                              {{0.0, 0.0, 0.2}, {0.0, 0.0, 0.0}},
                              {{0.1, 0.15, -0.1}, {0.3, -0.2, 0.6}},
                              {{0.0, 0.0, 0.0}, {0.5, 0.4, -0.8}}};
  for (const double reduction : {1.0, 2.0}) {
    for (const Way& way : ways) {
      CAPTURE(way.v_W.transpose());
      CAPTURE(reduction);
      RenderSettings look;
      look.caustics = 0.0;
      Renderer renderer{place, lens(), std::nullopt, look, 8};
      FlowTracker tracker{lens(), {.reduction = reduction}};
      const Pose start = pose({0.1, 0.0, 0.4}, 0.15, -0.1, 0.5);
      constexpr int kPictures = 8;
      Eigen::Vector3d sum = Eigen::Vector3d::Zero(), wanted = Eigen::Vector3d::Zero();
      look_along(renderer, tracker, start, way, place.floor, kPictures,
                 [&](const Flow& flow, const Eigen::Vector3d& truth) {
                   sum += flow.rate;
                   wanted += truth;
                 });
      const Eigen::Vector3d error = (sum - wanted) / (kPictures - 1);
      CHECK(error.head<2>().norm() < kRate);
      CHECK(std::abs(error.z()) < kDivergence);
    }
  }
}

TEST_CASE("flow: what it says of its error is true with a sensor's rotation and with that of the tags' poses") {
  constexpr int kPictures = 60;
  constexpr double kBeyond = 21.1;  // chi squared of three: one in ten thousand
  const model::Site place = site();
  for (const bool sensor : {true, false}) {
    for (const double leaning : {0.0, 0.7}) {
      CAPTURE(sensor);
      CAPTURE(leaning);
      const Pose start = pose({-0.6 * std::tan(leaning), 0.0, 0.7}, 0.0, leaning);
      const Way way{{0.1, -0.15, 0.05}, {0.1, 0.0, 0.2}};
      Renderer renderer{place, lens(), std::nullopt, {.caustics = 0.0}, 12};
      FrontEnd front_end{place, lens(), std::nullopt, {}};
      int valid = 0, beyond = 0;
      for (int i = 0; i < kPictures; ++i) {
        const Pose now = along(start, way, i * kPeriod);
        const std::optional<Eigen::Matrix3d> R_WC = sensor ? std::optional{now.R_WC} : std::nullopt;
        const Flow flow = front_end.step(picture(renderer, i * kPeriod, now), R_WC).flow;
        if (i == 0 || flow.state != FlowState::kValid) continue;
        const Pose middle = along(start, way, (i - 0.5) * kPeriod);
        const double z = (place.floor - middle.p_WC.z()) / middle.R_WC(2, 2);
        const Eigen::Vector3d error = flow.rate - middle.R_WC.transpose() * way.v_W / z;
        beyond += error.dot(flow.covariance.ldlt().solve(error)) > kBeyond ? 1 : 0;
        ++valid;
      }
      CHECK(valid > kPictures / 2);
      CHECK(beyond == 0);
    }
  }
}

TEST_CASE("flow: a divergence that moves features by less than a pixel is read in full, and its error is as stated") {
  constexpr double kShare = 0.02;  // of the divergence, in the mean; five without smoothing
  constexpr double kStated = 2.5;  // of one, the mean square of error over what is stated
  constexpr int kDives = 6, kPictures = 12;
  const model::Site place = site();
  double seen = 0.0, wanted = 0.0, squares = 0.0;
  for (int dive = 0; dive < kDives; ++dive) {
    Renderer renderer{place, lens(), std::nullopt, {.caustics = 0.0}, static_cast<std::uint64_t>(50 + dive)};
    FlowTracker tracker{lens(), {}};
    const Pose start = pose({0.07 * dive, -0.1, 0.2 + 0.05 * dive}, 0.02, -0.03, 0.9 * dive);
    const Way way{{0.02, 0.03, dive % 2 == 0 ? 0.09 : -0.09}, Eigen::Vector3d::Zero()};
    look_along(renderer, tracker, start, way, place.floor, kPictures,
               [&](const Flow& flow, const Eigen::Vector3d& truth) {
                 seen += flow.rate.z() * truth.z();
                 wanted += truth.z() * truth.z();
                 squares += (flow.rate.z() - truth.z()) * (flow.rate.z() - truth.z()) / flow.covariance(2, 2);
               });
  }
  CHECK(std::abs(seen / wanted - 1.0) < kShare);
  CHECK(squares / (kDives * (kPictures - 1)) < kStated);
}

TEST_CASE("flow: the distance along an aslant axis changes with a shift along the floor and with a turn") {
  std::mt19937_64 random{3};
  std::uniform_real_distribution<double> draw{-1.0, 1.0};
  constexpr double kFloor = 1.5;
  const auto distance = [](const Pose& at) { return (kFloor - at.p_WC.z()) / at.R_WC(2, 2); };
  for (int i = 0; i < 20; ++i) {
    const Pose start =
        pose({draw(random), draw(random), 0.7}, 0.3 * draw(random), 0.3 * draw(random), 3.0 * draw(random));
    const Way way{{draw(random), draw(random), draw(random)}, {draw(random), draw(random), draw(random)}};
    const Pose end = along(start, way, kPeriod);
    const Eigen::Vector3d normal = start.R_WC.row(2), shift = start.R_WC.transpose() * (end.p_WC - start.p_WC);
    const PlaneMotion motion{
        .R_01 = start.R_WC.transpose() * end.R_WC, .n_0 = normal / normal.z(), .tau = shift / distance(start)};
    for (const double share : {0.5, 1.0}) {
      const Pose there = along(start, way, share * kPeriod);
      CHECK(motion.distance(share) == doctest::Approx(distance(there) / distance(start)).epsilon(1e-12));
      CHECK((motion.turned(share) - start.R_WC.transpose() * there.R_WC).norm() < 1e-12);
    }
  }
}

TEST_CASE("flow: aslant over the floor, there and back are equally fast") {
  // A roll of 0.25 rad and 2.2 cm of way at 0.5 m: half of both's product is 0.55 % of the speed, to either side.
  constexpr double kRoll = 0.25, kSpeed = 0.65, kShare = 0.003;
  constexpr int kPictures = 8;
  const model::Site place = site();
  for (const double speed : {kSpeed, -kSpeed}) {
    Renderer renderer{place, lens(), std::nullopt, {.caustics = 0.0}, 21};
    FlowTracker tracker{lens(), {}};
    const Pose start = pose({0.1, speed < 0.0 ? 0.1 : -0.1, place.floor - 0.5}, kRoll, 0.0, 0.0);
    const Way way{{0.0, speed, 0.0}, Eigen::Vector3d::Zero()};
    double seen = 0.0, wanted = 0.0;
    look_along(renderer, tracker, start, way, place.floor, kPictures,
               [&](const Flow& flow, const Eigen::Vector3d& truth) {
                 seen += flow.rate.head<2>().dot(truth.head<2>());
                 wanted += truth.head<2>().squaredNorm();
               });
    CAPTURE(speed);
    CHECK(std::abs(seen / wanted - 1.0) < kShare);
  }
}

TEST_CASE("flow: light that changes over a feature does not move it") {
  constexpr float kStart = 0.3F;  // px
  constexpr double kGood = 0.03;
  cv::Mat before(40, 40, CV_32FC1), now(40, 40, CV_32FC1);
  const Eigen::Vector2d shift{1.3, -0.7};
  const auto floor = [](double x, double y) { return 90.0 + 25.0 * std::sin(0.7 * x + 0.3 * y) * std::cos(0.5 * y); };
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) {
      before.at<float>(y, x) = cv::saturate_cast<std::uint8_t>(floor(x, y));
      const double there = floor(x - shift.x(), y - shift.y());
      now.at<float>(y, x) = cv::saturate_cast<std::uint8_t>(1.1 * there + 5.0 + 0.8 * (x - 20) - 0.5 * (y - 20));
    }
  }
  const cv::Point2f from{19.3F, 20.6F}, true_end{20.6F, 19.9F};
  const auto end = end_in_changed_light(before, now, from, true_end + cv::Point2f{kStart, -0.6F * kStart});
  REQUIRE(end);
  CHECK(end->near);
  CHECK(std::hypot(end->at.x - true_end.x, end->at.y - true_end.y) < kGood);
  CHECK_FALSE(end_in_changed_light(before, now, {3.0F, 20.0F}, true_end));                         // at the border
  CHECK_FALSE(end_in_changed_light(before, now, from, true_end + cv::Point2f{1.5F, 1.0F})->near);  // far off
  CHECK_FALSE(end_in_changed_light(cv::Mat(40, 40, CV_32FC1, cv::Scalar{80}), now, from, true_end));
}

TEST_CASE("flow: moving light on a bare floor is not taken for motion") {
  constexpr double kLight = 0.004;  // 1/s, of the mean over half a second; by Lucas-Kanade alone three times that
  model::Site bare = site();
  bare.tags.clear();
  double squares = 0.0;
  constexpr int kDives = 5, kPictures = 15;
  for (int dive = 0; dive < kDives; ++dive) {
    Renderer renderer{bare, lens(), std::nullopt, {.caustics = 0.3}, static_cast<std::uint64_t>(30 + dive)};
    FlowTracker tracker{lens(), {}};
    const Pose start = pose({0.1 * dive, -0.2, 0.3 + 0.12 * dive}, 0.03, 0.02, dive);
    const Way way{{0.1 * (dive - 2), 0.05, 0.0}, {0.0, 0.0, 0.0}};
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (int i = 0; i < kPictures; ++i) {
      const Pose now = along(start, way, i * kPeriod);
      const Picture seen = picture(renderer, 17.0 * dive + i * kPeriod, now);
      const Eigen::Vector3d n_C = now.R_WC.row(2);
      const Flow flow = tracker.step(seen.utime, seen.grey, Eigen::Matrix3d::Identity(), n_C);
      if (i == 0) continue;
      REQUIRE(flow.state == FlowState::kValid);
      const double z = (bare.floor - now.p_WC.z()) / now.R_WC(2, 2);
      sum += (flow.rate - now.R_WC.transpose() * way.v_W / z).head<2>();
    }
    squares += (sum / (kPictures - 1)).squaredNorm() / 2.0;
  }
  CHECK(std::sqrt(squares / kDives) < kLight);
}

TEST_CASE("flow: tracks that err alike in parts of the picture leave the error larger than chance") {
  constexpr int kAcross = 16, kDown = 12;
  std::vector<FlowRow> alone, together;
  std::mt19937 generator{5};
  std::normal_distribution<double> normal;
  std::array<Eigen::Vector2d, 12> shared;
  for (Eigen::Vector2d& each : shared) each = 1e-3 * Eigen::Vector2d{normal(generator), normal(generator)};
  for (int i = 0; i < kAcross * kDown; ++i) {
    const int column = i % kAcross, row = i / kAcross;
    const Eigen::Vector2d y{0.06 * column - 0.45, 0.06 * row - 0.33};
    const Eigen::Vector2d own = 1e-3 * Eigen::Vector2d{normal(generator), normal(generator)};
    alone.push_back({.d = own, .y = y, .s = 1.0});
    together.push_back({.d = shared[static_cast<std::size_t>(row / 4 * 4 + column / 4)], .y = y, .s = 1.0});
  }
  const double by_chance = std::sqrt(fit_plane_flow(alone).covariance(0, 0));
  CHECK(by_chance < 2e-4);  // 1e-3 over the root of 192, and what parts that are few add
  CHECK(std::sqrt(fit_plane_flow(together).covariance(0, 0)) > 1.8 * by_chance);
}

TEST_CASE("flow: no valid flow without texture, rotation, or after a pause") {
  FlowTracker tracker{lens(), {}};
  const cv::Mat blank(480, 640, CV_8UC1, cv::Scalar{80});
  const Eigen::Matrix3d still = Eigen::Matrix3d::Identity();
  CHECK(tracker.step(0, blank, still, std::nullopt).state == FlowState::kFirst);
  CHECK(tracker.step(33'000, blank, still, std::nullopt).state == FlowState::kNoTexture);
  Renderer renderer{site(), lens(), std::nullopt, {}, 9};
  const Pose at = pose({0.1, 0.0, 0.4});
  tracker.reset();
  CHECK(tracker.step(0, picture(renderer, 0.0, at).grey, still, std::nullopt).state == FlowState::kFirst);
  CHECK(tracker.step(33'000, picture(renderer, 0.033, at).grey, std::nullopt, std::nullopt).state ==
        FlowState::kNoRotation);
  CHECK(tracker.step(2'000'000, picture(renderer, 2.0, at).grey, still, std::nullopt).state == FlowState::kPause);
}

TEST_CASE("flow: a third of the tracks going elsewhere does not spoil the rest") {
  std::vector<FlowRow> rows;
  const Eigen::Vector3d tau{0.02, -0.01, 0.015};
  for (int i = 0; i < 60; ++i) {
    const Eigen::Vector2d x{0.1 * (i % 8) - 0.35, 0.08 * std::floor(i / 8.0) - 0.3};
    const double s = 1.0 + 0.1 * x.x();
    // Exact by geometry: a point at depth 1 / s moves to where the shifted camera sees it.
    const Eigen::Vector2d y = (x / s - tau.head<2>()) / (1.0 / s - tau.z());
    Eigen::Vector2d d = y - x;
    if (i % 3 == 0) d += Eigen::Vector2d{0.03, 0.02};
    rows.push_back({.d = d, .y = x + d, .s = s});
  }
  const PlaneFlow flow = fit_plane_flow(rows);
  CHECK((flow.tau - tau).norm() < 1e-6);
  CHECK(flow.n_agreed == 40);
}

TEST_CASE("laser: the dot's range is the truth, at every distance, tilted, over tags and through caustics") {
  Renderer renderer{site(), lens(), laser(), {.caustics = 0.4}, 10};
  LaserFinder finder{lens(), laser(), {}};
  int found = 0;
  for (int i = 0; i < 60; ++i) {
    const Pose at = pose({0.02 * i - 0.6, 0.013 * i - 0.4, 0.1 + 0.015 * i}, 0.002 * i, 0.1 - 0.003 * i, 0.1 * i);
    const auto truth = renderer.dot(at);
    const cv::Mat& bgr = renderer.step(0.1 * i, at);
    const LaserDot dot = finder.step(bgr, grey_of(bgr), false);
    if (!truth) continue;
    if (dot.state != LaserState::kFound) continue;
    ++found;
    CAPTURE(i);
    CHECK(std::abs(dot.p_CL.z() - truth->z()) < std::max(kRange * truth->z(), 4.0 * dot.sigma_range));
  }
  CHECK(found >= 54);
}

TEST_CASE("laser: JPEG does not move the dot, wherever it lies between the borders of blocks") {
  constexpr double kMoved = 0.3;  // px: what the settings state of the dot
  Renderer renderer{site(), lens(), laser(), {}, 14};
  LaserFinder finder{lens(), laser(), {}};
  const Projection projection{lens()};
  double squares = 0.0;
  int n = 0;
  for (int i = 0; i < 60; ++i) {
    const Pose at = pose({0.2, 0.2 + 0.003 * i, 0.4 + 0.004 * i});
    cv::Mat grey, bgr;
    REQUIRE(decode_jpeg(encode_jpeg(renderer.step(0.1 * i, at), 90), true, grey, bgr).empty());
    const LaserDot dot = finder.step(bgr, grey, false);
    if (dot.state != LaserState::kFound) continue;
    squares += (dot.pixel - projection.pixel(*renderer.dot(at))).squaredNorm();
    ++n;
  }
  REQUIRE(n >= 54);
  CHECK(std::sqrt(squares / n) < kMoved);
}

TEST_CASE("laser: nothing is found where there is no dot, a second one, or no colour") {
  Renderer dark{site(), lens(), std::nullopt, {.caustics = 0.4}, 11};
  LaserFinder finder{lens(), laser(), {}};
  for (int i = 0; i < 60; ++i) {
    const Pose at = pose({0.02 * i - 0.6, 0.013 * i - 0.4, 0.1 + 0.015 * i}, 0.002 * i, 0.1 - 0.003 * i, 0.1 * i);
    const cv::Mat& bgr = dark.step(0.1 * i, at);
    for (const bool halved : {false, true}) CHECK(finder.step(bgr, grey_of(bgr), halved).state != LaserState::kFound);
  }
  Renderer renderer{site(), lens(), laser(), {}, 12};
  const Pose at = pose({0.1, 0.1, 0.5});
  cv::Mat two = renderer.step(0.0, at).clone();
  const Eigen::Vector2d own = Projection{lens()}.pixel(*renderer.dot(at));
  const int u = static_cast<int>(own.x()), v = static_cast<int>(own.y());
  two(cv::Rect{u - 8, v - 8, 17, 17}).copyTo(two(cv::Rect{u + 32, v - 8, 17, 17}));  // its reflection
  CHECK(finder.step(two, grey_of(two), false).state == LaserState::kTwo);
  CHECK(finder.step(grey_of(two), grey_of(two), false).state == LaserState::kNoColour);
}

}  // namespace fathom::vision
