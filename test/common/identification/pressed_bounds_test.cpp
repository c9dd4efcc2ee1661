// Bounds in the fit: the least-squares step inside them, steps that come near and never cross, and a fit that finds its
// way although half of its numbers begin on a bound.
#include "common/identification/trajectories/pressed_bounds.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "common/identification/trajectories/box_step.hpp"
#include "common/identification/trajectories/trajectory_fit.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::identification;

namespace {

double value(const Eigen::MatrixXd& A, const Eigen::VectorXd& g, const Eigen::VectorXd& d) {
  return d.dot(g + 0.5 * (A * d));
}

}  // namespace

TEST_CASE("bounds: the bounded step is the lowest point of the box") {
  constexpr double kRounding = 1e-9;  // of slopes of size 1 to 10
  std::mt19937 random{20261124};
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> reach{0.0, 1.5};
  for (int draw = 0; draw < 200; ++draw) {
    const Eigen::Index n = 1 + draw % 12;
    const Eigen::MatrixXd root = Eigen::MatrixXd::NullaryExpr(n + 2, n, [&] { return normal(random); });
    const Eigen::MatrixXd A = root.transpose() * root;
    const Eigen::VectorXd g = Eigen::VectorXd::NullaryExpr(n, [&] { return 3.0 * normal(random); });
    Eigen::VectorXd low(n), high(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      low[i] = draw % 3 == 0 && i % 2 == 0 ? 0.0 : -reach(random);
      high[i] = draw % 4 == 0 ? std::numeric_limits<double>::infinity() : reach(random);
    }
    const Eigen::VectorXd d = box_step(A, g, low, high);
    const Eigen::VectorXd slope = A * d + g;
    CAPTURE(draw);
    for (Eigen::Index i = 0; i < n; ++i) {
      REQUIRE(d[i] >= low[i]);
      REQUIRE(d[i] <= high[i]);
      // Karush, Kuhn, Tucker: inside no slope, on a bound one that presses against it.
      if (d[i] > low[i] && d[i] < high[i]) CHECK(std::abs(slope[i]) < kRounding);
      if (d[i] == low[i] && low[i] < high[i]) CHECK(slope[i] > -kRounding);
      if (d[i] == high[i] && low[i] < high[i]) CHECK(slope[i] < kRounding);
    }
    for (int other = 0; other < 20; ++other) {
      const Eigen::VectorXd elsewhere =
          (d + Eigen::VectorXd::NullaryExpr(n, [&] { return 0.3 * normal(random); })).cwiseMax(low).cwiseMin(high);
      CHECK(value(A, g, elsewhere) >= value(A, g, d) - kRounding);
    }
  }
}

TEST_CASE("bounds: a step comes near a bound and never crosses it, and small steps are what they are") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const model::Model model = model::nominal_model(vehicle, false);
  const ParameterMap map{model};
  const std::vector<int> held{1};
  const InsideBounds manifold{map, held};
  const Eigen::VectorXd x = map.pack(model);
  REQUIRE(manifold.TangentSize() == x.size() - 1);
  Eigen::VectorXd moved(x.size());
  for (const double size : {-1e3, -1.0, -0.1, 0.1, 1.0, 1e3}) {
    const Eigen::VectorXd step = Eigen::VectorXd::Constant(manifold.TangentSize(), size);
    REQUIRE(manifold.Plus(x.data(), step.data(), moved.data()));
    CHECK(moved[held[0]] == x[held[0]]);
    for (std::size_t i = 0; i < map.size(); ++i) {
      const double there = moved[static_cast<Eigen::Index>(i)];
      CHECK(there >= map[i].low / map[i].scale);
      CHECK(there <= map[i].high / map[i].scale);
    }
  }
  // The derivative that the manifold states against differences.
  constexpr double kSmall = 1e-6, kBend = 1e-5;  // a step of 1e-6 at distance 1 bends by half of that
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> jacobian(x.size(), manifold.TangentSize());
  REQUIRE(manifold.PlusJacobian(x.data(), jacobian.data()));
  for (Eigen::Index k = 0; k < manifold.TangentSize(); ++k) {
    const Eigen::VectorXd step = kSmall * Eigen::VectorXd::Unit(manifold.TangentSize(), k);
    REQUIRE(manifold.Plus(x.data(), step.data(), moved.data()));
    CHECK(((moved - x) / kSmall - jacobian.col(k)).norm() < kBend);
  }
}

TEST_CASE("bounds: a fit that begins with drag on its bounds arrives where one that begins at the truth does") {
  constexpr double kQuick = 1e-3, kSame = 1.05;
  for (const char* name : {"seabotix_lbv150", "bluerov2"}) {
    const model::Vehicle vehicle = test::vehicle_from_repository(name);
    for (const int thruster : {0, 1, 2, 3}) {
      CAPTURE(name);
      CAPTURE(thruster);
      const test::VirtualDive dive =
          test::make_dive(vehicle, {.duration = 120.0,
                                    .seed = 50 + static_cast<unsigned>(thruster),
                                    .effects = {test::active("thruster_gain", {-0.5}, thruster)}});
      const std::vector<Trial> trials{dive.trial};
      const TrajectoryFit problem{vehicle, trials, {}};
      const FitResult without = problem.fit(model::nominal_model(vehicle, false));
      model::Model start = without.model;
      for (Eigen::Index i = 0; i < 6; ++i) start.theta[model::index(model::BaseParameter::X_u) + i] = 0.0;
      start.add(test::active("thruster_gain", {-0.1}, thruster));
      const FitResult found = problem.fit(start, &without, kQuick);
      const FitResult best = problem.fit(dive.truth, &without);
      CAPTURE(without.cost);
      CHECK(found.cost < kSame * best.cost);
    }
  }
}
