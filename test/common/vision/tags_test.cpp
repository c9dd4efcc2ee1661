// Tags in rendered pictures, where the truth is known.
#include <doctest/doctest.h>

#include <Eigen/LU>
#include <random>

#include "common/base/error.hpp"
#include "test/common/vision/scene.hpp"

namespace fathom::vision {
namespace {

using namespace test_scene;

constexpr double kCorner = 0.25;  // px: blur 0.6 px, noise 2 of 255, fitted over edges of 50 px
constexpr double kPlace = 0.006;  // m: a few tags at 1 m, 0.1 px, and the tilt that goes with it
constexpr double kTurn = 0.006;   // rad

std::vector<TagSighting> detected(const cv::Mat& grey, const std::string& family, double decimation = 2.0) {
  TagDetector detector{{.families = {family}, .decimation = decimation}};
  return detector.step(grey);
}

std::array<double, 4> corner_errors(const TagSighting& tag, const model::Site& site, const Projection& projection,
                                    const Pose& truth) {
  const model::Tag* mapped = site.tag(tag.id);
  REQUIRE(mapped != nullptr);
  const double h = 0.5 * mapped->size;
  const std::array<Eigen::Vector3d, 4> corners{{{-h, h, 0.0}, {h, h, 0.0}, {h, -h, 0.0}, {-h, -h, 0.0}}};
  std::array<double, 4> errors{};
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector3d p_C = truth.R_WC.transpose() * (mapped->p_WT + mapped->R_WT * corners[i] - truth.p_WC);
    errors[i] = (projection.pixel(p_C) - tag.corners[i]).norm();
  }
  return errors;
}

double corner_error(const std::vector<TagSighting>& tags, const model::Site& site, const Projection& projection,
                    const Pose& truth) {
  double worst = 0.0;
  for (const TagSighting& tag : tags)
    worst = std::max(worst, std::ranges::max(corner_errors(tag, site, projection, truth)));
  return worst;
}

double turn_between(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return rotation_vector_from_quaternion(Eigen::Quaterniond{a.transpose() * b}).norm();
}

/// A tag as it would be seen without noise, were it not where the map has it but `shift` from there.
TagSighting sighting(const model::Tag& tag, const Pose& truth, const Eigen::Vector3d& shift) {
  const Projection projection{lens()};
  TagSighting seen{.family = "tag36h11", .id = tag.id, .margin = 60.0};
  const double h = 0.5 * tag.size;
  const std::array<Eigen::Vector3d, 4> corners{{{-h, h, 0.0}, {h, h, 0.0}, {h, -h, 0.0}, {-h, -h, 0.0}}};
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector3d p_W = tag.p_WT + shift + tag.R_WT * corners[i];
    seen.corners[i] = projection.pixel(truth.R_WC.transpose() * (p_W - truth.p_WC));
  }
  seen.edge = (seen.corners[1] - seen.corners[0]).norm();
  return seen;
}

}  // namespace

TEST_CASE("tags: corners lie where they are, at half resolution of the search too, for strong and weak families") {
  for (const std::string family : {"tag36h11", "tag16h5", "tagStandard41h12"}) {
    CAPTURE(family);
    const model::Site place = site(family);
    Renderer renderer{place, lens(), std::nullopt, {}, 3};
    for (const Pose& truth : {pose({0.03, -0.02, 0.4}), pose({0.2, 0.1, 0.5}, 0.12, -0.1, 0.8)}) {
      const cv::Mat grey = grey_of(renderer.step(0.0, truth));
      for (const double decimation : {1.0, 2.0}) {
        CAPTURE(decimation);
        const auto tags = detected(grey, family, decimation);
        CHECK(tags.size() >= 3);
        CHECK(corner_error(tags, place, Projection{lens()}, truth) < kCorner);
      }
    }
  }
}

TEST_CASE("tags: the joint pose is the truth within its covariance, through a distorting lens and a port too") {
  model::Lens bent = lens();
  bent.distortion = {-0.2, 0.06, 1e-3, -5e-4, 0.0};
  model::Lens behind = lens();
  behind.port = model::FlatPort{.distance = 0.01, .thickness = 0.005};
  const model::Site place = site();
  for (const model::Lens& l : {lens(), bent, behind}) {
    Renderer renderer{place, l, std::nullopt, {}, 4};
    TagLocator locator{place, l, {}};
    double normalized = 0.0;
    int n = 0;
    for (int i = 0; i < 8; ++i) {
      const Pose truth = pose({0.1 * i - 0.3, 0.05 * i, 0.3 + 0.03 * i}, 0.02 * i, -0.015 * i, 0.4 * i);
      auto tags = detected(grey_of(renderer.step(0.1 * i, truth)), "tag36h11");
      locator.reset();
      const auto fix = locator.step(i, tags, std::nullopt);
      REQUIRE(fix);
      CHECK_FALSE(fix->ambiguous);
      CHECK((fix->pose.p_WC - truth.p_WC).norm() < kPlace);
      CHECK(turn_between(fix->pose.R_WC, truth.R_WC) < kTurn);
      Vector6d error;
      error.head<3>() = fix->pose.p_WC - truth.p_WC;
      error.tail<3>() = rotation_vector_from_quaternion(Eigen::Quaterniond{truth.R_WC.transpose() * fix->pose.R_WC});
      normalized += error.dot(fix->covariance.inverse() * error);
      ++n;
    }
    CHECK(normalized / n < 12.6);  // six numbers: 95 % of single pictures lie below
  }
}

TEST_CASE("tags: a tag that was moved, one twice in the picture and one outside the map are refused with the reason") {
  const model::Site truth_site = site();
  model::Site map = truth_site;
  map.tags[12].p_WT.x() += 0.05;  // the tag in the middle is not where the map says
  std::erase_if(map.tags, [](const model::Tag& t) { return t.id == 13; });  // and its neighbour is not in it
  model::Site printed = truth_site;
  printed.tags[7].id = 11;  // two of number 11 lie there, the map knows one
  std::erase_if(map.tags, [](const model::Tag& t) { return t.id == 7; });
  Renderer renderer{printed, lens(), std::nullopt, {}, 5};
  const Pose truth = pose({0.0, 0.0, -0.2}, 0.03, 0.02, 0.1);
  auto tags = detected(grey_of(renderer.step(0.0, truth)), "tag36h11");
  TagLocator locator{map, lens(), {}};
  const auto fix = locator.step(0, tags, std::nullopt);
  REQUIRE(fix);
  CHECK((fix->pose.p_WC - truth.p_WC).norm() < kPlace);
  int accepted_11 = 0;
  for (const TagSighting& tag : tags) {
    if (tag.id == 12) CHECK(tag.verdict == TagVerdict::kGeometry);
    if (tag.id == 13) CHECK(tag.verdict == TagVerdict::kOutsideMap);
    if (tag.id == 11) accepted_11 += tag.verdict == TagVerdict::kAccepted ? 1 : 0;
    if (tag.id == 11) CHECK((tag.verdict == TagVerdict::kAccepted || tag.verdict == TagVerdict::kTwice));
  }
  CHECK(accepted_11 == 1);
}

TEST_CASE("tags: one of five that is not where the map has it, however far, is refused, and the others tell the pose") {
  const model::Site map = site();
  std::mt19937_64 random{17};
  std::normal_distribution<double> noise{0.0, 0.1};  // px, as kPlace has it
  std::uniform_real_distribution<double> turn{-3.0, 3.0}, tilt{-0.15, 0.15};
  for (int round = 0; round < 60; ++round) {
    const double moved = std::array{0.01, 0.03, 0.07, 0.15, 0.3}[static_cast<std::size_t>(round % 5)];
    CAPTURE(round);
    CAPTURE(moved);
    const Pose truth = pose({0.0, 0.0, 0.2}, tilt(random), tilt(random), turn(random));
    const double direction = turn(random);
    const int liar = std::array{7, 11, 12, 13, 17}[static_cast<std::size_t>(round / 5 % 5)];
    std::vector<TagSighting> seen;
    for (const int id : {7, 11, 12, 13, 17}) {
      const Eigen::Vector3d shift = moved * Eigen::Vector3d{std::cos(direction), std::sin(direction), 0.0};
      TagSighting tag = sighting(*map.tag(id), truth, id == liar ? shift : Eigen::Vector3d::Zero());
      for (Eigen::Vector2d& corner : tag.corners) corner += Eigen::Vector2d{noise(random), noise(random)};
      seen.push_back(tag);
    }
    TagLocator locator{map, lens(), {}};
    const auto fix = locator.step(0, seen, std::nullopt);
    REQUIRE(fix);
    CHECK((fix->pose.p_WC - truth.p_WC).norm() < kPlace);
    for (const TagSighting& tag : seen) {
      CHECK(tag.verdict == (tag.id == liar ? TagVerdict::kGeometry : TagVerdict::kAccepted));
    }
  }
}

TEST_CASE("tags: of some that contradict each other the one is believed that fits where the camera was, or none") {
  const model::Site map = site();
  const Pose truth = pose({0.0, 0.0, 0.4}, 0.05, -0.02, 0.3);
  const Eigen::Vector3d none = Eigen::Vector3d::Zero(), apart = map.tag(12)->p_WT - map.tag(7)->p_WT;
  TagLocator locator{map, lens(), {}};
  std::vector<TagSighting> good{sighting(*map.tag(11), truth, none), sighting(*map.tag(16), truth, none)};
  REQUIRE(locator.step(0, good, std::nullopt));
  // Numbers 7 and 12 were glued where the other belongs, and are the clearer ones.
  std::vector<TagSighting> three{sighting(*map.tag(7), truth, apart), sighting(*map.tag(12), truth, -apart),
                                 sighting(*map.tag(11), truth, none)};
  three[0].margin = three[1].margin = 90.0;
  for (Utime utime = 100'000; utime < 600'000; utime += 100'000) {
    std::vector<TagSighting> tags = three;
    const auto fix = locator.step(utime, tags, std::nullopt);
    REQUIRE(fix);
    CHECK((fix->pose.p_WC - truth.p_WC).norm() < kPlace);
    CHECK(tags[2].verdict == TagVerdict::kAccepted);
  }
  for (Utime utime = 600'000; utime < 1'500'000; utime += 100'000) {
    std::vector<TagSighting> tags{three[0], three[1]};
    CHECK_FALSE(locator.step(utime, tags, std::nullopt));
  }
}

TEST_CASE("tags: of one that the picture's border cuts only the corners that can be seen count") {
  const model::Site place = site();
  Renderer renderer{place, lens(), std::nullopt, {}, 3};
  const Projection projection{lens()};
  TagLocator locator{place, lens(), {}};
  int unsound = 0, outside = 0, fixes = 0;
  for (int k = 0; k < 160; ++k) {
    const double s = 0.1 * k, yaw = k % 2 == 0 ? s : 0.03 * std::sin(s);  // turned, and with edges along the border
    const Pose truth = pose({0.4 * std::sin(7.0 * s), 0.4 * std::cos(5.0 * s), 0.75 + 0.35 * std::sin(s)},
                            0.1 * std::sin(3.0 * s), 0.1 * std::cos(4.0 * s), yaw);
    auto tags = detected(grey_of(renderer.step(s, truth)), "tag36h11");
    for (const TagSighting& tag : tags) {
      const auto errors = corner_errors(tag, place, projection, truth);
      for (std::size_t i = 0; i < 4; ++i) {
        unsound += tag.sound[i] ? 0 : 1;
        CHECK((errors[i] < kCorner || !tag.sound[i]));
        outside += tag.sound[i] && tag.corners[i].minCoeff() < 0.0 ? 1 : 0;
      }
    }
    locator.reset();
    const auto fix = locator.step(k, tags, std::nullopt);
    if (!fix || fix->ambiguous) continue;
    ++fixes;
    CHECK((fix->pose.p_WC - truth.p_WC).norm() < 4.0 * std::sqrt(fix->covariance.topLeftCorner<3, 3>().trace()));
  }
  CHECK(unsound >= 10);
  CHECK(outside >= 1);
  CHECK(fixes > 100);
}

TEST_CASE("tags: a small tag seen aslant from afar is ambiguous, and said to be; gravity decides which way it leans") {
  model::Site place = site();
  std::erase_if(place.tags, [](const model::Tag& t) { return t.id != 12; });
  int wrong_first = 0;
  for (const unsigned seed : {6U, 7U, 8U, 9U}) {
    Renderer renderer{place, lens(), std::nullopt, {}, seed};
    const Pose truth = pose({0.9, 0.45, -2.0}, 0.0, 0.0, 0.3);  // 3.6 m away: the tag is 23 px wide
    auto tags = detected(grey_of(renderer.step(0.0, truth)), "tag36h11");
    REQUIRE(tags.size() == 1);
    TagLocator locator{place, lens(), {}};
    const Eigen::Vector3d down_C = truth.R_WC.row(2);
    const auto tilt = [&](const Pose& pose) { return std::acos(std::min(1.0, down_C.dot(pose.R_WC.row(2)))); };
    const auto blind = locator.step(0, tags, std::nullopt);
    REQUIRE(blind);
    CHECK(blind->ambiguous);
    REQUIRE(blind->other);
    wrong_first += tilt(blind->pose) > tilt(*blind->other) ? 1 : 0;
    locator.reset();
    const auto told = locator.step(0, tags, down_C);
    REQUIRE(told);
    CHECK_FALSE(told->ambiguous);
    CHECK(tilt(told->pose) < 0.12);  // the right one of two that differ by 0.5
  }
  CHECK(wrong_first > 0);  // the smaller error is no proof: a guess would have been wrong
}

TEST_CASE("tags: a lone false tag far from where the camera was just before gives no pose") {
  const model::Site place = site();
  Renderer renderer{place, lens(), std::nullopt, {}, 7};
  TagLocator locator{place, lens(), {}};
  auto tags = detected(grey_of(renderer.step(0.0, pose({0.0, 0.0, 0.5}))), "tag36h11");
  REQUIRE(locator.step(0, tags, std::nullopt));
  tags.resize(1);
  tags[0].id = 24;  // elsewhere
  CHECK_FALSE(locator.step(33'000, tags, std::nullopt));
  CHECK(tags[0].verdict == TagVerdict::kImplausible);
}

TEST_CASE("tags: without map or lens there are verdicts and no pose; tiny and empty pictures hold nothing") {
  model::Site nothing;
  TagLocator locator{nothing, std::nullopt, {}};
  std::vector<TagSighting> tags(1);
  tags[0].family = "tag36h11";
  tags[0].margin = 50.0;
  CHECK_FALSE(locator.step(0, tags, std::nullopt));
  CHECK(tags[0].verdict == TagVerdict::kAccepted);
  CHECK(detected(cv::Mat(480, 640, CV_8UC1, cv::Scalar{90}), "tag36h11").empty());
  CHECK(detected(cv::Mat(8, 8, CV_8UC1, cv::Scalar{90}), "tag36h11").empty());
  CHECK(detected(cv::Mat(17, 33, CV_8UC1, cv::Scalar{90}), "36h11").empty());
  CHECK_THROWS_AS(detected(cv::Mat(), "tag99h99"), InputError);
}

}  // namespace fathom::vision
