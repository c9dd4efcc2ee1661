// What the minds say to each other: STATE, MODEL, RESIDUAL, EFFECTS.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "common/base/spatial.hpp"
#include "common/base/time.hpp"

namespace fathom {

/// Estimate of the vehicle's motion.
struct StateEstimate {
  Utime utime{};
  Eigen::Vector3d p_WB{Eigen::Vector3d::Zero()};                             ///< m, NED
  Eigen::Quaterniond q_WB{Eigen::Quaterniond::Identity()};                   ///< unit
  Vector6d nu{Vector6d::Zero()};                                             ///< m/s, rad/s: u v w p q r
  Eigen::Matrix<double, 12, 1> sigma{Eigen::Matrix<double, 12, 1>::Zero()};  ///< std of p_WB, rotation, nu
  bool valid{false};  ///< false until every part rests on a measurement
};

/// Motion of a recorded run as all its measurements together tell it.
struct SmoothedState {
  Utime utime{};
  Eigen::Vector3d p_WB{Eigen::Vector3d::Zero()};                             ///< m, NED
  Eigen::Quaterniond q_WB{Eigen::Quaterniond::Identity()};                   ///< unit
  Vector6d nu{Vector6d::Zero()};                                             ///< m/s, rad/s: u v w p q r
  Vector6d nu_dot{Vector6d::Zero()};                                         ///< m/s^2, rad/s^2
  Eigen::Matrix<double, 18, 1> sigma{Eigen::Matrix<double, 18, 1>::Zero()};  ///< std of p_WB, rotation, nu, nu_dot
};

/// One named number with its standard deviation.
struct NamedValue {
  std::string name;  ///< SNAME letters, e.g. "X_u", "m_X"
  double value{};
  double std{};
  std::string unit;  ///< e.g. "N/(m/s)"
};

/// The identifier's model.
struct ModelEstimate {
  Utime utime{};
  std::vector<NamedValue> parameters;
  std::vector<std::string> effects;  ///< adopted effects
  std::int64_t updates{};            ///< regressor rows used so far
};

/// What the model leaves unexplained: tau_applied - tau_explained.
struct Residual {
  Utime utime{};
  Vector6d wrench{Vector6d::Zero()};  ///< N, N m, body axes
};

/// One candidate cause with its odds.
struct EffectEvidence {
  std::string name;
  double log_odds{};         ///< natural logarithm, against the model without it
  double error_reduction{};  ///< share of the residual's energy that it explains, 0..1
};

/// The diagnoser's ranking, best first.
struct EffectRanking {
  Utime utime{};
  std::string verdict;  ///< "adequate", "effect", "ambiguous", "unexplained", "collecting"
  std::vector<EffectEvidence> candidates;
};

}  // namespace fathom
