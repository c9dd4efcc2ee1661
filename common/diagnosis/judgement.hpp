// What decides about a candidate: odds, share of the error, carrying over, physical limits.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/diagnosis/held_out.hpp"
#include "common/diagnosis/search.hpp"

namespace fathom::diagnosis {

/// Reason of what would have been accepted had nothing better been found.
inline constexpr const char* kWeaker = "weaker than the accepted effects";

/// Reason of what was accepted by the training runs alone.
inline constexpr const char* kNotCarriedOver = "helps the runs that it was fitted to, and not the validation run";

/// Reason of a time after the command that is none for sure.
inline constexpr const char* kTooQuick = "shorter than how commands are held between their samples could make it";

/// True when the effect is a time after the command, and no longer than that.
[[nodiscard]] bool too_quick(const identification::TrajectoryFit& problem, const model::Model& model,
                             const Judged& judged);
/// Share of the error (RMS) that a cost has lost.
[[nodiscard]] double reduction(double cost_without, double cost_with);
/// The model without that effect in that form.
[[nodiscard]] model::Model without(model::Model model, const Judged& judged);
/// Sum of costs per window.
[[nodiscard]] double total(std::span<const double> window_cost);
/// By the screening alone; `tried` candidates share the prior.
[[nodiscard]] Judged judge(const Screened& screened, const Linearisation& base, int tried);
/// Odds and share of the error, by a fit of it against the fit without it.
void judge_by_odds(Judged& judged, const identification::FitResult& without, const identification::FitResult& with,
                   int tried);
/// Log odds for the fit with more numbers when the noise of each axis is not known, each window a single observation of
/// it: what little is left of a cost tells much where it is most of what is left on an axis.
[[nodiscard]] double odds_by_what_is_left(const identification::FitResult& fewer, const identification::FitResult& more,
                                          int numbers, int tried);
/// Where odds do not suffice for what explains much: better odds if the windows that it acts in leave no doubt of it.
void judge_by_few_windows(Judged& judged, const identification::TrajectoryFit& problem,
                          const identification::FitResult& with, int tried, const Settings& settings);
/// Whether it moves predictions, and whether it carries over to data left out of its estimate.
void judge_by_data_left_out(Judged& judged, const identification::TrajectoryFit& problem,
                            const identification::FitResult& without, const CrossValidation& without_checked,
                            const identification::FitResult& with);
/// Log odds that numbers far beyond the ordinary cost: a prior with tails that never rule anything out (Cauchy), free
/// of charge up to one prior sigma.
[[nodiscard]] double surprise(const model::Model& model, const Judged& judged);
/// More is needed of what explains little.
[[nodiscard]] double needed_log_odds(const Judged& judged, const Settings& settings);
/// Whether odds alone, or fair odds and what it saves on blocks left out, speak for it.
[[nodiscard]] bool evident(const Judged& judged, const Settings& settings);
/// Whether data left out might still decide.
[[nodiscard]] bool doubtful(const Judged& judged, const Settings& settings);
/// "fits only with ... at its physical limit", or empty.
[[nodiscard]] std::string at_limit(const Judged& judged, const model::Model& model);
/// Why it must be refused; empty when nothing speaks against it. With the fitted `model`, limits are looked at too.
[[nodiscard]] std::string refusal(const Judged& judged, const Settings& settings, const model::Model* model = nullptr);
/// The best form of every effect that is not among the accepted ones, best odds first.
[[nodiscard]] std::vector<Judged> best_of_each_effect(const std::vector<Judged>& judged,
                                                      const std::vector<Judged>& accepted);

}  // namespace fathom::diagnosis
