#include "common/verdict/by_likelihood.hpp"

#include <algorithm>
#include <set>

#include "common/learning/steps.hpp"
#include "common/learning/wording.hpp"
#include "common/likelihood/between_runs.hpp"
#include "common/preflight/applicability.hpp"
#include "common/verdict/covariance.hpp"
#include "common/verdict/followed_axes.hpp"
#include "common/verdict/judged.hpp"
#include "common/verdict/lists.hpp"
#include "common/verdict/next_motion.hpp"
#include "common/verdict/why_no_model.hpp"

namespace fathom::verdict {
namespace {

using inference::Conclusion;
using inference::Verdict;

constexpr std::string_view kNotSurely = "on runs that no fit has seen it does not surely lower the error";

std::vector<std::string> names_of(std::span<const Trial> trials) {
  std::vector<std::string> names;
  for (std::size_t r = 0; r < trials.size(); ++r) {
    if (r == 0 || !same_run(trials[r - 1], trials[r])) names.push_back(trials[r].name);
  }
  return names;
}

/// Where the reported numbers are not the likelihood's own, what they differ by is an error of the model that no noise
/// tells of: it enters their deviations.
Eigen::VectorXd with_difference(const likelihood::Fit& of, const likelihood::Fit& reported, Eigen::VectorXd sigma) {
  if (sigma.size() != static_cast<Eigen::Index>(of.numbers.size()) || reported.numbers.size() != of.numbers.size())
    return sigma;
  return (sigma.array().square() +
          (values(reported.hypothesis, reported.numbers) - values(of.hypothesis, of.numbers)).array().square())
      .sqrt();
}

/// Surge, sway and heave as they are scored.
double scored_velocities(const likelihood::Problem& problem) {
  double count = 0.0;
  for (const likelihood::RunData& run : problem.runs) {
    for (const likelihood::Block& block : run.blocks()) {
      for (int i = 0; i < problem.simulated && block.scored; ++i) {
        const int axis = problem.axes[static_cast<std::size_t>(i)];
        count += axis < 3 && block.n[axis] > 0.0 ? 1.0 : 0.0;
      }
    }
  }
  return count;
}

/// One diagnosis, step by step: what is concluded, what is learned beside it, what of that is told and judged.
class Diagnosing {
 public:
  Diagnosing(const model::Vehicle& vehicle, std::span<const Trial> train, std::span<const Trial> validate,
             const inference::Settings& settings, const learning::Settings& learning, const Progress& progress)
      : vehicle_{vehicle},
        train_{train},
        settings_{settings},
        learning_{learning},
        progress_{progress},
        judges_{vehicle, train, validate} {
    answer_.candidates = model::candidates_of(vehicle, train);
    settings_.candidates = answer_.candidates.pointers();
    answer_.given.core = "likelihood";
    result().vehicle = vehicle.name;
    result().train = names_of(train);
    result().validate = names_of(validate);
    result().improvement = {kNotAsked, kNotAsked, kNotAsked};
  }

  Answer run() {
    conclude();
    learn();
    choose();
    judge();
    list();
    return std::move(answer_);
  }

 private:
  DiagnosisResult& result() { return answer_.report.result; }

  void conclude() {
    if (learning_.learn) learning::announce(progress_, learning_.limits, learning_.leaving);
    conclusion_ = inference::infer(vehicle_, train_, settings_, progress_);
    problem_ = likelihood::make_problem(vehicle_, train_, settings_.runs);
    if (conclusion_.verdict == Verdict::no_model && conclusion_.reported.finite) {
      conclusion_.skilled = skilled_axes(vehicle_, train_, judges_.unseen, judges_.input_step, conclusion_);
      conclusion_.reasons.clear();
      inference::conclude(problem_, settings_.thresholds, conclusion_);
    }
    if (conclusion_.reported.finite && !conclusion_.found.best.names.empty())
      names_help_ = held_back(judges_, conclusion_);
    if (names_claim(conclusion_.verdict) && names_help_.high < 0.0 &&
        names_help_.value < -settings_.thresholds.misled) {
      conclusion_.reasons.push_back(
          {inference::Cause::kNamesMislead, names_help_.value, -settings_.thresholds.misled, ""});
      conclusion_.verdict = Verdict::unexplained;
    }
    wiring_sought_ = conclusion_.verdict == Verdict::unexplained || conclusion_.verdict == Verdict::no_model;
    if (wiring_sought_) seek_wiring(vehicle_, train_, result(), conclusion_);
  }

  void learn() {
    // A model that does not follow its thrust may be opposed by a force that nothing lists; an exchanged thruster is
    // none.
    const bool opposed = conclusion_.verdict == Verdict::no_model && conclusion_.reported.finite && !result().wiring;
    if (learning_.learn && (conclusion_.verdict == Verdict::unexplained || opposed)) {
      learned_ = learning::learn(problem_, train_, conclusion_, learning_, judges_.here, settings_.threads, progress_);
      result().correction = learned_.given;
    }
    learning::call_off(progress_);
  }

  /// The model that is told. Stand-ins stay where they help.
  void choose() {
    tell(force_for(learned_, judges_));
    if (force_ != nullptr && conclusion_.reported.finite && !judges_.here) refuse_what_harms();
  }

  void tell(const model::LearnedForce* force) {
    force_ = force;
    with_names_ = force != nullptr || names_stay();
    named_ = force != nullptr ? &learned_.fit : &conclusion_.reported;
    best_ = with_names_ ? named_ : &conclusion_.reported_base;
  }

  bool names_stay() const { return names_claim(conclusion_.verdict) || helps(names_help_); }

  /// No model is told that errs more, on runs that judge, than the one without what was learned: by more than chance.
  /// Where axes do not follow their thrust a force may only oppose it, and must surely lower the error.
  void refuse_what_harms() {
    const likelihood::Fit& without = names_stay() ? conclusion_.reported : conclusion_.reported_base;
    const Interval gain = gain_of(judges_, likelihood::model_of(without.hypothesis, judges_.input_step),
                                  learning::as_model(learned_.fit.hypothesis, judges_.input_step, force_));
    if (1.0 - gain.value > learning_.limits.judged) {
      refuse(learning::too_little("error on runs that judge, over the model's without it", 1.0 - gain.value, "at most",
                                  learning_.limits.judged));
    } else if (conclusion_.verdict == Verdict::no_model && !(gain.low > 0.0)) {
      refuse(std::string{kNotSurely});
    } else {
      return;
    }
    tell(nullptr);
  }

  void refuse(const std::string& why) {
    CorrectionGiven& correction = *result().correction;
    correction.adopted = correction.carried = correction.goes_on = false;
    correction.refused = why;
  }

  void judge() {
    if (conclusion_.reported.finite) {
      const auto reasons = conclusion_.reasons;
      const Verdict verdict = conclusion_.verdict;
      predict();
      if (force_ != nullptr && conclusion_.verdict == Verdict::no_model && !(result().improvement.low > 0.0)) {
        refuse(std::string{kNotSurely});
        conclusion_.reasons = reasons;
        conclusion_.verdict = verdict;
        tell(nullptr);
        predict();
      }
      if (force_ != nullptr) tell_of_spread(judges_, problem_, learned_, *force_, *result().correction);
    }
    if (conclusion_.verdict == Verdict::no_model) say_why_no_model();
    begins_later();
    answer_.verdict = conclusion_.verdict;
    result().verdict = word(conclusion_.verdict);
    result().paragraph = paragraph(conclusion_);
    if (conclusion_.verdict == Verdict::unexplained) result().paragraph += what_swings(result().residual_after);
    for (const inference::Reason& reason : conclusion_.reasons)
      answer_.given.causes.push_back({std::string(word(reason.cause)), reason.value, reason.threshold, reason.of});
  }

  void predict() {
    judge_predictions(judges_, likelihood::model_of(conclusion_.reported_base.hypothesis, judges_.input_step),
                      learning::as_model(best_->hypothesis, judges_.input_step, force_), answer_.report, answer_.given,
                      conclusion_);
  }

  void say_why_no_model() {
    if (!wiring_sought_) seek_wiring(vehicle_, train_, result(), conclusion_);
    seek_reason(vehicle_, train_, settings_.thresholds, conclusion_);
    // What the force does on such an axis is known, of its numbers and of its thrust nothing is.
    if (force_ != nullptr)
      conclusion_.reasons.push_back(
          {inference::Cause::kFreeForce, result().correction->log_odds, learning_.limits.odds, std::string{kLearned}});
  }

  /// What begins where no fit could see it is something that nothing here explains.
  void begins_later() {
    const auto& event = answer_.report.unseen_event;
    if (!event || conclusion_.verdict == Verdict::no_model) return;
    conclusion_.reasons.push_back({inference::Cause::kBeginsUnseen, event->t, 0.0, event->run});
    if (conclusion_.verdict == Verdict::adequate) conclusion_.verdict = Verdict::unexplained;
  }

  /// Of the one-step likelihood, whose information is that of independent innovations, of what differs between runs,
  /// and of what the reported numbers differ from it.
  Eigen::VectorXd deviations(const likelihood::Fit& fit, const likelihood::Fit& reported) const {
    if (!fit.finite) return {};
    return with_difference(
        fit, reported,
        after_the_commands_clock(problem_, fit, likelihood::between_runs(problem_, fit, settings_.threads).sigma));
  }

  /// Whether an axis is left of which numbers are told.
  bool told(const std::set<int>& withheld) const {
    for (int axis = 0; axis < 6; ++axis) {
      if (conclusion_.reported.finite && vehicle_.dof[static_cast<std::size_t>(axis)] && !withheld.contains(axis))
        return true;
    }
    return false;
  }

  void list() {
    const Eigen::VectorXd of_base = deviations(conclusion_.found.base.fit, conclusion_.reported_base),
                          of_named =
                              force_ != nullptr ? named_->sigma() : deviations(conclusion_.found.best.fit, *named_);
    const std::set<int> withheld = withheld_axes(conclusion_);
    list_effects(conclusion_, *named_, of_named, with_names_ && told(withheld), result());
    list_refused(conclusion_.found, result(), answer_.given);
    for (const std::string& name : settings_.without)
      result().candidates.push_back({.name = name, .log_odds = kNotAsked, .reason = "taken out of the list"});
    const model::Scene scene = model::scene_of(vehicle_, train_);
    list_not_asked(scene, result());
    for (const model::Candidates::Idle& idle : answer_.candidates.idle)
      result().candidates.push_back({.name = idle.name, .log_odds = kNotAsked, .reason = idle.reason});
    result().not_measured = preflight::not_measured(scene);
    result().manoeuvre = next_motion(result());
    answer_.score = conclusion_.found.best.score;
    answer_.velocities = scored_velocities(problem_);
    answer_.best = *best_;
    answer_.best_sigma = with_names_ ? of_named : of_base;
    answer_.rivals = names_claim(conclusion_.verdict) ? rivals_in(conclusion_, *named_) : std::nullopt;
    if (!told(withheld)) return;
    put_covariance(*best_, answer_.best_sigma, answer_.given, withheld);
    result().parameters_before = numbers_of(conclusion_.reported_base, of_base, withheld);
    result().parameters_after = numbers_of(*best_, answer_.best_sigma, withheld);
  }

  const model::Vehicle& vehicle_;
  std::span<const Trial> train_;
  inference::Settings settings_;
  const learning::Settings& learning_;
  const Progress& progress_;
  Judges judges_;
  likelihood::Problem problem_;
  Conclusion conclusion_;
  learning::Learned learned_;
  Answer answer_;
  const model::LearnedForce* force_{};  ///< what is told of it to runs that judge
  const likelihood::Fit *named_{}, *best_{};
  Interval names_help_{kNotAsked, kNotAsked, kNotAsked};  // on runs that judge
  bool wiring_sought_{}, with_names_{};
};

}  // namespace

Answer diagnose(const model::Vehicle& vehicle, std::span<const Trial> train, std::span<const Trial> validate,
                const inference::Settings& settings, const Progress& progress, const learning::Settings& learning) {
  return Diagnosing{vehicle, train, validate, settings, learning, progress}.run();
}

}  // namespace fathom::verdict
