// Residuals of poses: none where nothing is wrong, the shift where a window begins beside the measured pose, and only
// of what is simulated and was observed.
#include "common/identification/pose_window.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::identification;

namespace {

constexpr double kLength = 10.0;  // s

struct Fixture {
  explicit Fixture(const std::string& name, test::DiveSettings settings = {.duration = 30.0, .dt = 0.02, .seed = 5})
      : vehicle{test::vehicle_from_repository(name)} {
    settings.velocity_noise = settings.rate_noise = 1e-9;
    dive = test::make_dive(vehicle, settings);
  }
  [[nodiscard]] std::vector<PoseWindow> windows() const { return pose_windows(vehicle, {&dive.trial, 1}, kLength); }
  [[nodiscard]] std::set<int> signals() const {
    std::set<int> found;
    const std::vector<PoseWindow> all = windows();
    for (const AxisRows& rows : all.front().signals()) found.insert(all.front().row(rows.first).signal);
    return found;
  }
  model::Vehicle vehicle;
  test::VirtualDive dive;
};

double largest(const PoseWindow& window, const Eigen::VectorXd& residual, int signal) {
  double most = 0.0;
  for (Eigen::Index i = 0; i < window.rows(); ++i) {
    if (window.row(i).signal == signal) most = std::max(most, std::abs(residual[i]));
  }
  return most;
}

}  // namespace

TEST_CASE("pose windows: the true model leaves nothing, on six axes and on four") {
  // Steps of 20 ms against the dive's 10 ms, over 10 s.
  constexpr double kPlace = 2e-3, kTurn = 2e-3;  // m, rad
  for (const char* name : {"beluga", "seabotix_lbv150"}) {
    CAPTURE(name);
    const Fixture fixture{name};
    for (const PoseWindow& window : fixture.windows()) {
      Eigen::VectorXd residual(window.rows());
      window.evaluate(fixture.dive.truth, window.measured_start(), residual);
      for (int signal = 6; signal < 9; ++signal) CHECK(largest(window, residual, signal) < kPlace);
      for (int signal = 9; signal < 12; ++signal) CHECK(largest(window, residual, signal) < kTurn);
    }
  }
}

TEST_CASE("pose windows: a beginning elsewhere stays elsewhere, a turned one goes another way") {
  const Fixture fixture{"seabotix_lbv150"};
  const PoseWindow window = fixture.windows().front();
  Eigen::VectorXd residual(window.rows());
  WindowStart start = window.measured_start();
  start[7] += 0.25;  // m, east
  window.evaluate(fixture.dive.truth, start, residual);
  for (Eigen::Index i = 0; i < window.rows(); ++i) {
    if (window.row(i).signal == 7) CHECK(residual[i] == doctest::Approx(0.25).epsilon(0.02));
    if (window.row(i).signal == 6) CHECK(std::abs(residual[i]) < 5e-3);
  }
  start = window.measured_start();
  start[11] += 0.1;  // rad, to starboard: the path turns about its beginning
  window.evaluate(fixture.dive.truth, start, residual);
  CHECK(largest(window, residual, 11) == doctest::Approx(0.1).epsilon(0.02));
  const Trial& trial = fixture.dive.trial;
  for (Eigen::Index i = 0; i < window.rows(); ++i) {
    if (window.row(i).signal != 6) continue;
    const auto k = static_cast<std::size_t>(window.row(i).sample);
    const Eigen::Vector3d way = trial.p_WB[k] - trial.p_WB[0];
    CHECK(residual[i] ==
          doctest::Approx(std::cos(0.1) * way.x() - std::sin(0.1) * way.y() - way.x()).scale(1.0).epsilon(5e-3));
  }
}

TEST_CASE("pose windows: rows of what is simulated and was observed") {
  CHECK(Fixture{"beluga"}.signals() == std::set{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11});
  CHECK(Fixture{"seabotix_lbv150"}.signals() == std::set{0, 1, 2, 5, 6, 7, 8, 11});  // roll and pitch as measured
  Fixture blind{"seabotix_lbv150"};
  blind.dive.trial.observed.position = false;
  CHECK(blind.signals() == std::set{0, 1, 2, 5, 11});
  blind.dive.trial.observed.attitude = false;
  CHECK(blind.windows().empty());
}

TEST_CASE("pose windows: derivatives are those of the residual") {
  const Fixture fixture{"beluga"};
  const PoseWindow window = fixture.windows()[1];
  const ParameterMap map{fixture.dive.truth};
  const WindowStart start = window.measured_start();
  Eigen::VectorXd at(window.rows()), plus(window.rows()), minus(window.rows());
  window.evaluate(fixture.dive.truth, start, at);
  const auto n = static_cast<Eigen::Index>(map.size());
  std::vector<Eigen::Index> all(map.size());
  std::iota(all.begin(), all.end(), 0);
  const Eigen::MatrixXd jacobian = window.jacobian(fixture.dive.truth, map, all, start, at);
  REQUIRE(jacobian.cols() == n + 12);
  const Eigen::VectorXd x = map.pack(fixture.dive.truth);
  constexpr double kStep = 1e-3, kAgreement = 2e-3;  // forward against central differences
  model::Model moved = fixture.dive.truth;
  for (Eigen::Index j = 0; j < n; ++j) {
    map.unpack(x + kStep * Eigen::VectorXd::Unit(n, j), moved);
    window.evaluate(moved, start, plus);
    map.unpack(x - kStep * Eigen::VectorXd::Unit(n, j), moved);
    window.evaluate(moved, start, minus);
    CAPTURE(map[static_cast<std::size_t>(j)].name);
    const Eigen::VectorXd central = (plus - minus) / (2.0 * kStep);
    CHECK((jacobian.col(j) - central).norm() < kAgreement * central.norm() + 1e-6);
  }
  const Eigen::MatrixXd held = window.jacobian(fixture.dive.truth, map, {}, start, at);
  CHECK(held.leftCols(n).isZero(0.0));
  CHECK(held.rightCols(12) == jacobian.rightCols(12));
  for (Eigen::Index s = 0; s < 12; ++s) {
    WindowStart other = start;
    other[s] += 1e-4;
    window.evaluate(fixture.dive.truth, other, plus);
    other[s] -= 2e-4;
    window.evaluate(fixture.dive.truth, other, minus);
    const Eigen::VectorXd central = (plus - minus) / 2e-4;
    CAPTURE(s);
    CHECK((jacobian.col(n + s) - central).norm() < kAgreement * central.norm() + 1e-6);
  }
}
