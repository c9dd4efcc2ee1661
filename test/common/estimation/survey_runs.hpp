// Runs of the trial's estimator over a synthetic survey, and how far its states are from the truth.
#pragma once

#include <vector>

#include "common/estimation/online/navigator.hpp"
#include "test/support/synthetic_survey.hpp"

namespace fathom {

struct Judged {
  Eigen::Vector3d position{Eigen::Vector3d::Zero()}, velocity{Eigen::Vector3d::Zero()};  // RMS, m and m/s
  Eigen::Vector3d nees_position{Eigen::Vector3d::Zero()}, nees_velocity{Eigen::Vector3d::Zero()};
  double worst_position{}, last_position{};
  double valid{};
};

inline Judged judge(const std::vector<StateEstimate>& states, unsigned seed, double from, double to = 1e9) {
  const test::SyntheticMotion motion{seed};
  Judged j;
  double n = 0.0, valid = 0.0;
  for (const StateEstimate& state : states) {
    const double t = seconds_between(1'000'000'000, state.utime);
    if (t < from || t >= to) continue;
    n += 1.0;
    valid += state.valid ? 1.0 : 0.0;
    const Eigen::Vector3d dp = state.p_WB - motion.p_WB(t), dv = state.nu.head<3>() - motion.v_B(t);
    j.position += dp.cwiseAbs2();
    j.velocity += dv.cwiseAbs2();
    j.nees_position += dp.cwiseQuotient(state.sigma.head<3>()).cwiseAbs2();
    j.nees_velocity += dv.cwiseQuotient(state.sigma.segment<3>(6)).cwiseAbs2();
    j.worst_position = std::max(j.worst_position, dp.norm());
    j.last_position = dp.norm();
  }
  j.position = (j.position / n).cwiseSqrt();
  j.velocity = (j.velocity / n).cwiseSqrt();
  j.nees_position /= n;
  j.nees_velocity /= n;
  j.valid = valid / n;
  return j;
}

inline std::vector<StateEstimate> run(const test::SurveyOptions& options,
                                      const estimation::NavigatorSettings& settings) {
  estimation::Navigator navigator{settings, test::survey_places()};
  return test::feed(navigator, test::synthetic_survey(options));
}

}  // namespace fathom
