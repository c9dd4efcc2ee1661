// A coarser grid delays nothing, averages only what was measured, and leaves slow recordings alone.
#include "common/identification/sparse.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace fathom;
using fathom::identification::sparse;

namespace {

constexpr double kRounding = 1e-12;  // sums of a few numbers of size one

/// Velocity and input grow with time at a constant rate, so that any delay would show.
Trial ramp(double dt, std::size_t samples) {
  Trial trial{.name = "ramp", .dt = dt, .observed = {true, true, true, true}};
  for (std::size_t k = 0; k < samples; ++k) {
    const double t = dt * static_cast<double>(k);
    trial.t.push_back(t);
    trial.p_WB.emplace_back(t, 0.0, 0.0);
    trial.q_WB.push_back(Eigen::Quaterniond::Identity());
    trial.nu.push_back(Vector6d::Constant(t));
    trial.pose_valid.push_back(1);
    trial.velocity_valid.push_back(1);
    trial.rates_valid.push_back(1);
    trial.input.push_back(Eigen::VectorXd::Constant(2, t));
    trial.voltage.push_back(t);
  }
  return trial;
}

}  // namespace

TEST_CASE("sparse: what grows steadily keeps its place in time") {
  const Trial coarse = sparse(ramp(0.01, 103), 0.05);
  CHECK(coarse.dt == doctest::Approx(0.05));
  CHECK(coarse.size() == 21);
  for (std::size_t k = 0; k < coarse.size(); ++k) {
    CHECK(std::abs(coarse.nu[k][0] - coarse.t[k]) < kRounding);
    CHECK(std::abs(coarse.input[k][1] - coarse.t[k]) < kRounding);
    CHECK(coarse.voltage[k] == coarse.t[k]);
  }
}

TEST_CASE("sparse: commands that are held, or told of afterwards, are half a command late or early") {
  const Trial coarse = sparse(ramp(0.01, 103), 0.05);
  for (std::size_t k = 1; k + 1 < coarse.size();
       ++k) {  // means over [t, t + 0.05) of a course that grows by 1 a second
    CHECK(std::abs(coarse.held[k][0] - (coarse.t[k] + 0.02)) < kRounding);
    CHECK(std::abs(coarse.told[k][0] - (coarse.t[k] + 0.03)) < kRounding);
  }
}

TEST_CASE("sparse: for a quick vehicle, as many parts of a step as it can tell apart stay apart") {
  Trial trial = ramp(0.02, 101);
  for (std::size_t k = 0; k < 2 * trial.size(); ++k) {
    trial.held.push_back(Eigen::VectorXd::Constant(2, 0.01 * static_cast<double>(k)));
    trial.told.push_back(Eigen::VectorXd::Constant(2, 0.01 * static_cast<double>(k + 1)));
  }
  for (const auto& [longest, parts] : {std::pair{0.005, 4}, {0.02, 2}, {0.03, 2}, {0.0, 1}}) {
    trial.input_part = longest;
    const Trial coarse = sparse(trial, 0.04);
    REQUIRE(coarse.parts() == static_cast<std::size_t>(parts));
    REQUIRE(coarse.told.size() == coarse.held.size());
    for (std::size_t k = coarse.parts(); k + 2 * coarse.parts() < coarse.held.size(); ++k) {
      const double length = 0.04 / parts, begin = length * static_cast<double>(k);
      CHECK(std::abs(coarse.held[k][0] - (begin + 0.5 * (length - 0.01))) < kRounding);
      CHECK(std::abs(coarse.told[k][1] - (begin + 0.5 * (length + 0.01))) < kRounding);
    }
  }
}

TEST_CASE("sparse: noise falls, and an invalid neighbour has no part in a mean") {
  Trial trial = ramp(0.01, 101);
  for (std::size_t k = 0; k < trial.size(); ++k) trial.nu[k][3] = k % 2 == 0 ? 1.0 : -1.0;
  trial.nu[49][0] = 1e3;
  trial.velocity_valid[49] = 0;
  const Trial coarse = sparse(trial, 0.05);
  CHECK(std::abs(coarse.nu[5][3]) == doctest::Approx(0.2));  // five samples of either sign
  CHECK(coarse.nu[10][0] == doctest::Approx(0.5));           // t = 0.5 s stands beside the invalid sample
  CHECK(coarse.velocity_valid[10] == 1);
}

TEST_CASE("sparse: a recording that is no faster stays as it is") {
  const Trial trial = ramp(0.04, 50);
  CHECK(sparse(trial, 0.05).size() == trial.size());
  CHECK(sparse(trial, 0.05).dt == trial.dt);
}

TEST_CASE("sparse: a mean of what is known and what was guessed is a guess") {
  Trial trial = ramp(0.01, 101);
  trial.input_valid.assign(trial.size(), 1);
  trial.input_valid[48] = 0;
  const Trial coarse = sparse(trial, 0.05);
  CHECK(coarse.input_valid[9] == 0);   // its step runs to 0.5 s
  CHECK(coarse.input_valid[10] == 0);  // its mean begins at 0.48 s
  CHECK(coarse.input_valid[8] == 1);
  CHECK(coarse.input_valid[11] == 1);
}
