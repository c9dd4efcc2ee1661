#include "common/inference/tones.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "test/common/likelihood/noisy_dive.hpp"

using namespace fathom;

TEST_CASE("tones: a frequency between those of the grid is found far more finely than the grid is") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const test::VirtualDive dive = test::fly(vehicle, {.duration = 60.0, .seed = 3});
  const likelihood::Problem problem = likelihood::make_problem(vehicle, {&dive.trial, 1});
  const likelihood::RunData& run = problem.runs.front();
  const double half_turn = std::numbers::pi / (run.last_time() - run.first_time());  // rad/s over the run
  for (const double omega : {0.2 + 20.5 * half_turn, 0.2 + 31.3 * half_turn}) {
    Eigen::MatrixXd slope = Eigen::MatrixXd::Zero(problem.simulated, static_cast<Eigen::Index>(run.blocks().size()));
    for (std::size_t b = 0; b < run.blocks().size(); ++b) {
      const auto& block = run.blocks()[b];
      const std::size_t middle = std::min((block.first + block.last) / 2, run.intervals().size() - 1);
      const double t = run.trial().t[block.first];
      for (int i = 0; i < problem.simulated; ++i) {
        const int axis = problem.axes[static_cast<std::size_t>(i)];
        if (axis < 3)
          slope(i, static_cast<Eigen::Index>(b)) = run.intervals()[middle].R_WB(0, axis) * std::cos(omega * t);
      }
    }
    const std::vector<double> found = inference::strongest_tones(problem, {slope}, 0, 0.2);
    REQUIRE_FALSE(found.empty());
    CHECK(std::abs(found.front() - omega) < 0.1 * half_turn);
  }
}
