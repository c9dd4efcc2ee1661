#include "common/verdict/of_recordings.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <utility>

#include "common/base/error.hpp"
#include "common/consistency/dead_axes.hpp"
#include "common/consistency/either_scale.hpp"
#include "common/consistency/flow_check.hpp"
#include "common/consistency/thruster_clock.hpp"
#include "common/estimation/reconstruct.hpp"
#include "common/estimation/shared_clock.hpp"
#include "common/estimation/split.hpp"
#include "common/estimation/wording.hpp"
#include "common/preflight/force_unit.hpp"
#include "common/preflight/implausible.hpp"
#include "common/preflight/sensor_faults.hpp"
#include "common/verdict/stretches.hpp"

namespace fathom::verdict {
namespace {

constexpr double kHeldOut = 0.3;   // of every run, when no run is given to judge by
constexpr double kShortest = 2.0;  // s between two gaps: less shows no motion
constexpr double kFitted = 10.0;   // s that some stretch to fit has at least
constexpr double kNotable = 0.05;  // of the recordings left out: the reader should know
// Of what judges: what begins later is seen for too short a time if half of it is fitted.
constexpr double kTooLate = 0.3;

constexpr std::string_view kSensors = "sensors", kReconstruction = "reconstruction";
constexpr double kLight = 0.03;  // of a fit: reconstructing a run, until it has been timed

/// True when the event begins within the first `share` of the run that it begins in.
bool begins_before(const UnseenEvent& event, std::span<const Trial> runs, double share) {
  double first = 0.0, last = 0.0;
  for (const Trial& run : runs) {
    if (run.name != event.run) continue;
    if (last == 0.0) first = run.t.front();
    last = run.t.back();
  }
  return event.t < first + share * (last - first);
}

/// One look at the recordings and what it came to.
struct Look {
  std::optional<Stretches> fitting, judging;
  std::vector<ConsistencyFinding> gaps;
  Answer answer;
};

class Work {
 public:
  Work(const model::Vehicle& vehicle, Asked asked, const RecordingsSettings& settings, const Progress& progress,
       std::vector<std::string>& notes)
      : vehicle_{vehicle},
        asked_{std::move(asked)},
        settings_{settings},
        progress_{progress},
        notes_{notes},
        divided_{asked_.fitted == asked_.recordings.size()} {
    if (asked_.called.empty()) {
      for (const Recording& recording : asked_.recordings) asked_.called.push_back(recording.name);
    }
  }

  Explained run() {
    const auto runs = static_cast<double>(asked_.recordings.size());
    progress_.expect(kSensors, 1, kLight * runs);
    progress_.expect(kReconstruction, runs, kLight);
    progress_.begin(kSensors, "comparing the sensors with each other");
    compare_sensors();
    progress_.done(kSensors);
    Look look = explain(estimation::Kept::kLast);
    if (consistency_.either_scale) look = with_the_likelier_scale(std::move(look), *consistency_.either_scale);
    if (preflight::thrust_as_late_as_gyro(look.answer.report.result, consistency_.findings)) {
      consistency::put_thrusters_on_pose_clock(consistency_);
      look = explain(estimation::Kept::kLast);
    }
    if (divided_ && look.answer.report.unseen_event) look = judged_by_other_parts(std::move(look));
    return told(std::move(look));
  }

 private:
  void compare_sensors() {
    const std::vector<ConsistencyFinding> dead = consistency::set_aside_dead_axes(asked_.recordings, vehicle_.dof);
    consistency_ = consistency::check_consistency(asked_.recordings);
    consistency_.findings.insert(consistency_.findings.begin(), dead.begin(), dead.end());
    consistency::check_thrusters(asked_.recordings, vehicle_, consistency_);
    if (settings_.site != nullptr)
      consistency::check_flow(asked_.recordings, vehicle_.mounts, *settings_.site, consistency_);
  }

  /// Complaints about a recording begin with its name; people look for the file.
  [[nodiscard]] Trial reconstruct(std::size_t i) const {
    const Recording& recording = asked_.recordings[i];
    try {
      return estimation::reconstruct(recording, consistency_.corrections[i], vehicle_);
    } catch (const InputError& error) {
      const std::string what = error.what(), name = recording.name + ": ";
      throw InputError(asked_.called[i] + ": " + (what.starts_with(name) ? what.substr(name.size()) : what));
    }
  }

  /// Of all recordings. Where they can be read again their samples are let go.
  std::vector<Trial> trials() {
    if (asked_.recordings.empty()) {
      asked_.recordings = asked_.again();
      static_cast<void>(consistency::set_aside_dead_axes(asked_.recordings, vehicle_.dof));
      if (settings_.site != nullptr) {
        consistency::ConsistencyResult found_already = consistency_;
        consistency::check_flow(asked_.recordings, vehicle_.mounts, *settings_.site, found_already);
      }
    }
    std::vector<Trial> trials;
    progress_.expect(kReconstruction, static_cast<double>(asked_.recordings.size()), kLight);
    for (std::size_t i = 0; i < asked_.recordings.size(); ++i) {
      progress_.begin(kReconstruction, "reconstructing " + asked_.recordings[i].name);
      trials.push_back(reconstruct(i));
      progress_.done(kReconstruction);
    }
    if (estimation::share_clock(asked_.recordings, trials) && !std::exchange(told_of_clock_, true))
      notes_.emplace_back("the recordings follow one another on one clock: what begins in one goes on in the next");
    if (asked_.again) asked_.recordings = {};
    return trials;
  }

  Look explain(estimation::Kept kept) {
    std::vector<Trial> all = trials(), train, validate;
    Look look{.fitting = {}, .judging = {}, .gaps = estimation::gap_findings(all), .answer = {}};
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (divided_) {
        estimation::Parts parts = estimation::split(std::exchange(all[i], {}), kHeldOut, kept);
        train.push_back(std::move(parts.fitted));
        std::ranges::move(parts.judged, std::back_inserter(validate));
      } else {
        (i < asked_.fitted ? train : validate).push_back(std::move(all[i]));
      }
    }
    look.fitting.emplace(std::move(train), asked_.called, kShortest, kFitted);
    look.judging.emplace(std::move(validate), std::span{asked_.called}.subspan(divided_ ? 0 : asked_.fitted), kShortest,
                         kShortest);
    look.answer = diagnose(vehicle_, look.fitting->trials(), look.judging->trials(), settings_.inference, progress_,
                           settings_.learning);
    return look;
  }

  /// Position or velocity log, which differ by a factor: by the evidence of the motion as the log has it, which is that
  /// of velocities `scale` times as large where the position is right. Where it tells nothing, no name is a claim.
  Look with_the_likelier_scale(Look of_log, double scale) {
    consistency::ConsistencyResult by_position = consistency_;
    consistency::put_scale_on_velocity_log(by_position);
    std::swap(consistency_, by_position);
    Look of_position = explain(estimation::Kept::kLast);
    const double log_scores = of_log.answer.score - of_log.answer.velocities * std::log(scale);
    const double odds = of_position.answer.score - log_scores;
    const bool known = std::isfinite(odds) && of_log.answer.best.finite && of_position.answer.best.finite;
    if (known && odds > settings_.inference.thresholds.name_odds) {
      consistency::say_of_scale(consistency_,
                                estimation::text("the motion decides for the position, log odds %.0f", odds));
      return of_position;
    }
    std::swap(consistency_, by_position);
    if (known && odds < -settings_.inference.thresholds.name_odds) {
      consistency::say_of_scale(consistency_,
                                estimation::text("the motion decides for the velocity log, log odds %.0f", -odds));
      return of_log;
    }
    consistency::say_of_scale(consistency_, "the motion does not tell which of the two is wrong");
    claim_nothing(of_log.answer, known ? odds : 0.0);
    return of_log;
  }

  /// Names rest on which sensor is right, and that is not known.
  void claim_nothing(Answer& answer, double odds) const {
    answer.given.causes.push_back({std::string(word(inference::Cause::kSensorsUndecided)), std::abs(odds),
                                   settings_.inference.thresholds.name_odds, "pose_capture.position or dvl"});
    if (answer.verdict != inference::Verdict::effect) return;
    answer.verdict = inference::Verdict::ambiguous;
    answer.report.result.verdict = word(answer.verdict);
    answer.report.result.paragraph +=
        " Position or velocity log is wrong by a factor, and nothing here tells which: "
        "with the other one right, other effects may be found.";
  }

  /// Something begins in what judges, so that no fit has seen it.
  Look judged_by_other_parts(Look look) {
    const UnseenEvent event = *look.answer.report.unseen_event;
    const bool early = begins_before(event, look.judging->trials(), kTooLate);
    const std::string late = estimation::text("something begins near %.0f s, too late for what is fitted", event.t);
    try {
      Look again = explain(early ? estimation::Kept::kEnds : estimation::Kept::kFirst);
      if (again.answer.report.result.effects.empty() || again.answer.report.unseen_event) return look;
      notes_.push_back(
          late + ": " +
          (early ? "the first and the last 15 % of every run judge" : "the first 30 % of every run judge") +
          " in place of the last 30 %");
      return again;
    } catch (const InputError& error) {  // of these parts alone: what the first look has found stands
      notes_.push_back(late + "; other parts cannot judge: " + error.what());
    }
    return look;
  }

  Explained told(Look look) {
    DiagnosisResult& result = look.answer.report.result;
    for (const model::Candidates::Idle& idle : look.answer.candidates.idle)
      notes_.push_back(idle.name + ": " + idle.reason);
    result.consistency = std::move(consistency_.findings);
    std::ranges::move(look.gaps, std::back_inserter(result.consistency));
    adopt_sensor_faults(look.answer);
    if (auto finding = preflight::compare_inertia(vehicle_, result.parameters_after))
      result.consistency.push_back(*std::move(finding));
    std::ranges::move(preflight::implausible_numbers(vehicle_, result.parameters_after),
                      std::back_inserter(result.consistency));
    const double left_out =
        (look.fitting->left_out() + look.judging->left_out()) / (look.fitting->whole() + look.judging->whole());
    if (left_out > kNotable) {
      result.paragraph += estimation::text(
          " %.0f %% of the recordings was left out: what drove the vehicle was not recorded there.", 100.0 * left_out);
    }
    return {std::move(look.answer), look.fitting->take()};
  }

  const model::Vehicle& vehicle_;
  Asked asked_;
  const RecordingsSettings& settings_;
  const Progress& progress_;
  std::vector<std::string>& notes_;
  bool divided_;  // every run into what is fitted and what judges
  bool told_of_clock_{false};
  consistency::ConsistencyResult consistency_;
};

std::string listed(const std::vector<EffectFound>& effects) {
  std::string text;
  for (std::size_t i = 0; i < effects.size(); ++i) text += (i > 0 ? ", " : "") + effects[i].name;
  return text;
}

}  // namespace

void adopt_sensor_faults(Answer& answer) {
  DiagnosisResult& result = answer.report.result;
  const std::vector<EffectFound> found = preflight::sensor_faults(result.consistency);
  if (found.empty()) return;
  result.paragraph = "The sensors contradict each other (" + listed(found) +
                     "); that is corrected in everything that follows. " + result.paragraph;
  for (auto effect = found.rbegin(); effect != found.rend(); ++effect) {
    std::erase_if(result.candidates, [&](const CandidateTried& c) { return c.name == effect->name; });
    result.candidates.insert(result.candidates.begin(), {effect->name, effect->variant, effect->log_odds,
                                                         "accepted: found by comparing the sensors"});
    answer.given.causes.insert(answer.given.causes.begin(),
                               {std::string(word(inference::Cause::kSensorsDisagree)), effect->log_odds,
                                inference::Thresholds{}.name_odds, effect->name});
  }
  result.effects.insert(result.effects.begin(), found.begin(), found.end());
  // A model that was not judged stays so: the sensors are told beside it.
  if (answer.verdict != inference::Verdict::adequate) return;
  answer.verdict = inference::Verdict::effect;
  result.verdict = word(answer.verdict);
}

Explained of_recordings(const model::Vehicle& vehicle, Asked asked, const RecordingsSettings& settings,
                        const Progress& progress, std::vector<std::string>& notes) {
  return Work{vehicle, std::move(asked), settings, progress, notes}.run();
}

}  // namespace fathom::verdict
