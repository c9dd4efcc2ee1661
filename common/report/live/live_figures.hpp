// The pictures of a live trial, numbered as Karras et al. number theirs: 1.11 to 1.14 motion, 1.15 to 1.18 parameters,
// 1.19 certainty.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "common/estimation/smoothing/aids_seen.hpp"
#include "common/report/plot.hpp"
#include "common/samples/live_trial.hpp"
#include "common/samples/recording.hpp"

namespace fathom::report {

/// Figures 1.11 to 1.13: component `axis` of the estimate (0..2 position in W, 3..5 velocity in B) with what the aids
/// say by themselves.
struct AidCurve {
  const estimation::Seen* seen{};
  const char* colour{};
};
[[nodiscard]] Figure draw_component(const Recording& recording, std::size_t axis, std::span<const AidCurve> aids);
/// Position against position: the plan (Figure 1.11) and the path in space (1.14).
[[nodiscard]] Figure draw_plan(const Recording& recording, std::span<const AidCurve> aids);
[[nodiscard]] Figure draw_path(const Recording& recording);
/// Figures 1.15 to 1.18: one parameter between two times, with a band of two standard deviations; the modes' borders.
[[nodiscard]] Figure draw_parameter(const Recording& recording, std::span<const ModeVisit> visits,
                                    const std::string& name, double begin, double end);
/// Figure 1.19: one mode's metric with its threshold.
[[nodiscard]] Figure draw_metric(const Recording& recording, const LiveTrialResult& result, const std::string& mode);
/// The last section's: estimate minus truth of one component, with what the estimator states as two sigma.
[[nodiscard]] Figure draw_state_error(const Recording& recording, std::size_t axis);

}  // namespace fathom::report
