// A verdict's causes and the refusals of candidates as data: what result.json holds beside DiagnosisResult where the
// likelihood's core has answered.
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

struct VerdictGiven {
  std::string core;  ///< "likelihood"; empty: nothing is given
  std::vector<CauseGiven> causes;
  std::map<std::string, std::vector<RefusalGiven>> refusals;  ///< by the candidate's name
};

}  // namespace fathom
