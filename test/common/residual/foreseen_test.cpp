// A ship without fins turns by itself: held on its course it can be measured and modelled, but ten seconds without its
// helmsman nobody foretells, the truth included. Such predictions are judged as far as they mean something.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <random>

#include "common/model/dynamics.hpp"
#include "common/residual/open_loop.hpp"
#include "common/residual/prediction.hpp"
#include "common/verdict/skill.hpp"
#include "test/support/virtual_dive.hpp"

namespace fathom::residual {
namespace {

constexpr std::size_t kYaw = 5, kFive = 1;  // axis, horizon of 5 s

/// CyberShip II by its own equations, steered by a turn rate that is asked for; measured with a little noise.
Trial steered(double speed, unsigned seed) {
  constexpr double kX = 25.8, kY = 33.8, kZ = 2.76;  // kg, kg m^2
  std::mt19937 random{seed};
  std::normal_distribution<double> unit;
  Trial trial;
  trial.dt = 0.02;
  trial.input_step = 0.02;
  trial.observed.velocity = trial.observed.rates = true;
  trial.input_is_wrench = true;
  double u = speed, v = 0.0, r = 0.0, yaw = 0.0;
  Eigen::Vector3d p_WB = Eigen::Vector3d::Zero();
  for (int k = 0; k < 12000; ++k) {
    const double t = k * trial.dt, asked = 0.15 * std::sin(0.4 * t) + 0.1 * std::sin(0.9 * t);
    const double X = 1.33 * speed * speed + 0.72 * speed + 2.0 * (speed - u),
                 N = 12.0 * (asked - r) + (kY - kX) * u * v;
    trial.t.push_back(t);
    trial.nu.push_back(
        Vector6d{u + 0.003 * unit(random), v + 0.003 * unit(random), 0.0, 0.0, 0.0, r + 0.002 * unit(random)});
    trial.input.push_back(Vector6d{X, 0.0, 0.0, 0.0, 0.0, N});
    trial.p_WB.push_back(p_WB);
    trial.q_WB.emplace_back(Eigen::AngleAxisd{yaw, Eigen::Vector3d::UnitZ()});
    trial.velocity_valid.push_back(1);
    trial.rates_valid.push_back(1);
    constexpr int kFine = 4;
    for (int i = 0; i < kFine; ++i) {
      const double h = trial.dt / kFine;
      const double du = (X + kY * v * r - 0.72 * u - 1.33 * std::abs(u) * u) / kX;
      const double dv = (-kX * u * r - 0.89 * v - 36.5 * std::abs(v) * v) / kY;
      const double dr = (N - (kY - kX) * u * v - 1.9 * r - 0.75 * std::abs(r) * r) / kZ;
      p_WB += h * Eigen::Vector3d{u * std::cos(yaw) - v * std::sin(yaw), u * std::sin(yaw) + v * std::cos(yaw), 0.0};
      yaw += h * r;
      u += h * du;
      v += h * dv;
      r += h * dr;
    }
  }
  return trial;
}

double yaw_error(const Predictions& predictions) { return std::sqrt(verdict::mean_square(predictions, kFive, kYaw)); }

}  // namespace

TEST_CASE(
    "foreseen: a craft that turns by itself is judged as far as the truth foretells it, a steady one to the end") {
  const model::Vehicle ship = test::vehicle_from_repository("cybership2");
  const model::Model truth = model::nominal_model(ship, true);
  const Trial fast = steered(1.2, 1), slow = steered(0.15, 2);
  const auto all = prediction_windows({&fast, 1}), steady = prediction_windows({&slow, 1});
  REQUIRE(all.size() > 20);
  const Foreseen short_of_it = foreseen(all, std::array{&truth}), whole = foreseen(steady, std::array{&truth});
  CHECK(whole.cut == 0);
  MESSAGE(short_of_it.cut << " of " << all.size() << " cut, " << short_of_it.typical << " s; "
                          << yaw_error(predict(truth, all)) << " " << yaw_error(verdict::predict_unchanged(all)));
  CHECK(short_of_it.cut > static_cast<int>(all.size()) / 2);
  CHECK(short_of_it.typical >= 1.0);
  CHECK(short_of_it.typical < 5.0);
  // The truth itself is worse over 5 s than who says that nothing changes, and far better as far as it can see.
  CHECK(yaw_error(predict(truth, all)) > yaw_error(verdict::predict_unchanged(all)));
  CHECK(yaw_error(predict(truth, short_of_it.windows)) <
        0.5 * yaw_error(verdict::predict_unchanged(short_of_it.windows)));
}

}  // namespace fathom::residual
