// The trial's estimator on motions known at every instant: shallow and deep, its stated errors, late samples.
#include "common/estimation/online/navigator.hpp"

#include <doctest/doctest.h>

#include "test/common/estimation/survey_runs.hpp"

namespace fathom {
namespace {

using estimation::Navigator;
using estimation::NavigatorSettings;

}  // namespace

TEST_CASE("navigator: without noise the corrected equations follow the truth, shallow and deep") {
  for (const bool shallow : {true, false}) {
    CAPTURE(shallow);
    const Judged j =
        judge(run({.shallow = shallow, .noisy = false, .force_bias = 0.0}, test::survey_settings(shallow)), 1, 20.0);
    CHECK(j.position.maxCoeff() < (shallow ? 0.002 : 0.02));  // m: what sampling the attitude at 100 Hz leaves
    CHECK(j.velocity.maxCoeff() < 0.003);                     // m/s
    CHECK(j.valid == 1.0);
  }
}

TEST_CASE("navigator: errors per axis over twenty seeds, and stated errors that are the true ones") {
  constexpr int kSeeds = 20;
  for (const bool shallow : {true, false}) {
    CAPTURE(shallow);
    Judged mean;
    for (unsigned seed = 1; seed <= kSeeds; ++seed) {
      const Judged j = judge(run({.seed = seed, .shallow = shallow}, test::survey_settings(shallow)), seed, 20.0);
      mean.position += j.position / kSeeds;
      mean.velocity += j.velocity / kSeeds;
      mean.nees_position += j.nees_position / kSeeds;
      mean.nees_velocity += j.nees_velocity / kSeeds;
      CHECK(j.valid == 1.0);
    }
    MESSAGE("position [mm] " << 1e3 * mean.position.transpose() << ", velocity [mm/s] "
                             << 1e3 * mean.velocity.transpose() << ", NEES per axis, position "
                             << mean.nees_position.transpose() << ", velocity " << mean.nees_velocity.transpose());
    CHECK(mean.position.maxCoeff() < (shallow ? 0.006 : 0.08));  // m; one tag has 0.008, one acoustic fix 0.1
    CHECK(mean.velocity.maxCoeff() < 0.012);                     // m/s
    for (const double nees : {mean.nees_position.x(), mean.nees_position.y(), mean.nees_position.z(),
                              mean.nees_velocity.x(), mean.nees_velocity.y(), mean.nees_velocity.z()}) {
      CHECK(nees > 0.5);  // twenty runs of 40 s: the band around 1 within which a filter with fixed gains is honest
      CHECK(nees < 1.6);
    }
  }
}

TEST_CASE("navigator: ten seconds without a tag move the position by less than a tenth of a metre") {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const auto states = run({.seed = seed, .gap_from = 30.0, .gap_to = 40.0}, test::survey_settings(true));
    const Judged j = judge(states, seed, 30.0, 40.0);
    CAPTURE(seed);
    CHECK(j.worst_position < 0.1);
    CHECK(j.valid == 1.0);
    CHECK(j.nees_position.maxCoeff() < 9.0);  // it says itself that it drifts: within three standard deviations
    const StateEstimate& last = states[3990];
    CHECK(last.age[static_cast<std::size_t>(Source::kTagPose)] > 9.8);
    CHECK(last.age[static_cast<std::size_t>(Source::kOpticalFlow)] < 0.15);
    CHECK(last.age[static_cast<std::size_t>(Source::kDvl)] == -1.0);
  }
}

TEST_CASE("navigator: lateness within what is stated, and the order of arrival, change no bit") {
  for (const bool shallow : {true, false}) {
    const auto in_time = run({.duration = 20.0, .shallow = shallow, .lateness = 0.0}, test::survey_settings(shallow));
    const auto late = run({.duration = 20.0, .shallow = shallow, .lateness = 1.0}, test::survey_settings(shallow));
    REQUIRE(in_time.size() == late.size());
    for (std::size_t k = 0; k < late.size(); ++k) {
      REQUIRE(in_time[k].utime == late[k].utime);
      REQUIRE(in_time[k].p_WB == late[k].p_WB);
      REQUIRE(in_time[k].nu == late[k].nu);
      REQUIRE(in_time[k].covariance == late[k].covariance);
    }
  }
}

TEST_CASE("navigator: what an attitude wanders by is stated, and moves nothing else") {
  NavigatorSettings settings = test::survey_settings(true);
  const auto plain = run({.shallow = true}, settings);
  settings.attitude_systematic = 0.004;
  settings.heading_systematic = 0.009;
  const auto stated = run({.shallow = true}, settings);
  REQUIRE(stated.size() == plain.size());
  for (std::size_t k = 0; k < stated.size(); k += 100) {
    CHECK(stated[k].nu == plain[k].nu);
    CHECK(stated[k].covariance == plain[k].covariance);
    // The axes of the body see the world's a little turned: the sum of squares is the same.
    const double all = 2.0 * (0.002 * 0.002 + 0.004 * 0.004) + 0.002 * 0.002 + 0.009 * 0.009;
    CHECK(stated[k].sigma.segment<3>(3).squaredNorm() == doctest::Approx(all));
    CHECK(stated[k].sigma[5] > 1.5 * stated[k].sigma[3]);
  }
}

TEST_CASE("navigator: a measurement later than stated is used at its own time and counted") {
  Navigator navigator{test::survey_settings(false), test::survey_places()};
  const auto states =
      test::feed(navigator, test::synthetic_survey({.duration = 40.0, .shallow = false, .lateness = 1.6}));
  const Judged j = judge(states, 1, 20.0);
  CHECK(j.velocity.maxCoeff() < 0.012);  // m/s: as good as in time, since nothing is taken for what it is not
  CHECK(navigator.rejected()["USBL later than stated"] > 30);
  CHECK(navigator.rejected().count("USBL too late") == 0);
}

TEST_CASE("navigator: published gains keep the paper's tank estimate within centimetres") {
  NavigatorSettings settings = test::survey_settings(true);
  settings.published_gains = true;
  const Judged j = judge(run({.shallow = true}, settings), 1, 20.0);
  CHECK(j.position.maxCoeff() < 0.03);            // m
  CHECK(j.velocity.head<2>().maxCoeff() < 0.03);  // m/s; heave has only two laser ranges to go by
  CHECK(j.velocity.z() < 0.08);
}

}  // namespace fathom
