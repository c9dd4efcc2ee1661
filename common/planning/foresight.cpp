#include "common/planning/foresight.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/parallel.hpp"
#include "common/diagnosis/evidence.hpp"
#include "common/diagnosis/judgement.hpp"
#include "common/diagnosis/questions.hpp"
#include "common/identification/parameter_map.hpp"
#include "common/model/effect_size.hpp"
#include "common/planning/energies.hpp"

namespace fathom::planning {
namespace {

constexpr std::size_t kMostStarts = 5;  // of a form: places, moments, time constants
constexpr int kRounds = 10;             // of finding a size; most effects are nearly proportional
constexpr double kLargestStep = 30.0;   // factor between rounds
constexpr double kClose = 0.1;          // of the size
constexpr double kNoSmaller = 0.95;     // of the change before
constexpr double kWave = 1.5;           // rad/s: a wave that nobody has seen yet

class Judge {
 public:
  Judge(const View& view, const diagnosis::Settings& settings, int tried)
      : view_{view}, settings_{settings}, tried_{tried} {}

  /// The factor on `suspect.change` at which it would be accepted.
  [[nodiscard]] double factor(const Suspect& suspect) const {
    std::vector<double> fall;
    const Eigen::VectorXd own = suspect.change - view_.jacobian() * suspect.imitated;
    Eigen::Index row = 0;
    for (const Eigen::Index rows : view_.rows()) {
      fall.push_back(0.5 * own.segment(row, rows).squaredNorm());
      row += rows;
    }
    if (diagnosis::total(fall) < kNoEnergy) return std::numeric_limits<double>::infinity();
    double low = -12.0, high = 12.0;  // natural logarithm
    if (!accepted(suspect, fall, std::exp(high))) return std::numeric_limits<double>::infinity();
    while (high - low > 0.01) {
      const double middle = 0.5 * (low + high);
      (accepted(suspect, fall, std::exp(middle)) ? high : low) = middle;
    }
    return std::max(std::exp(high), settings_.smallest_change / view_.share_of_motion(own));
  }

 private:
  [[nodiscard]] bool accepted(const Suspect& suspect, const std::vector<double>& fall, double factor) const {
    std::vector<double> with, without;
    for (std::size_t w = 0; w < fall.size(); ++w) {
      with.push_back(0.5 * static_cast<double>(view_.rows()[w]));  // noise
      without.push_back(with.back() + factor * factor * fall[w]);
    }
    diagnosis::Judged judged{.effect = suspect.active.effect};
    judged.error_reduction = diagnosis::reduction(diagnosis::total(without), diagnosis::total(with));
    judged.log_odds =
        diagnosis::log_odds(without, with, suspect.active.effect->numbers(suspect.active.variant), tried_);
    return judged.error_reduction >= settings_.smallest_reduction &&
           judged.log_odds >= diagnosis::needed_log_odds(judged, settings_);
  }

  const View& view_;
  const diagnosis::Settings& settings_;
  int tried_;
};

/// The smallest size of this form from this start.
Suspect smallest(const View& view, const Base& base, const Judge& judge, const diagnosis::Candidate& candidate,
                 const std::vector<double>& start) {
  Suspect suspect{.active = {candidate.effect, candidate.variant, candidate.name, start}};
  model::ActiveEffect larger;
  double change = std::numeric_limits<double>::infinity();  // that the larger one makes
  for (int round = 0; round < kRounds; ++round) {
    suspect.change = view.change(suspect.active);
    suspect.imitated = base.solve(view.jacobian().transpose() * suspect.change);
    const double factor = judge.factor(suspect);
    if (!std::isfinite(factor) || !suspect.change.allFinite()) return suspect;
    suspect.found = std::abs(factor - 1.0) < kClose;
    if (suspect.found) break;
    if (factor < 1.0 && suspect.change.norm() > kNoSmaller * change) {
      // A lag shorter than the steps of time acts as if it were as long: nothing is promised below that.
      suspect.active = larger;
      suspect.found = true;
      break;
    }
    larger = suspect.active;
    change = factor < 1.0 ? suspect.change.norm() : std::numeric_limits<double>::infinity();
    if (!grow(suspect.active, std::clamp(factor, 1.0 / kLargestStep, kLargestStep))) return suspect;
  }
  if (!suspect.found) return suspect;
  suspect.ordinary = 0.0;
  const auto sizes = static_cast<std::size_t>(std::max(candidate.effect->amplitudes(), 1));
  for (std::size_t i = 0; i < sizes; ++i) {
    const double size = std::abs(suspect.active.theta[i]) /
                        model::parameter_of(*candidate.effect, candidate.variant, i, *view.model().vehicle).sigma;
    if (candidate.effect->takes_part(candidate.variant, i)) suspect.ordinary = std::max(suspect.ordinary, size);
  }
  return suspect;
}

/// The middle one of the starts: where, when and how fast are not known beforehand.
Suspect typical(const View& view, const Base& base, const Judge& judge, const diagnosis::Candidate& candidate,
                const model::Scene& scene) {
  const auto starts = candidate.effect->starts(scene, candidate.variant);
  const std::size_t stride = (starts.size() + kMostStarts - 1) / kMostStarts;
  std::vector<Suspect> all;
  for (std::size_t i = 0; i < starts.size(); i += std::max<std::size_t>(stride, 1))
    all.push_back(smallest(view, base, judge, candidate, starts[i]));
  if (all.empty()) return {.active = {candidate.effect, candidate.variant, candidate.name, {}}};
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
                              const diagnosis::Settings& settings, const Progress& progress) {
  const model::Scene scene = scene_for(vehicle, excitation);
  const std::vector<diagnosis::Candidate> candidates = diagnosis::all_candidates(scene);
  const View* alone = &excitation;
  const Base base{excitation.model(), std::span{&alone, 1}};
  const Judge judge{excitation, settings, static_cast<int>(candidates.size())};
  std::vector<Suspect> forms(candidates.size());
  constexpr const char* kEffects = "effects";
  progress.expect(kEffects, static_cast<double>(candidates.size()));
  progress.begin(kEffects, "asking every effect");
  for_each_index(candidates.size(), settings.threads, [&](std::size_t i) {
    forms[i] = typical(excitation, base, judge, candidates[i], scene);
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
