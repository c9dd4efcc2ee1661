// A velocity log that falls silent while the accelerometer's bias is hardly known: soon after the beginning, and again.
#include <doctest/doctest.h>

#include "common/estimation/online/navigator.hpp"
#include "test/support/synthetic_survey.hpp"

namespace fathom {
namespace {

using estimation::Navigator;

/// Deep water; the velocity log speaks up to `to`.
test::SurveyOptions log_that_speaks(double to) {
  test::SurveyOptions options{.duration = 9.0, .shallow = false};
  options.spoil = [=](test::SurveySample& sample, double t) { return !std::holds_alternative<Dvl>(sample) || t < to; };
  return options;
}

std::vector<StateEstimate> states_of(const test::SurveyOptions& options) {
  Navigator navigator{test::survey_settings(false), test::survey_places()};
  return test::feed(navigator, test::synthetic_survey(options));
}

const StateEstimate& at(const std::vector<StateEstimate>& states, double t) {
  return states.at(static_cast<std::size_t>(std::lround(100.0 * t)));
}

Eigen::Vector3d velocity_error(const StateEstimate& state, unsigned seed) {
  return state.nu.head<3>() - test::SyntheticMotion{seed}.v_B(seconds_between(1'000'000'000, state.utime));
}

}  // namespace

TEST_CASE("navigator: the first velocity tells nothing of the accelerometer, so that STATE outlasts the next silence") {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    CAPTURE(seed);
    auto options = log_that_speaks(2.4);
    options.seed = seed;
    const auto states = states_of(options);
    const StateEstimate& after = at(states, 8.0);
    const Eigen::Vector3d sigma = after.sigma.segment<3>(6);
    // The bias was known to 5 cm/s^2 beforehand; 1.3 s behind the first
    // fix at 2 rad/s leave at most half of that, for 5.7 s.
    CHECK(sigma.maxCoeff() < 0.5 * 0.05 * 5.7);
    CHECK(after.valid);
    CHECK(velocity_error(after, seed).cwiseQuotient(sigma).cwiseAbs().maxCoeff() < 3.5);
  }
}

// Velocity errs by bias times silence when the log is back, and so it must be shared. As if a second had passed, the
// bias would get .44 of it (cut-off 2 rad/s, damping one): after six seconds 2.7 times what it was.
TEST_CASE("navigator: after a silence the bias gets its share of what the silence left, not more") {
  const Eigen::Vector3d bias{0.03, 0.02, 0.03};  // m/s^2, within what is known beforehand
  std::vector<test::Arrival> arrivals;
  for (int i = 0; i <= 1400; ++i) {  // a vehicle that lies still and level; no sample repeats the one before
    const Utime utime = 1'000'000'000 + 10'000 * i;
    const Eigen::Vector3d tremble = Eigen::Vector3d::Constant(i % 2 == 0 ? 1e-6 : -1e-6);
    Ahrs ahrs{.utime = utime, .has_rates = true, .has_specific_force = true, .has_attitude = true};
    ahrs.f_B = Eigen::Vector3d{0.0, 0.0, -9.81} + bias + tremble;
    ahrs.q_WB.setIdentity();
    arrivals.push_back({utime, ahrs});
    if (i % 101 == 1)
      arrivals.push_back({utime, Usbl{.utime = utime, .p_WB = tremble, .sigma = Eigen::Vector3d::Constant(0.1)}});
    if (i == 150 || i == 750) arrivals.push_back({utime, Dvl{.utime = utime, .v_WB_B = tremble, .altitude = 1.0}});
  }
  auto settings = test::survey_settings(false);
  settings.depth.used = false;
  Navigator navigator{settings, test::survey_places()};
  const auto states = test::feed(navigator, arrivals);
  // Backward Euler over the six seconds: X = (4 + 6 * 4) 6 = 168, of which the bias gets (6 * 4 / 169) * 6 = .85.
  const Eigen::Vector3d before = at(states, 7.49).nu.head<3>(), after = at(states, 13.6).nu.head<3>();
  CHECK((before - 5.99 * bias).norm() < 0.01);
  CHECK((after - (1.0 - 0.85) * 6.1 * bias).norm() < 0.01);
}

}  // namespace fathom
