#include "common/report/live/live_trial.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <string>

#include "common/base/error.hpp"
#include "common/base/health_words.hpp"
#include "common/report/text.hpp"

namespace fathom::report {
namespace {

std::vector<ModeVisit> visits_of(const std::vector<Excitation>& said, Utime origin) {
  std::vector<ModeVisit> visits;
  const Excitation* before = nullptr;
  std::size_t frozen_before = 0;
  bool flown = false;  // afterwards the supervisor closes in the name of a mode that it may never have been in
  for (const Excitation& one : said) {
    const double t = seconds_between(origin, one.utime);
    flown = flown || one.mode == kSegmentMode;
    if (one.mode == kSegmentMode || (flown && one.phase == "done" && !one.mode.empty())) continue;
    const bool new_mode = !one.mode.empty() && (before == nullptr || before->mode != one.mode);
    const bool over = before != nullptr && !before->mode.empty() && before->mode != one.mode;
    if (over) {
      ModeVisit& visit = visits.back();
      visit.ended = t;
      // A mode that was left pauses its parameters.
      if (one.mode != "total" && !one.mode.empty()) visit.left = one.frozen.size() > frozen_before;
      if (visit.left) visit.missing.clear();
    }
    if (new_mode) {
      visits.push_back({.mode = one.mode, .begun = t, .ended = t, .threshold = one.threshold});
      frozen_before = one.frozen.size();
    }
    if (!one.mode.empty() && !visits.empty()) {
      ModeVisit& visit = visits.back();
      visit.ended = t;
      if (one.metric >= 0.0) {
        visit.metric = one.metric;
        visit.missing = one.missing;
      }
    }
    before = &one;
  }
  return visits;
}

/// The metric that a mode was left by came with the MODEL that settled it, and no EXCITATION of that mode tells it.
void complete_metrics(std::vector<ModeVisit>& visits, const std::vector<ModelEstimate>& models, Utime origin) {
  for (ModeVisit& visit : visits) {
    if (!visit.left) continue;
    for (const ModelEstimate& model : models) {
      const double t = seconds_between(origin, model.utime);
      if (t < visit.begun || t > visit.ended) continue;
      for (const ModeMetric& metric : model.modes) {
        if (metric.mode == visit.mode) visit.metric = metric.sum;
      }
    }
  }
}

/// The last complaint of each process. That something was not there yet, before all was well for the first time, is
/// none.
std::map<std::string, std::string> complaints_of(const std::vector<Health>& all) {
  std::map<std::string, std::string> complaints, early;
  std::set<std::string> well;
  for (const Health& health : all) {
    const bool in_lockstep = health.detail.starts_with(kWithoutConsequence);
    if (health.state == "stopped") continue;
    if (health.state == "running" && !in_lockstep) {
      well.insert(health.process);
      continue;
    }
    const std::string said =
        in_lockstep ? health.detail.substr(sizeof kWithoutConsequence - 1) : health.state + ": " + health.detail;
    (health.state == "fault" || well.contains(health.process) ? complaints : early)[health.process] = said;
  }
  for (auto& [process, said] : early) {
    if (!well.contains(process)) complaints.try_emplace(process, said);
  }
  return complaints;
}

std::vector<FlownSegment> flights_of(const std::vector<Excitation>& said, Utime origin) {
  std::vector<FlownSegment> flights;
  bool flying = false;
  for (const Excitation& one : said) {
    const double t = seconds_between(origin, one.utime);
    const bool flies = one.active && one.mode == kSegmentMode;
    if (flies && !flying) flights.push_back({.segment = one.signal, .begun = t, .ended = t});
    if (flies) flights.back().ended = t;
    flying = flies;
  }
  return flights;
}

}  // namespace

Utime trial_origin(const Recording& recording) { return recording.state.empty() ? 0 : recording.state.front().utime; }

std::string trial_title(const LiveTrialResult& result) {
  return (result.phase == "recorded" ? "Trial of " : "Live trial of ") + result.vehicle;
}

std::string estimate_words(const LiveTrialResult& result) {
  if (!result.joint_from) return "recursive estimate, from STATE";
  const std::string from = number(*result.joint_from, 3) + " s";
  if (result.joint)
    return "joint estimate, of state and parameters in one filter; until " + from + " the recursive one";
  return "recursive estimate, from STATE, with what was adopted; from " + from + " until then the joint one";
}

std::string doubt_words(const LiveTrialResult& result) {
  if (result.failing.empty()) return "";
  return "This model lacks something: its residual failed the test on " + join(result.failing, ", ") +
         ". The intervals are wider for it, and may still miss.";
}

LiveTrialResult summarise(const Recording& recording, const model::Vehicle& vehicle, const model::Site& site) {
  const auto need = [&](bool there, const char* channel, const char* who) {
    if (!there) {
      throw InputError(recording.name + ": no " + channel + " in this log; a live trial's log has it, from the " + who +
                       ", and what 'fathom smooth' writes of any other");
    }
  };
  need(!recording.state.empty(), "STATE", "estimator");
  LiveTrialResult result;
  result.vehicle = vehicle.name;
  result.site = site.name;
  const Utime origin = trial_origin(recording);
  result.seconds = seconds_between(origin, recording.state.back().utime);
  const Excitation last =
      recording.excitation.empty()
          ? Excitation{.reason = "nobody told of modes: no EXCITATION in this log", .phase = "recorded"}
          : recording.excitation.back();
  result.phase = last.phase;
  result.reason = last.reason;
  result.visits = visits_of(recording.excitation, origin);
  result.flights = flights_of(recording.excitation, origin);
  // The words of the end know better than what was said meanwhile: "done, but not settled: yaw: ...; total: ...".
  for (ModeVisit& visit : result.visits) {
    if (last.phase != "done") continue;
    visit.left = last.reason.find(" " + visit.mode + ": ") == std::string::npos;
    if (visit.left) visit.missing.clear();
  }
  complete_metrics(result.visits, recording.model, origin);
  if (recording.model.empty())
    result.reason += std::string{result.reason.empty() ? "" : "; "} + "nothing was identified: no MODEL in this log";
  const ModelEstimate model = recording.model.empty() ? ModelEstimate{} : recording.model.back();
  result.parameters = model.parameters;
  result.joint = model.joint;
  const auto first_joint = std::ranges::find_if(recording.model, &ModelEstimate::joint);
  if (first_joint != recording.model.end()) result.joint_from = seconds_between(origin, first_joint->utime);
  for (std::size_t axis = 0; axis < model::kAxisNames.size(); ++axis) {
    if (model.residual_excess[static_cast<Eigen::Index>(axis)] > 0.0)
      result.failing.emplace_back(model::kAxisNames[axis]);
  }
  result.entangled = entanglement(model.covariance);
  result.adopted = model.effects;
  result.effect_numbers = model.effect_numbers;
  for (std::size_t i = 0; i < vehicle.priors.size() && i < vehicle.parameters.size(); ++i) {
    result.expected.push_back(
        {.name = vehicle.parameters[i], .value = vehicle.priors[i].mean, .std = vehicle.priors[i].sigma, .unit = ""});
  }
  if (!recording.effects.empty()) result.ranking = recording.effects.back();
  if (!recording.learned.empty()) result.learned = recording.learned.back();
  result.complaints = complaints_of(recording.health);
  return result;
}

}  // namespace fathom::report
