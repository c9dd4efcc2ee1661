// What the minds say to each other: STATE, MODEL, RESIDUAL, EFFECTS, LEARNED.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/spatial.hpp"
#include "common/base/time.hpp"

namespace fathom {

/// What a state estimate can rest on, in the order of StateEstimate::age.
enum class Source { kAhrs, kPoseCapture, kTagPose, kOpticalFlow, kLaserRange, kDvl, kUsbl, kDepth };
inline constexpr std::size_t kSources = 8;
using SourceAges = std::array<double, kSources>;
inline constexpr SourceAges kNoSource{-1.0, -1.0, -1.0, -1.0, -1.0, -1.0, -1.0, -1.0};

/// Estimate of the vehicle's motion.
struct StateEstimate {
  Utime utime{};
  Eigen::Vector3d p_WB{Eigen::Vector3d::Zero()};                             ///< m, NED
  Eigen::Quaterniond q_WB{Eigen::Quaterniond::Identity()};                   ///< unit
  Vector6d nu{Vector6d::Zero()};                                             ///< m/s, rad/s: u v w p q r
  Eigen::Matrix<double, 12, 1> sigma{Eigen::Matrix<double, 12, 1>::Zero()};  ///< std of p_WB, rotation, nu
  bool valid{false};                      ///< false until every part rests on a measurement
  Matrix6d covariance{Matrix6d::Zero()};  ///< of p_WB in W [m] and u v w in B [m/s]
  SourceAges age{kNoSource};              ///< s since a sample of each source counted; -1: never
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

/// Standard deviations on each side of a normal number that hold 95 % of it.
inline constexpr double kNormal95 = 1.96;

/// One named number with its standard deviation.
struct NamedValue {
  std::string name;  ///< SNAME letters, e.g. "X_u", "m_X"
  double value{};
  double std{};
  std::string unit;                                   ///< e.g. "N/(m/s)"
  std::optional<std::array<double, 2>> interval95{};  ///< where it was found otherwise than from `std`

  [[nodiscard]] std::array<double, 2> range95() const {
    return interval95.value_or(std::array{value - kNormal95 * std, value + kNormal95 * std});
  }
};

/// How sure the parameters of one motion are.
struct ModeMetric {
  std::string mode;  ///< "surge", "sway", "heave", "roll", "pitch", "yaw" or "total"
  double sum{};      ///< of variances under the stated noise, each in its own unit squared (Karras et al., eq. 1.15)
  double scaled{};   ///< largest standard deviation over the parameter's size, residuals' colour included
};

/// The identifier's model.
struct ModelEstimate {
  Utime utime{};
  std::vector<NamedValue> parameters;
  std::vector<std::string> effects;        ///< adopted effects
  std::vector<NamedValue> effect_numbers;  ///< theirs, "effect.parameter"
  std::int64_t updates{};                  ///< regressor rows used so far
  std::vector<ModeMetric> modes;
  std::vector<double> covariance;             ///< of the parameters, row by row, as honest as std
  Vector6d residual_ratio{Vector6d::Zero()};  ///< recent mean square over the expected one; 0: unknown
  Vector6d residual_mean{Vector6d::Zero()};   ///< recent mean in standard deviations of that mean
  /// Squares of the residual over the noise's, beyond their number, while its test failed: the model lacks something,
  /// and deviations are widened for it. 0: the test never failed.
  Vector6d residual_excess{Vector6d::Zero()};
  std::vector<std::string> frozen;  ///< parameters that are not learnt at present
  bool joint{false};                ///< numbers of the joint estimate; else the recursive one's
};

/// What the model leaves unexplained: tau_applied - tau_explained.
struct Residual {
  Utime utime{};
  Vector6d wrench{Vector6d::Zero()};  ///< N, N m, body axes
};

/// One candidate cause with its odds.
struct EffectEvidence {
  std::string name;
  double log_odds{};              ///< natural logarithm, against the model without it
  double error_reduction{};       ///< by which the error on unseen motion falls with all accepted, 0..1; 0: not known
  std::string variant{};          ///< its form, "thruster 3"; empty when it has one only
  std::vector<double> numbers{};  ///< best values found, in the order and units of the effect's parameters
};

/// The diagnoser's ranking, best first.
struct EffectRanking {
  Utime utime{};
  std::string verdict;  ///< as in DiagnosisResult, "collecting" before the first
  std::vector<EffectEvidence> candidates;
  std::string against;  ///< candidate, or in words what no list holds, that the first cannot be told from; empty: none
  std::string segment;  ///< what tells them apart when flown; empty: not known
  double duration{};    ///< s of it, again and again
};

/// A force that no list holds, as the diagnoser has learned it by a trial's end: a correction with arguments.
struct LearnedTold {
  Utime utime{};
  bool adopted{false};              ///< else `words` say why it is refused
  double log_odds{};                ///< over the best listed model
  double size{};                    ///< share of the applied force, on its worst axis
  double held_out{1.0};             ///< open-loop error over the model's without it, where no weight was fitted
  std::string words, equation;      ///< a sentence; Fossen's notation, empty: no closed form
  std::vector<NamedValue> numbers;  ///< of the equation
};

}  // namespace fathom
