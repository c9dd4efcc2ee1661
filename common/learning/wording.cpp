#include "common/learning/wording.hpp"

#include <cmath>
#include <cstdio>

#include "common/model/vehicle.hpp"

namespace fathom::learning {
namespace {

template <typename... Arguments>
std::string text(const char* format, Arguments... arguments) {
  char buffer[512];
  std::snprintf(buffer, sizeof buffer, format, arguments...);
  return buffer;
}

}  // namespace

std::string too_little(const std::string& what, double value, const std::string& how, double needed) {
  return what + text(" %.3g, ", value) + how + text(" %.3g needed", needed);
}

std::string correction_sentence(const inference::FreeForceFound& found, const CorrectionGiven& given) {
  std::string with;
  for (const inference::GroupFound& group : found.groups) with += (with.empty() ? "" : "; ") + words(group);
  std::string sentence = text(
                             "A force that no listed effect explains, %.1f %% of the applied force in %s, was learned "
                             "and added to the model. It goes with ",
                             100.0 * given.size, model::kAxisNames[static_cast<std::size_t>(found.size.axis)]) +
                         with + "." + (given.formula ? " " + given.formula->words : "") +
                         " It is a correction with arguments, not a cause.";
  const double fall = 100.0 * (1.0 - given.held_out);
  sentence += text(" Where its weights were not fitted, the open-loop error is %.0f %% lower (%d predictions).", fall,
                   given.windows);
  if (!given.carried) {
    sentence += " What of it lasts beyond these recordings is not enough to be carried to others.";
  } else if (std::abs(given.held_out_carried - given.held_out) > 1e-12) {
    sentence += text(" Without what depends on time, which other runs are not told, it is %.0f %% lower.",
                     100.0 * (1.0 - given.held_out_carried));
  }
  if (given.left.empty()) return sentence;
  sentence += " What remains as a random force, share of the applied force:";
  for (const CorrectionLeft& left : given.left)
    sentence += text(" %s %.1f %% (without it %.1f %%),", left.axis.c_str(), 100.0 * left.share, 100.0 * left.before);
  sentence.back() = '.';
  return sentence;
}

}  // namespace fathom::learning
