#include "common/diagnosis/questions.hpp"

#include <algorithm>
#include <map>
#include <optional>

#include "common/base/parallel.hpp"

namespace fathom::diagnosis {
namespace {

using identification::FitResult;
using identification::TrajectoryFit;

constexpr std::size_t kCoarseWindows = 60;  // enough to tell whether a form leads anywhere
constexpr std::size_t kThinFrom = 120;      // windows; fewer are asked whole at once
constexpr int kCareful = 2;                 // forms of an effect that earn a look at every window
constexpr int kEnoughRefusals = 2;          // by full fits, in the company of different effects
constexpr double kPromisesMore = 1.25;      // times the gain: then a refused form is asked again
constexpr double kLeastTrust = 0.01;        // what broke its promise once is still asked last

bool holds(const model::Model& model, const Candidate& candidate) {
  return std::any_of(model.effects.begin(), model.effects.end(), [&](const model::ActiveEffect& active) {
    return active.effect == candidate.effect && active.variant == candidate.variant;
  });
}

/// Places of the forms that promise most.
std::vector<std::size_t> promising(const std::vector<Screened>& rough, const Linearisation& base,
                                   const Settings& settings) {
  const double cost = total(base.window_cost());
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < rough.size(); ++i) {
    if (reduction(cost, cost - rough[i].gain) >= kPromise * settings.smallest_reduction) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return rough[a].gain > rough[b].gain; });
  std::map<const model::Effect*, int> forms;
  std::erase_if(order, [&](std::size_t i) { return ++forms[rough[i].effect] > kCareful; });
  return order;
}

}  // namespace

std::vector<Candidate> all_candidates(const model::Scene& scene) {
  std::vector<Candidate> candidates;
  for (const model::Effect* effect : model::all_effects()) {
    const auto variants = effect->variants(scene);
    for (std::size_t v = 0; v < variants.size(); ++v) {
      if (variants[v] != "-") candidates.push_back({effect, static_cast<int>(v), variants[v]});
    }
  }
  return candidates;
}

Answers ask(std::span<const Candidate> candidates, const TrajectoryFit& problem, const FitResult& fit,
            const model::Scene& scene, const Settings& settings) {
  std::vector<Candidate> asked;
  for (const Candidate& candidate : candidates) {
    if (!holds(fit.model, candidate)) asked.push_back(candidate);
  }
  const int tried = static_cast<int>(candidates.size());
  const Linearisation whole{problem, fit};
  const bool thin = problem.windows().size() > kThinFrom;
  const Linearisation base = whole.thinned(thin ? kCoarseWindows : problem.windows().size());

  Answers answers;
  answers.screened.resize(asked.size());
  for_each_index(asked.size(), settings.threads, [&](std::size_t i) {
    const Candidate& form = asked[i];
    answers.screened[i] = screen(base, *form.effect, form.variant, form.name, form.effect->starts(scene, form.variant));
  });
  for (const Screened& rough : answers.screened) answers.judged.push_back(judge(rough, base, tried));
  if (thin) {
    const std::vector<std::size_t> careful = promising(answers.screened, base, settings);
    for_each_index(careful.size(), settings.threads,
                   [&](std::size_t k) { answers.screened[careful[k]] = refine(whole, answers.screened[careful[k]]); });
    for (const std::size_t i : careful) answers.judged[i] = judge(answers.screened[i], whole, tried);
    // What only the spread of windows was asked about counts by its share, so that forms can be compared.
    const double scale = total(whole.window_cost()) / std::max(total(base.window_cost()), 1e-300);
    for (std::size_t i = 0; i < asked.size(); ++i) {
      if (std::find(careful.begin(), careful.end(), i) == careful.end()) answers.screened[i].gain *= scale;
    }
  }
  answers.fitted.assign(asked.size(), false);
  for (Judged& judged : answers.judged) judged.reason = refusal(judged, settings);
  return answers;
}

Coarse::Coarse(const TrajectoryFit& whole, std::span<const Trial> train, const Settings& settings, const FitResult& fit)
    : whole_{whole}, train_{train}, settings_{settings}, fit_{fit} {}

bool Coarse::useful() const { return whole_.windows().size() > kThinFrom; }

const TrajectoryFit& Coarse::problem() {
  if (problem_) return *problem_;
  identification::FitSettings few = settings_.fit;
  few.most_windows = kCoarseWindows;
  problem_.emplace(whole_.vehicle(), train_, few);
  like_.sigma = fit_.sigma;
  for (const auto& window : problem_->windows()) like_.nu0.push_back(window.window().trial->nu[window.window().start]);
  reference_ = problem_->fit(fit_.model, &like_);
  return *problem_;
}

const FitResult& Coarse::reference() {
  (void)problem();
  return reference_;
}

void look_afar(Answers& answers, Coarse& coarse, const FitResult& fit, const model::Scene& scene,
               const Progress& progress, double share) {
  for (std::size_t i = 0; i < answers.screened.size(); ++i) {
    Screened& candidate = answers.screened[i];
    for (const std::vector<double>& start : candidate.effect->far_starts(scene, candidate.variant)) {
      progress("looking further at " + std::string(candidate.effect->name()), share);
      model::Model model = fit.model;
      model.add({candidate.effect, candidate.variant, candidate.variant_name, start});
      const FitResult far = coarse.problem().fit(model, &coarse.reference());
      const double gain = fit.cost * (1.0 - far.cost / coarse.reference().cost);
      if (gain <= candidate.gain) continue;
      candidate.gain = gain;
      candidate.start = far.model;
      answers.fitted[i] = false;
    }
  }
}

double Promises::expected(const Screened& screened) const {
  const auto place = kept_.find(screened.effect);
  return screened.gain * (place == kept_.end() || screened.start ? 1.0 : place->second);
}

void Promises::kept(const Screened& screened, double gain) {
  if (screened.gain > 0.0) kept_[screened.effect] = std::clamp(gain / screened.gain, kLeastTrust, 1.0);
}

void Promises::refused(const Screened& screened, const Judged& judged) {
  Refusal& refusal = refused_[{screened.effect, screened.variant}];
  ++refusal.times;
  refusal.gain = std::max(refusal.gain, screened.gain);
  refusal.judged = judged;
}

void Promises::recall(Answers& answers) const {
  for (std::size_t i = 0; i < answers.screened.size(); ++i) {
    const Screened& screened = answers.screened[i];
    const auto known = refused_.find({screened.effect, screened.variant});
    if (known == refused_.end() || known->second.times < kEnoughRefusals) continue;
    if (screened.gain > kPromisesMore * known->second.gain) continue;
    answers.judged[i] = known->second.judged;
    answers.fitted[i] = true;
  }
}

std::vector<std::size_t> worth_fitting(const Answers& answers, const Promises& promises, const Settings& settings,
                                       Which which) {
  const std::vector<Screened>& screened = answers.screened;
  std::vector<std::size_t> order;
  std::map<const model::Effect*, int> fitted;
  for (std::size_t i = 0; i < screened.size(); ++i) {
    if (answers.fitted[i]) ++fitted[screened[i].effect];
  }
  for (std::size_t i = 0; i < screened.size(); ++i) {
    if (answers.fitted[i] || (fitted[screened[i].effect] >= kCareful && !screened[i].start)) continue;
    if (answers.judged[i].error_reduction < settings.smallest_reduction && !screened[i].start) continue;
    if (which == Which::kOpen && !answers.judged[i].reason.empty()) continue;
    if (which == Which::kFromAfar && !screened[i].start) continue;
    const auto same = std::find_if(order.begin(), order.end(),
                                   [&](std::size_t k) { return screened[k].effect == screened[i].effect; });
    if (same == order.end()) {
      order.push_back(i);
    } else if (screened[i].gain > screened[*same].gain) {
      *same = i;
    }
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return promises.expected(screened[a]) > promises.expected(screened[b]);
  });
  return order;
}

void name_unfitted(Answers& answers) {
  for (std::size_t i = 0; i < answers.judged.size(); ++i) {
    if (answers.judged[i].reason.empty() && !answers.fitted[i])
      answers.judged[i].reason = "looked at only roughly: others promise more";
  }
}

model::Model start_of(const TrajectoryFit& problem, const FitResult& fit, const Screened& screened) {
  if (screened.start) return *screened.start;
  const model::ActiveEffect effect{screened.effect, screened.variant, screened.variant_name, screened.theta};
  model::Model still = fit.model, moved = screened.base;
  still.add(effect);
  moved.add(effect);
  return problem.cost(moved, fit) < problem.cost(still, fit) ? moved : still;
}

}  // namespace fathom::diagnosis
