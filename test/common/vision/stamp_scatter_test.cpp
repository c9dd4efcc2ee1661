// Pictures that are stamped when they arrive: what that does to speeds, and that it is told.
#include "common/vision/stamp_scatter.hpp"

#include <doctest/doctest.h>

#include <random>

#include "common/vision/jpeg.hpp"
#include "common/vision/watch.hpp"
#include "test/common/vision/scene.hpp"

namespace fathom::vision {
namespace {

using namespace test_scene;

constexpr double kRate = 30.0;  // Hz

}  // namespace

TEST_CASE("stamp scatter: seen in the intervals, whatever pictures are missing") {
  for (const double sigma : {0.0, 1e-3, 4e-3}) {
    std::mt19937 random{5};
    std::normal_distribution<double> normal{0.0, sigma > 0.0 ? sigma : 1.0};
    std::uniform_real_distribution<double> chance;
    StampScatter scatter;
    double sum = 0.0;
    int n = 0;
    for (int i = 0; i < 600; ++i) {
      if (chance(random) < 0.1) continue;
      scatter.step(utime_after(0, i / kRate + (sigma > 0.0 ? normal(random) : 0.0)));
      if (i < 60) continue;
      sum += scatter.sigma();
      ++n;
    }
    CAPTURE(sigma);
    CHECK(sum / n == doctest::Approx(sigma).epsilon(0.15));
  }
}

TEST_CASE("stamp scatter: flow's covariance takes it in, and an operator is told") {
  // Straight ahead and turning; stamps err by `scatter`, pictures and attitudes do not.
  const auto run = [](double scatter, double& complaints) {
    Renderer renderer{site(), lens(), laser(), {.caustics = 0.0}, 4};
    Watch watch{site(), {.name = "down", .width = 640, .height = 480, .lens = lens()}, laser(), {}};
    std::mt19937 random{6};
    std::normal_distribution<double> normal;
    const auto at = [](double t) { return pose({0.3 * t - 0.3, 0.05, 0.4}, 0.3 * std::sin(2.0 * t), 0.0, 0.5 * t); };
    double squares = 0.0;
    int n = 0;
    complaints = 0;
    for (int k = 0; k < 240; ++k) {  // an attitude sensor of 120 Hz
      const double t = k / 120.0;
      watch.hear({.utime = utime_after(1'000'000, t), .q_WB = Eigen::Quaterniond{at(t).R_WC}, .has_attitude = true});
      if (k % 4 != 2 || k < 8) continue;
      const double taken = t - 1.0 / 60.0;
      Camera sample{.utime = utime_after(1'000'000, taken + scatter * normal(random)), .camera = "down"};
      sample.jpeg = encode_jpeg(renderer.step(taken, at(taken)), 95);
      REQUIRE(watch.see(sample));
      complaints += watch.complaint().find("scatter") != std::string::npos ? 1 : 0;
      const Flow& flow = watch.front_end().sight().flow;
      if (k < 100 || flow.state != FlowState::kValid) continue;
      const double middle = taken - 0.5 / kRate;
      const Eigen::Vector3d truth =
          at(middle).R_WC.transpose() * Eigen::Vector3d{0.3, 0.0, 0.0} / (1.1 / at(middle).R_WC(2, 2));
      const Eigen::Vector2d error = flow.rate.head<2>() - truth.head<2>();
      squares += error.dot(flow.covariance.topLeftCorner<2, 2>().inverse() * error) / 2.0;
      ++n;
    }
    REQUIRE(n > 20);
    return squares / n;
  };
  double complaints = 0.0;
  const double exact = run(0.0, complaints);
  CHECK(complaints == 0);
  CHECK(exact < 4.0);
  const double scattered = run(4e-3, complaints);
  MESSAGE("error squared over variance: " << exact << ", with stamps that err by 4 ms " << scattered);
  CHECK(complaints > 20);
  CHECK(scattered < 4.0);
}

}  // namespace fathom::vision
