// A signal weighs by what of its residual lasts: white noise by its standard deviation, what wanders by far less.
#include "common/identification/signal_weights.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::identification;

namespace {

constexpr double kBlock = 10.0;  // s

struct Fixture {
  model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  test::VirtualDive dive = test::make_dive(vehicle, {.duration = 600.0, .dt = 0.1, .seed = 3});
  std::vector<PoseWindow> windows = pose_windows(vehicle, {&dive.trial, 1}, 30.0);
  std::vector<Eigen::VectorXd> residuals;

  /// Noise of one sigma, white or remembered over `memory` samples, in every signal.
  void draw(double sigma, double memory) {
    std::mt19937 random{7};
    std::normal_distribution<double> normal;
    const double keep = memory > 0.0 ? std::exp(-1.0 / memory) : 0.0;
    residuals.clear();
    for (const PoseWindow& window : windows) {
      Eigen::VectorXd residual(window.rows());
      double last = sigma * normal(random);
      for (double& value : residual) value = last = keep * last + std::sqrt(1.0 - keep * keep) * sigma * normal(random);
      residuals.push_back(std::move(residual));
    }
  }
  [[nodiscard]] double weight(int signal) const {
    const std::vector<Eigen::VectorXd> weights = signal_weights(windows, residuals, kBlock);
    for (Eigen::Index i = 0; i < windows[1].rows(); ++i) {
      if (windows[1].row(i).signal == signal) return weights[1][i];
    }
    return 0.0;
  }
};

}  // namespace

TEST_CASE("signal weights: white noise weighs by its standard deviation") {
  Fixture fixture;
  fixture.draw(0.004, 0.0);
  // Of 60 means over 10 s the largest variance is taken, and the worst twentieth is left out.
  for (const int signal : {0, 5, 7, 11}) CHECK(fixture.weight(signal) == doctest::Approx(250.0).epsilon(0.25));
}

TEST_CASE("signal weights: what lasts for n samples weighs as if there were fewer of them") {
  Fixture fixture;
  fixture.draw(0.004, 10.0);
  // Variance of a mean of many: (1 + k) / (1 - k) times that of white noise, k = exp(-1/10): 20.0.
  const double white = 1.0 / 0.004;
  for (const int signal : {0, 7, 11})
    CHECK(fixture.weight(signal) == doctest::Approx(white / std::sqrt(20.0)).epsilon(0.3));
}

TEST_CASE("signal weights: a signal that is astray in one window pulls little there") {
  Fixture fixture;
  fixture.draw(0.004, 0.0);
  const AxisRows rows = fixture.windows[1].signals()[4];
  fixture.residuals[1].segment(rows.first, rows.count).array() += 0.1;
  const int signal = fixture.windows[1].row(rows.first).signal;
  CHECK(fixture.weight(signal) < 100.0);
  CHECK(fixture.weight(0) == doctest::Approx(250.0).epsilon(0.25));
}
