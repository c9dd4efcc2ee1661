#include "common/verdict/followed_axes.hpp"

#include <algorithm>
#include <array>

#include "common/residual/open_loop.hpp"
#include "common/residual/prediction.hpp"
#include "common/verdict/skill.hpp"

namespace fathom::verdict {

std::vector<int> skilled_axes(const model::Vehicle& vehicle, std::span<const Trial> train,
                              std::span<const Trial> unseen, double input_step,
                              const inference::Conclusion& conclusion) {
  std::vector<int> axes;
  const model::Model base = likelihood::model_of(conclusion.reported_base.hypothesis, input_step);
  const model::Model named = likelihood::model_of(conclusion.reported.hypothesis, input_step);
  const std::vector<model::Window> windows =
      residual::foreseen(residual::prediction_windows(unseen, residual::lead_of(named)), std::array{&base, &named})
          .windows;
  if (windows.empty()) return axes;
  const std::array<PlainAxis, 6> plain = plain_fit(vehicle, train);
  const residual::Predictions unchanged = predict_unchanged(windows),
                              plainly = predict_plainly(vehicle, plain, windows),
                              by_base = residual::predict(base, windows), by_named = residual::predict(named, windows);
  for (int axis = 0; axis < 6; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const bool base_is_better = mean_square(by_base, kFiveSeconds, a) < mean_square(by_named, kFiveSeconds, a);
    const residual::Predictions& best = base_is_better ? by_base : by_named;
    const double own = mean_square(best, kFiveSeconds, a);
    const bool acts = plain[a].known && plain[a].t_of_input >= inference::Thresholds{}.idle_input;
    // As good as an equation of the axis alone is followed: only who is surely worse than that follows nothing.
    if (acts && own >= 0.0 && own < mean_square(unchanged, kFiveSeconds, a) &&
        p_no_worse(best, plainly, kFiveSeconds, a) >= inference::Thresholds{}.beaten)
      axes.push_back(axis);
  }
  return axes;
}

std::set<int> withheld_axes(const inference::Conclusion& conclusion) {
  using inference::Cause;
  std::set<int> axes;
  const auto all = [&] { axes = {0, 1, 2, 3, 4, 5}; };
  if (conclusion.verdict != inference::Verdict::no_model) return axes;
  for (const inference::Reason& reason : conclusion.reasons) {
    if (reason.cause == Cause::kNotFollowing || reason.cause == Cause::kNoSkill)
      axes.insert(static_cast<int>(std::ranges::find(model::kAxisNames, reason.of) - model::kAxisNames.begin()));
    if (reason.cause == Cause::kWiring || reason.cause == Cause::kForceUnit) all();
    const auto absurd = model::parameter_from_name(reason.of);
    if (reason.cause == Cause::kAbsurdNumber && absurd) axes.insert(model::axis(*absurd));
  }
  if (axes.empty()) all();
  return axes;
}

}  // namespace fathom::verdict
