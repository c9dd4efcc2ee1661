#include "common/planning/foresight.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/base/parallel.hpp"
#include "common/identification/trajectories/parameter_map.hpp"
#include "common/inference/fitted_models.hpp"
#include "common/model/effect_size.hpp"
#include "common/planning/energies.hpp"

namespace fathom::planning {
namespace {

constexpr std::size_t kMostStarts = 5;  // of a form: places, moments, time constants
constexpr int kRounds = 16;             // of finding a size; most effects are nearly proportional
constexpr double kLargestStep = 3.4;    // between rounds, natural logarithm: a factor of thirty
constexpr double kClose = 0.1;          // of the size
constexpr double kNoSmaller = 0.95;     // of the change that twice the size makes
constexpr double kWave = 1.5;           // rad/s: a wave that nobody has seen yet

/// Of the effect's numbers over what is ordinary for them, the largest.
double over_ordinary(const model::ActiveEffect& active, const model::Vehicle& vehicle) {
  double largest = 0.0;
  const auto sizes = static_cast<std::size_t>(std::max(active.effect->amplitudes(), 1));
  for (std::size_t i = 0; i < sizes; ++i) {
    if (!active.effect->takes_part(active.variant, i)) continue;
    largest = std::max(
        largest, std::abs(active.theta[i]) / model::parameter_of(*active.effect, active.variant, i, vehicle).sigma);
  }
  return largest;
}

/// Asks as a diagnosis will: the evidence of a model with the effect beside that of the base model, and the effect's
/// size.
class Judge {
 public:
  Judge(const model::Vehicle& vehicle, const View& view, const std::vector<inference::Law>& laws,
        const inference::Settings& settings)
      : vehicle_{vehicle},
        view_{view},
        laws_{laws},
        thresholds_{settings.thresholds},
        problem_{likelihood::make_problem(vehicle, view.trials(), settings.runs)} {
    likelihood::Fit base{.hypothesis = likelihood::nominal_hypothesis(problem_),
                         .noise = likelihood::prior_noise(problem_)};
    base.numbers = problem_.numbers(base.hypothesis);
    seen_ = inference::see(problem_, std::move(base), settings.threads);
  }

  /// The factor on `suspect.change` at which it would be named.
  [[nodiscard]] double factor(const Suspect& suspect) const {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    const Eigen::VectorXd own = suspect.change - view_.jacobian() * suspect.imitated;
    const double gain = 0.5 * own.squaredNorm();  // nats of likelihood, at factor 1
    const double size = inference::size_beside(problem_, seen_, suspect.active);
    if (!(gain > kNoEnergy)) return kNever;
    const double ordinary = over_ordinary(suspect.active, vehicle_);
    const auto named = [&](double factor) {
      return odds(suspect.active, gain, ordinary, factor) >= thresholds_.name_odds;
    };
    double low = -12.0, high = 12.0;  // natural logarithm
    if (!named(std::exp(high))) return kNever;
    while (high - low > 0.01) {
      const double middle = 0.5 * (low + high);
      (named(std::exp(middle)) ? high : low) = middle;
    }
    return std::max(std::exp(high), thresholds_.smallest_size / std::max(size, 1e-12));
  }

 private:
  /// Nats over the base model: Laplace's evidence, a change in proportion to the effect, and the prior of the set.
  /// Each number is taken to be known as well as the effect's size is: `ordinary`, at factor 1, in units of its prior.
  [[nodiscard]] double odds(const model::ActiveEffect& active, double gain, double ordinary, double factor) const {
    const likelihood::Number plain{.freedom = likelihood::kEffectFreedom};
    const double information = 2.0 * gain / std::max(ordinary * ordinary, 1e-300),
                 x = factor * ordinary;  // both in units of the prior
    const double price = 0.5 * std::log(information + likelihood::prior_weight(plain, x)) -
                         likelihood::log_prior(plain, x) - 0.5 * std::log(2.0 * std::numbers::pi);
    return factor * factor * gain - active.effect->numbers(active.variant) * price +
           inference::log_prior_of_set({active}, laws_) - inference::log_prior_of_set({}, laws_);
  }

  const model::Vehicle& vehicle_;
  const View& view_;
  const std::vector<inference::Law>& laws_;
  inference::Thresholds thresholds_;
  likelihood::Problem problem_;
  inference::Seen seen_;
};

/// Moves what the effect is proportional to by `step`, natural logarithm, or by as much of it as physical limits leave;
/// 0 where they leave nothing. Returns what was moved.
double move(model::ActiveEffect& active, double step) {
  for (; std::abs(step) > 0.2 * kClose; step *= 0.5) {
    model::ActiveEffect moved = active;
    if (!grow(moved, std::exp(step))) continue;
    active = std::move(moved);
    return step;
  }
  return 0.0;
}

/// Half of it does as much: a lag shorter than the steps of time acts as if it were as long.
bool blurred(const View& view, const Suspect& suspect) {
  model::ActiveEffect half = suspect.active;
  return grow(half, 0.5) && view.change(half).norm() > kNoSmaller * suspect.change.norm();
}

/// The smallest size of this form from this start: by proportion, and where an effect is not proportional (a delay
/// that the clocks of the commands leave open is none) by halves between what is named and what is not.
Suspect smallest(const View& view, const Base& base, const Judge& judge, const inference::Law& law,
                 const std::vector<double>& start) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Suspect suspect{.active = law.seed};
  suspect.active.theta = start;
  model::ActiveEffect named;                                         // the smallest one
  double at = 0.0, not_named_at = -kInfinity, named_at = kInfinity;  // natural logarithm, over the start
  for (int round = 0; round < kRounds; ++round) {
    suspect.change = view.change(suspect.active);
    suspect.imitated = base.solve(view.jacobian().transpose() * suspect.change);
    double factor = judge.factor(suspect);
    if (!std::isfinite(factor) || !suspect.change.allFinite()) return suspect;
    if (factor < 1.0 + kClose && blurred(view, suspect)) factor = 2.0;  // nothing is promised of such sizes
    suspect.found = std::abs(factor - 1.0) < kClose;
    if (factor < 1.0) {
      named_at = at;
      named = suspect.active;
    } else {
      not_named_at = at;
    }
    if (!suspect.found && named_at - not_named_at < kClose) {
      suspect.active = named;
      suspect.found = true;
    }
    if (suspect.found) break;
    const bool between = std::isfinite(not_named_at) && std::isfinite(named_at);
    const double moved = move(suspect.active, between ? 0.5 * (not_named_at + named_at) - at
                                                      : std::clamp(std::log(factor), -kLargestStep, kLargestStep));
    if (moved == 0.0) return suspect;
    at += moved;
  }
  if (suspect.found) suspect.ordinary = over_ordinary(suspect.active, *view.model().vehicle);
  return suspect;
}

/// The middle one of the starts: where, when and how fast are not known beforehand.
Suspect typical(const View& view, const Base& base, const Judge& judge, const inference::Law& law) {
  const std::size_t stride = (law.grid.size() + kMostStarts - 1) / kMostStarts;
  std::vector<Suspect> all;
  for (std::size_t i = 0; i < law.grid.size(); i += stride)
    all.push_back(smallest(view, base, judge, law, law.grid[i]));
  std::ranges::stable_sort(all, {}, &Suspect::ordinary);
  return std::move(all[all.size() / 2]);
}

model::Scene scene_for(const model::Vehicle& vehicle, const View& view) {
  model::Scene scene = model::scene_of(vehicle, view.trials());
  const double force = 0.05 * std::max(scene.tau_rms.head<3>().norm(), 1e-2);
  scene.tones_horizontal = {{.omega = kWave, .cosine = {force, 0.0, 0.0}, .sine = {0.0, force, 0.0}}};
  scene.tones_vertical = {{.omega = kWave, .cosine = {0.0, 0.0, force}}};
  return scene;
}

void say_corruption(const View& view, const Suspect& suspect, Foreseen& out) {
  const identification::ParameterMap map{view.model()};
  const Eigen::VectorXd x = map.pack(view.model());
  for (std::size_t i = 0; i < map.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (x[k] == 0.0) continue;
    const double share = suspect.imitated[k] / x[k];
    if (std::abs(share) <= std::abs(out.corruption)) continue;
    out.corrupted = map[i].name;
    out.corruption = share;
  }
}

}  // namespace

std::vector<Foreseen> foresee(const model::Vehicle& vehicle, const View& excitation, std::span<const Extra> extras,
                              const inference::Settings& settings, const Progress& progress) {
  const std::vector<inference::Law> laws = inference::catalogue(scene_for(vehicle, excitation), settings.without);
  const View* alone = &excitation;
  const Base base{excitation.model(), std::span{&alone, 1}};
  const Judge judge{vehicle, excitation, laws, settings};
  std::vector<Suspect> forms(laws.size());
  constexpr const char* kEffects = "effects";
  progress.expect(kEffects, static_cast<double>(laws.size()));
  progress.begin(kEffects, "asking every effect");
  for_each_index(laws.size(), settings.threads, [&](std::size_t i) {
    forms[i] = typical(excitation, base, judge, laws[i]);
    progress.done(kEffects);
  });

  // Of each effect one form stands for all: of things that can act at once the one that is easiest to find, of laws of
  // one thing the plainest that is found, which comes first.
  std::vector<Foreseen> foreseen;
  std::vector<Suspect> chosen;
  for (const model::Effect* effect : model::all_effects()) {
    const Suspect* easiest = nullptr;
    Foreseen out{.name = std::string{effect->name()}, .form = ""};
    for (const Suspect& form : forms) {
      if (form.active.effect != effect) continue;
      ++out.forms;
      out.forms_found += form.found ? 1 : 0;
      const bool easier = easiest != nullptr && form.ordinary < easiest->ordinary;
      if (easiest == nullptr || (easier && (effect->variants_matter() || !easiest->found))) easiest = &form;
    }
    if (easiest == nullptr) continue;
    out.form = easiest->active.variant_name;
    out.found = easiest->found;
    foreseen.push_back(out);
    chosen.push_back(*easiest);
  }
  const Energies energies{excitation, extras, chosen};
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    Foreseen& out = foreseen[i];
    const Suspect& suspect = chosen[i];
    if (!out.found) continue;
    const auto parameters = suspect.active.effect->parameters();
    for (std::size_t p = 0; p < parameters.size(); ++p) {
      if (!suspect.active.effect->is_told(suspect.active.variant, p)) continue;
      out.size.push_back({.name = std::string{parameters[p].name},
                          .value = suspect.active.theta[p],
                          .unit = std::string{suspect.active.effect->unit(suspect.active.variant, p)}});
    }
    const double whole = suspect.change.squaredNorm(), own = energies.product(i, i, 0);
    out.hidden = whole > 0.0 ? std::clamp(1.0 - own / whole, 0.0, 1.0) : 0.0;
    say_corruption(excitation, suspect, out);
    out.soonest = energies.as_strong(i);
    for (std::size_t j = 0; j < chosen.size(); ++j) {
      if (j == i || !chosen[j].found) continue;
      const double apart = energies.beside(i, j, 0);
      if (apart >= kToldApart) continue;
      out.like.push_back({foreseen[j].name, energies.tells_apart(i, j)});
    }
  }
  return foreseen;
}

}  // namespace fathom::planning
