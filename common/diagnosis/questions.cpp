#include "common/diagnosis/questions.hpp"

#include <algorithm>
#include <map>
#include <optional>

#include "common/base/parallel.hpp"

namespace fathom::diagnosis {
namespace {

using identification::FitResult;
using identification::TrajectoryFit;

constexpr double kNearWindow = 2.0;        // s: what a wrong model does in it is still nearly linear
constexpr std::size_t kNearWindows = 100;  // by an even spread
constexpr std::size_t kFirstNear = 34;     // of those, for a search from several starts
constexpr std::size_t kThinFrom = 120;     // windows; fewer are fitted at once
constexpr std::size_t kFirstWindows = 20;  // for a first look; what then promises most is asked by all
constexpr int kCareful = 2;                // forms of an effect that earn a look at every window
constexpr double kWorthAStep = 0.2;        // of the cost, per error: a tenth of the smallest gain that counts
constexpr int kEnoughRefusals = 2;         // by full fits, in the company of different effects
constexpr double kPromisesMore = 1.25;     // times the gain: then a refused form is asked again
constexpr double kLeastTrust = 0.01;       // what broke its promise once is still asked last

bool rules_out(const model::Model& model, const Candidate& candidate) {
  return std::any_of(model.effects.begin(), model.effects.end(), [&](const model::ActiveEffect& active) {
    return active.effect == candidate.effect && active.effect->rules_out(active.variant, candidate.variant);
  });
}

bool worth_a_look(const Screened& rough, const Linearisation& base, const Settings& settings) {
  const double cost = total(base.window_cost());
  return reduction(cost, cost - rough.gain) >= kPromise * settings.smallest_reduction;
}

/// Places of the forms that promise most.
std::vector<std::size_t> promising(const std::vector<Screened>& rough, const Linearisation& base,
                                   const Settings& settings) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < rough.size(); ++i) {
    if (worth_a_look(rough[i], base, settings)) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return rough[a].gain > rough[b].gain; });
  std::map<const model::Effect*, int> forms;
  std::erase_if(order, [&](std::size_t i) { return ++forms[rough[i].effect] > kCareful; });
  return order;
}

Eigen::VectorXi axes_of(const TrajectoryFit& problem) {
  std::vector<int> axes;
  for (const auto& window : problem.windows()) {
    for (Eigen::Index row = 0; row < window.rows(); ++row) axes.push_back(window.axis(row));
  }
  return Eigen::Map<const Eigen::VectorXi>(axes.data(), static_cast<Eigen::Index>(axes.size()));
}

identification::FitSettings near_settings(const Settings& settings) {
  identification::FitSettings near = settings.fit;
  near.window = kNearWindow;
  near.most_windows = kNearWindows;
  return near;
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

NearView::NearView(const model::Vehicle& vehicle, std::span<const Trial> train, const Settings& settings)
    : problem{vehicle, train, near_settings(settings)} {}

void NearView::fit(const model::Model& model) { reference = problem.fit(model); }

Answers ask_near(std::span<const Candidate> candidates, const NearView& near, const model::Scene& scene,
                 const Settings& settings) {
  std::vector<Candidate> asked;
  for (const Candidate& candidate : candidates) {
    if (!rules_out(near.reference.model, candidate)) asked.push_back(candidate);
  }
  const Linearisation base{near.problem, near.reference};
  const Linearisation first = base.telling(kFirstNear);
  const double worth = kWorthAStep * settings.smallest_reduction;
  Answers answers;
  answers.near.resize(asked.size());
  for_each_index(asked.size(), settings.threads, [&](std::size_t i) {
    const Candidate& form = asked[i];
    const auto starts = form.effect->starts(scene, form.variant);
    Screened& screened = answers.near[i];
    if (starts.size() == 1) {
      screened = screen(base, *form.effect, form.variant, form.name, starts, worth);
      return;
    }
    const Screened rough = screen(first, *form.effect, form.variant, form.name, starts, worth);
    screened = worth_a_look(rough, first, settings) ? refine(base, rough) : seen_by(base, rough);
  });
  for (const Screened& screened : answers.near) {
    answers.judged.push_back(judge(screened, base, static_cast<int>(candidates.size())));
    answers.share.push_back(answers.judged.back().error_reduction);
  }
  answers.fitted.assign(asked.size(), false);
  answers.found.resize(asked.size());
  answers.unexplained = base.unexplained().col(0);
  answers.axis = axes_of(near.problem);
  answers.cost = total(base.window_cost());
  return answers;
}

void ask_whole(Answers& answers, const TrajectoryFit& problem, const FitResult& fit, const model::Scene& scene,
               int tried, const Settings& settings) {
  const Linearisation whole{problem, fit};
  const bool thin = problem.windows().size() > kFirstWindows;
  const Linearisation base = whole.thinned(kFirstWindows);
  answers.screened.resize(answers.near.size());
  for_each_index(answers.near.size(), settings.threads, [&](std::size_t i) {
    const Screened& form = answers.near[i];
    answers.screened[i] = screen(base, *form.effect, form.variant, form.variant_name,
                                 form.effect->starts(scene, form.variant), kWorthAStep * settings.smallest_reduction);
  });
  const std::vector<std::size_t> careful =
      thin ? promising(answers.screened, base, settings) : std::vector<std::size_t>{};
  for_each_index(careful.size(), settings.threads,
                 [&](std::size_t k) { answers.screened[careful[k]] = refine(whole, answers.screened[careful[k]]); });
  for (std::size_t i = 0; i < answers.screened.size(); ++i) {
    const bool refined = std::find(careful.begin(), careful.end(), i) != careful.end();
    const Judged judged = judge(answers.screened[i], refined ? whole : base, tried);
    answers.share[i] = std::max(answers.share[i], judged.error_reduction);
    if (answers.fitted[i]) continue;
    answers.judged[i] = judged;
    answers.judged[i].reason = refusal(judged, settings);
  }
}

Coarse::Coarse(const TrajectoryFit& whole, std::span<const Trial> train, const Settings& settings, const FitResult& fit,
               std::size_t windows)
    : whole_{whole}, train_{train}, settings_{settings}, fit_{fit}, windows_{windows} {}

bool Coarse::useful() const { return whole_.windows().size() > kThinFrom; }

const TrajectoryFit& Coarse::problem() {
  if (problem_) return *problem_;
  identification::FitSettings few = settings_.fit;
  few.most_windows = windows_;
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

double Promises::expected(const Answers& answers, std::size_t candidate) const {
  const auto place = kept_.find(answers.near[candidate].effect);
  const bool trusted = place == kept_.end() || answers.found[candidate];
  return answers.share[candidate] * (trusted ? 1.0 : place->second);
}

void Promises::kept(const Answers& answers, std::size_t candidate, double share) {
  const double promised = answers.share[candidate];
  if (promised > 0.0) kept_[answers.near[candidate].effect] = std::clamp(share / promised, kLeastTrust, 1.0);
}

void Promises::refused(const Answers& answers, std::size_t candidate) {
  Refusal& refusal = refused_[{answers.near[candidate].effect, answers.near[candidate].variant}];
  ++refusal.times;
  refusal.share = std::max(refusal.share, answers.share[candidate]);
  refusal.judged = answers.judged[candidate];
}

void Promises::recall(Answers& answers) const {
  for (std::size_t i = 0; i < answers.near.size(); ++i) {
    const auto known = refused_.find({answers.near[i].effect, answers.near[i].variant});
    if (known == refused_.end() || known->second.times < kEnoughRefusals) continue;
    if (answers.share[i] > kPromisesMore * known->second.share) continue;
    answers.judged[i] = known->second.judged;
    // The screening, which promises no less than a fit keeps, has seen the effects that were accepted since.
    answers.judged[i].error_reduction = std::min(answers.judged[i].error_reduction, answers.share[i]);
    answers.fitted[i] = true;
  }
}

std::vector<std::size_t> worth_fitting(const Answers& answers, const Promises& promises, const Settings& settings,
                                       Which which) {
  std::vector<std::size_t> order;
  std::map<const model::Effect*, int> fitted;
  for (std::size_t i = 0; i < answers.near.size(); ++i) {
    if (answers.fitted[i]) ++fitted[answers.near[i].effect];
  }
  for (std::size_t i = 0; i < answers.near.size(); ++i) {
    const model::Effect* effect = answers.near[i].effect;
    const bool from_afar = answers.found[i].has_value();
    if (answers.fitted[i] || (fitted[effect] >= kCareful && !from_afar)) continue;
    if (answers.share[i] < settings.smallest_reduction && !from_afar) continue;
    if (which == Which::kOpen && !answers.judged[i].reason.empty()) continue;
    if (which == Which::kFromAfar && !from_afar) continue;
    const auto same =
        std::find_if(order.begin(), order.end(), [&](std::size_t k) { return answers.near[k].effect == effect; });
    if (same == order.end()) {
      order.push_back(i);
    } else if (answers.share[i] > answers.share[*same]) {
      *same = i;
    }
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return promises.expected(answers, a) > promises.expected(answers, b);
  });
  return order;
}

void name_unfitted(Answers& answers) {
  for (std::size_t i = 0; i < answers.judged.size(); ++i) {
    if (answers.judged[i].reason.empty() && !answers.fitted[i])
      answers.judged[i].reason = "looked at only roughly: others promise more";
  }
}

model::Model start_of(const TrajectoryFit& problem, const FitResult& fit, const Answers& answers,
                      std::size_t candidate) {
  if (answers.found[candidate]) return *answers.found[candidate];
  std::vector<const Screened*> views{&answers.near[candidate]};
  if (!answers.screened.empty()) views.push_back(&answers.screened[candidate]);
  std::vector<model::Model> proposed;
  for (const Screened* screened : views) {
    for (const model::Model* base : {&screened->base, &fit.model}) {
      proposed.push_back(*base);
      proposed.back().add({screened->effect, screened->variant, screened->variant_name, screened->theta});
    }
  }
  return *std::min_element(proposed.begin(), proposed.end(),
                           [&](const auto& a, const auto& b) { return problem.cost(a, fit) < problem.cost(b, fit); });
}

}  // namespace fathom::diagnosis
