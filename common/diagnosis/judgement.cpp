#include "common/diagnosis/judgement.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "common/diagnosis/evidence.hpp"
#include "common/diagnosis/few_windows.hpp"
#include "common/diagnosis/places.hpp"
#include "common/model/effect_size.hpp"
#include "common/model/onset.hpp"

namespace fathom::diagnosis {
namespace {

using identification::FitResult;
using identification::TrajectoryFit;

constexpr double kEdge = 0.03;           // of the data's length
constexpr double kHeldOtherwise = 0.57;  // of the time between commands: between straight lines and held ones lie even
                                         // odds over it, which make a delay of as much with 95 %
constexpr double kAtLimit = 0.05;        // of a limit: nearer than that, the number wants to be beyond it

/// Name of a number of the effect that ended at its physical limit (not at zero, which is absence); empty when none
/// did.
std::string limited_number(const model::Model& model, const Judged& judged) {
  for (const model::ActiveEffect& active : model.effects) {
    if (active.effect != judged.effect || active.variant != judged.variant) continue;
    for (std::size_t i = 0; i < active.theta.size(); ++i) {
      if (!active.effect->takes_part(active.variant, i)) continue;
      const model::EffectParameter number = model::parameter_of(*active.effect, active.variant, i, *model.vehicle);
      for (const double limit : {number.low, number.high}) {
        if (limit != 0.0 && std::abs(active.theta[i] - limit) < kAtLimit * std::abs(limit))
          return std::string(number.name);
      }
    }
  }
  return "";
}

/// Where the effect's numbers stand among the fit's parameters: after the base's, effect by effect.
std::vector<Eigen::Index> places_of(const model::Model& model, const Judged& judged) {
  std::size_t place = identification::ParameterMap{model}.size();
  for (const model::ActiveEffect& active : model.effects) place -= active.theta.size();
  std::vector<Eigen::Index> places;
  for (const model::ActiveEffect& active : model.effects) {
    for (std::size_t i = 0; i < active.theta.size(); ++i, ++place) {
      if (active.effect == judged.effect && active.variant == judged.variant)
        places.push_back(static_cast<Eigen::Index>(place));
    }
  }
  return places;
}

/// True when the effect's numbers have the vehicle where it cannot be, and not just for a moment.
bool in_the_way(const TrajectoryFit& problem, const model::Model& model, const Judged& judged) {
  if (!judged.effect->feels_place()) return false;
  for (const model::ActiveEffect& active : model.effects) {
    if (active.effect != judged.effect || active.variant != judged.variant) continue;
    double samples = 0.0, inside = 0.0;
    for (const auto& window : problem.windows()) {
      const model::Window& of = window.window();
      if (!of.trial->observed.position) continue;
      for (std::size_t k = of.start; k < of.start + of.count && k < of.trial->size(); ++k) {
        if (of.trial->pose_valid[k] == 0) continue;
        samples += 1.0;
        if (!active.effect->possible(of.trial->p_WB[k], active.theta, active.variant)) inside += 1.0;
      }
    }
    if (inside > kInside * samples) return true;
  }
  return false;
}

/// True when the effect begins or ends so close to the edge of the data that it acts all the time, or never.
bool onset_at_edge(const TrajectoryFit& problem, const model::Model& model, const Judged& judged) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const auto& window : problem.windows()) {
    low = std::min(low, window.window().trial->t.front());
    high = std::max(high, window.window().trial->t.back());
  }
  for (const model::ActiveEffect& active : model.effects) {
    if (active.effect != judged.effect || active.variant != judged.variant) continue;
    for (std::size_t i = 0; i < active.theta.size(); ++i) {
      if (active.effect->parameters()[i].name != model::kOnset) continue;
      const double margin = kEdge * (high - low);
      if (active.theta[i] < low + margin || active.theta[i] > high - margin) return true;
    }
  }
  return false;
}

}  // namespace

bool too_quick(const TrajectoryFit& problem, const model::Model& model, const Judged& judged) {
  const double step = problem.input_step();
  bool after_command = false;
  for (const model::ActiveEffect& active : model.effects) {
    if (active.effect != judged.effect || active.variant != judged.variant) continue;
    for (std::size_t i = 0; i < active.theta.size(); ++i) {
      const model::EffectParameter number = model::parameter_of(*active.effect, active.variant, i, *model.vehicle);
      if (!active.effect->takes_part(active.variant, i) || number.unit != "s") continue;
      if (std::abs(active.theta[i]) > kHeldOtherwise * step) return false;
      after_command = after_command || number.after_command;
    }
  }
  return after_command;
}

double reduction(double cost_without, double cost_with) {
  return cost_without > 0.0 ? 1.0 - std::sqrt(std::max(cost_with, 0.0) / cost_without) : 0.0;
}

model::Model without(model::Model model, const Judged& judged) {
  std::erase_if(model.effects, [&](const model::ActiveEffect& active) {
    return active.effect == judged.effect && active.variant == judged.variant;
  });
  return model;
}

double total(std::span<const double> window_cost) {
  double sum = 0.0;
  for (const double cost : window_cost) sum += cost;
  return sum;
}

double surprise(const model::Model& model, const Judged& judged) {
  double cost = 0.0;
  for (const model::ActiveEffect& active : model.effects) {
    if (active.effect != judged.effect || active.variant != judged.variant) continue;
    for (std::size_t i = 0; i < active.theta.size(); ++i) {
      const double size =
          active.theta[i] / model::parameter_of(*active.effect, active.variant, i, *model.vehicle).sigma;
      cost += std::max(std::log(0.5 * (1.0 + size * size)), 0.0);
    }
  }
  return cost;
}

double needed_log_odds(const Judged& judged, const Settings& settings) {
  return judged.error_reduction < settings.subtle ? settings.subtle_log_odds : settings.accept_log_odds;
}

bool evident(const Judged& judged, const Settings& settings) {
  return judged.log_odds >= needed_log_odds(judged, settings) ||
         (judged.log_odds >= settings.doubtful_log_odds && judged.held_out_blocks >= settings.convincing);
}

bool doubtful(const Judged& judged, const Settings& settings) {
  return judged.log_odds >= settings.doubtful_log_odds && judged.error_reduction >= settings.convincing;
}

std::string refusal(const Judged& judged, const Settings& settings, const model::Model* model) {
  char text[160];
  if (judged.error_reduction < settings.smallest_reduction) {
    std::snprintf(text, sizeof text, "explains %.2f %% of the error: changes no prediction",
                  100.0 * judged.error_reduction);
    return text;
  }
  if (judged.change < settings.smallest_change) {
    std::snprintf(text, sizeof text, "moves predictions by %.2f %% of the motion: too little to matter",
                  100.0 * judged.change);
    return text;
  }
  if (!evident(judged, settings)) {
    std::snprintf(text, sizeof text, "log odds %.1f, %.1f needed", judged.log_odds, needed_log_odds(judged, settings));
    return text;
  }
  if (judged.lasting) return "begins at the edge of the data: something that always acts, not an event";
  if (judged.too_quick) return kTooQuick;
  if (judged.in_the_way) return "has the vehicle on the wrong side of what it would be near to";
  if (judged.held_out_blocks < 0.0) return "does not help on blocks of data left out of its estimate";
  if (judged.held_out_runs < 0.0) return "does not carry over from run to run";
  return model != nullptr ? at_limit(judged, *model) : "";
}

std::string at_limit(const Judged& judged, const model::Model& model) {
  const std::string limited = limited_number(model, judged);
  return limited.empty() ? "" : "fits only with " + limited + " at its physical limit";
}

Judged judge(const Screened& screened, const Linearisation& base, int tried) {
  Judged judged{.effect = screened.effect, .variant = screened.variant, .variant_name = screened.variant_name};
  const int parameters = screened.effect->numbers(screened.variant);
  judged.log_odds = log_odds(base.window_cost(), screened.window_cost, parameters, tried);
  judged.error_reduction = reduction(total(base.window_cost()), total(screened.window_cost));
  return judged;
}

void judge_by_odds(Judged& judged, const FitResult& without, const FitResult& with, int tried) {
  const int parameters = judged.effect->numbers(judged.variant);
  judged.log_odds = log_odds(without.window_cost, with.window_cost, parameters, tried) - surprise(with.model, judged);
  judged.error_reduction = reduction(without.cost, with.cost);
}

double odds_by_what_is_left(const FitResult& fewer, const FitResult& more, int numbers, int tried) {
  double sum = 0.0;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    double with_fewer = 0.0, with_more = 0.0, windows = 0.0;
    for (std::size_t w = 0; w < more.window_square.size(); ++w) {
      if (!(more.window_count[w][axis] > 0.0)) continue;
      with_fewer += fewer.window_square[w][axis];
      with_more += more.window_square[w][axis];
      ++windows;
    }
    if (with_fewer > 0.0 && with_more > 0.0) sum += 0.5 * windows * std::log(with_fewer / with_more);
  }
  return sum - price(numbers, static_cast<double>(more.window_square.size()), tried);
}

void judge_by_few_windows(Judged& judged, const TrajectoryFit& problem, const FitResult& with, int tried,
                          const Settings& settings) {
  if (judged.log_odds >= needed_log_odds(judged, settings) || judged.error_reduction < settings.convincing) return;
  const double ratio = ratio_where_it_acts(problem, with, places_of(with.model, judged));
  const auto n = static_cast<double>(problem.windows().size());
  judged.log_odds = std::max(
      judged.log_odds, ratio - price(judged.effect->numbers(judged.variant), n, tried) - surprise(with.model, judged));
}

void judge_by_data_left_out(Judged& judged, const TrajectoryFit& problem, const FitResult& without,
                            const CrossValidation& without_checked, const FitResult& with) {
  judged.change = prediction_change(problem, without, with);
  judged.lasting = onset_at_edge(problem, with.model, judged);
  judged.in_the_way = in_the_way(problem, with.model, judged);
  judged.too_quick = too_quick(problem, with.model, judged);
  const HeldOut carried =
      held_out(problem, without_checked, CrossValidation{problem, with}, places_of(with.model, judged));
  judged.held_out_blocks = carried.blocks;
  judged.held_out_runs = carried.runs;
}

std::vector<Judged> best_of_each_effect(const std::vector<Judged>& judged, const std::vector<Judged>& accepted) {
  std::vector<Judged> best;
  for (const Judged& candidate : judged) {
    const bool taken =
        std::any_of(accepted.begin(), accepted.end(), [&](const Judged& a) { return a.effect == candidate.effect; });
    if (taken) continue;
    const auto same =
        std::find_if(best.begin(), best.end(), [&](const Judged& b) { return b.effect == candidate.effect; });
    if (same == best.end()) {
      best.push_back(candidate);
    } else if (candidate.log_odds > same->log_odds) {
      *same = candidate;
    }
  }
  std::stable_sort(best.begin(), best.end(), [](const Judged& a, const Judged& b) { return a.log_odds > b.log_odds; });
  return best;
}

}  // namespace fathom::diagnosis
