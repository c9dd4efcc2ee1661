#include "common/diagnosis/lack_of_form.hpp"

#include <algorithm>

#include "common/base/parallel.hpp"
#include "common/diagnosis/free_curve.hpp"
#include "common/diagnosis/held_out.hpp"
#include "common/diagnosis/judgement.hpp"
#include "common/diagnosis/screening.hpp"

namespace fathom::diagnosis {
namespace {

using identification::FitResult;
using identification::TrajectoryFit;

constexpr double kTelling = 0.03;     // of the error: a curve that helps less says nothing about forms
constexpr double kSameThing = 0.5;    // of what a curve explains by itself
constexpr std::size_t kCurves = 2;    // that earn a full fit
constexpr std::size_t kWindows = 40;  // of the first look
constexpr double kTolerance = 1e-3;   // relative decrease of the cost

struct Curve {
  const FreeCurve* curve{};
  std::vector<double> theta;
  double share{};
};

/// The most helpful curve of each axis by a first look, best first.
std::vector<Curve> promising(const Linearisation& base, std::span<const std::unique_ptr<const FreeCurve>> all,
                             int threads) {
  std::vector<Curve> looked(all.size());
  for_each_index(all.size(), threads, [&](std::size_t i) {
    const FreeCurve& curve = *all[i];
    const std::vector<std::vector<double>> start{
        std::vector<double>(FreeCurve::kKnots, 0.1 * curve.parameters()[0].sigma)};
    const Screened screened = screen(base, curve, 0, "", start, 0.5 * kTelling);
    looked[i] = {&curve, screened.theta, reduction(total(base.window_cost()), total(screened.window_cost))};
  });
  std::vector<Curve> best;
  for (const Curve& one : looked) {
    if (one.share < kTelling) continue;
    const auto same = std::ranges::find(best, one.curve->axis(), [](const Curve& c) { return c.curve->axis(); });
    if (same == best.end()) {
      best.push_back(one);
    } else if (one.share > same->share) {
      *same = one;
    }
  }
  std::ranges::stable_sort(best, std::greater{}, &Curve::share);
  if (best.size() > kCurves) best.resize(kCurves);
  return best;
}

/// The curve in the effect's place: from the fit with both, or from the fit with neither, whichever leads further.
FitResult in_its_place(const TrajectoryFit& problem, const FitResult& with_none, const FitResult& with_both,
                       const Judged& judged, const FreeCurve& curve) {
  model::Model from_none = with_none.model;
  from_none.add({&curve, 0, "", std::vector<double>(FreeCurve::kKnots, 0.0)});
  FitResult one = problem.fit(from_none, &with_none, kTolerance);
  FitResult other = problem.fit(without(with_both.model, judged), &with_both, kTolerance);
  return one.cost < other.cost ? one : other;
}

/// How much of what the curve explains by itself the effect explains too, when the curve still helps beside it: what
/// both describe is one thing, and it has not the effect's form. A curve that explains far less than the effect does
/// describes another thing, or a corner of this one.
double overlap(const FitResult& with_none, const FitResult& with_effect, const FitResult& with_curve,
               const FitResult& with_both) {
  const double by_curve = with_none.cost - with_curve.cost;
  const double by_effect = with_none.cost - with_effect.cost;
  if (by_curve < kSameThing * by_effect) return 0.0;
  const double shared = by_curve - (with_effect.cost - with_both.cost);
  return by_curve > 0.0 ? shared / by_curve : 0.0;
}

}  // namespace

bool test_forms(SearchResult& result, const TrajectoryFit& problem, const FitResult& accepted,
                const model::Scene& scene, const Progress& progress) {
  progress("asking whether anything unlisted is at work", 0.85);
  const auto all = free_curves(scene);
  const double error = error_left_out(problem, accepted);
  bool refused = false;
  for (const Curve& each :
       promising(Linearisation{problem, accepted}.thinned(kWindows), all, problem.settings().threads)) {
    model::Model model = accepted.model;
    model.add({each.curve, 0, "", each.theta});
    const FitResult with_both = problem.fit(model, &accepted, kTolerance);
    const double share = reduction(error, error_left_out(problem, with_both));
    if (share < kTelling) continue;
    const FreeForm form{model::kAxisNames[static_cast<std::size_t>(each.curve->axis())],
                        name_of(each.curve->quantity()), share};
    if (!result.free_form) result.free_form = form;
    std::erase_if(result.accepted, [&](Judged judged) {
      const FitResult with_none = problem.fit(without(accepted.model, judged), &accepted, kTolerance);
      const FitResult with_curve = in_its_place(problem, with_none, with_both, judged, *each.curve);
      if (overlap(with_none, accepted, with_curve, with_both) < kSameThing) return false;
      judged.reason = "imitates something of another form, which depends on " + form.with + " (on " + form.axis + ")";
      result.refused.push_back(judged);
      result.free_form = FreeForm{form.axis, form.with, reduction(with_none.cost, with_curve.cost), true};
      return refused = true;
    });
  }
  return refused;
}

}  // namespace fathom::diagnosis
