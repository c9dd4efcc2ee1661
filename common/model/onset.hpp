// A change at a moment to be found: how much of it has happened, and where a search for the moment may begin.
#pragma once

#include <algorithm>
#include <string_view>
#include <vector>

#include "common/model/effect.hpp"

namespace fathom::model {

inline constexpr std::string_view kOnset = "onset";  // name of such a moment among an effect's numbers
constexpr double kOnsetDuration = 0.3;  // s, within which a change happens: smooth, so that its moment can be searched

// A step anywhere within the assumed duration would look much the same: the std of a uniform spread over it.
constexpr double kOnsetFormSigma = kOnsetDuration / 3.4641;
/// Such a moment, as a number of an effect.
inline constexpr EffectParameter kOnsetParameter{kOnset, "s", 1000.0, 0.0, 1e6, kOnsetFormSigma, false, true};

/// Share of a change at `t` that takes `duration` about `onset`: 0 before, 1 after, with two continuous derivatives.
inline double share_over(double t, double onset, double duration) {
  const double s = std::clamp((t - onset) / std::max(duration, kOnsetDuration) + 0.5, 0.0, 1.0);
  return s * s * s * (s * (6.0 * s - 15.0) + 10.0);
}
inline double onset_share(double t, double onset) { return share_over(t, onset, kOnsetDuration); }

/// Moments spread over the data, none so close to an end that hardly anything would come before or after.
inline std::vector<double> onset_starts(double t_low, double t_high, int count) {
  std::vector<double> moments;
  for (int k = 0; k < count && t_high > t_low; ++k) {
    moments.push_back(t_low + (t_high - t_low) * (k + 0.5) / count);
  }
  return moments;
}

}  // namespace fathom::model
