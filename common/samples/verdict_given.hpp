// A verdict's causes, the refusals of candidates and the covariance as data: what result.json holds beside
// DiagnosisResult.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace fathom {

/// What decided a verdict.
struct CauseGiven {
  std::string cause;  ///< "named", "free_force", "not_following", ...
  double value{};
  double threshold{};
  std::string of;  ///< axis, number or quantity that it is about; empty: all
};

/// A rule that a candidate did not pass.
struct RefusalGiven {
  std::string rule;  ///< "odds", "size", "probability", "score", ...
  double value{};
  double needed{};
};

/// A model's error on runs that no fit has seen, beside the simplest predictions.
struct SkillGiven {
  double horizon_s{};
  std::string axis;                               ///< X Y Z K M N
  double rmse{}, rmse_unchanged{}, rmse_plain{};  ///< m/s or rad/s: the model's, where nothing changes, by axis
  double over_unchanged{}, over_plain{};          ///< 1 - (error / that error)^2
};

/// How much of an axis' unexplained acceleration functions of what was recorded could explain at most, as tried.
struct ExplainableGiven {
  std::string axis;
  double share{};
};

struct VerdictGiven {
  std::string core;  ///< "likelihood"; empty: trajectories
  std::vector<CauseGiven> causes;
  std::map<std::string, std::vector<RefusalGiven>> refusals;  ///< by the candidate's name
  std::vector<std::string> covariance_of{};                   ///< names of rows: "X_u", "thruster_lag.time_constant"
  std::vector<double> covariance{};  ///< row by row, in the product of the names' units; empty: not known
  std::vector<SkillGiven> skill{};
  std::vector<ExplainableGiven> explainable{};
};

}  // namespace fathom
