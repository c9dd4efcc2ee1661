// How the streams of each recording were meant: conventions by likelihood (conventions/), one finding for each cause.
#include <algorithm>
#include <cmath>

#include "common/base/units.hpp"
#include "common/consistency/consistency_check.hpp"

namespace fathom::consistency {
namespace {

constexpr double kSameHeading = 5.0 * kDegree;  // runs whose large turns differ by less share one
constexpr double kContradicts = 6.0;            // nats by which a run may not be worse with what the others say

/// What of a selection a map can say: sensors' own axes are left to the comparison of pairs.
bool is_ours(const Cause& cause) { return !cause.hypothesis->of_sensor_axes; }

std::string key_of(const Selection& selection) {
  std::string key;
  for (const Cause& cause : selection.causes) {
    if (is_ours(cause)) key += cause.hypothesis->signal + ":" + cause.hypothesis->words + "\n";
  }
  return key;
}

Reading ours(const Selection& selection) {
  Reading all;
  for (const Cause& cause : selection.causes) {
    Reading both;
    if (is_ours(cause) && compose(all, cause.hypothesis->change, both)) all = both;
  }
  all.heading = selection.reading.heading;
  return all;
}

std::string fractions(const Cause& cause) {
  std::string words;
  static constexpr std::array<const char*, kRelations> kNames{
      "travel (position against velocity)", "turning (attitude against rates)",
      "gravity (attitude against accelerometer)", "depth (position against depth sensor)"};
  for (std::size_t r = 0; r < kRelations; ++r) {
    if (!cause.seen[r]) continue;
    words += (words.empty() ? "" : ", ") + std::string(kNames[r]) + " unexplained " +
             text("%.3g as read, %.3g so", cause.before[r], cause.after[r]);
  }
  return words + text("; log likelihood ratio %.0f, z %.1f", cause.gain, cause.z);
}

}  // namespace

void Check::report_cause(const std::string& run, const Cause& cause, bool disagree) {
  const Hypothesis& what = *cause.hypothesis;
  if (what.change.free_heading) return;  // find_heading says it, with the angle as measured in the end
  std::string instead;
  for (const Hypothesis* other : cause.instead)
    instead += (instead.empty() ? "; these data cannot distinguish it from: " : ", or: ") + other->words;
  const std::string signal = what.signal == "attitude"   ? reference_ + ".attitude"
                             : what.signal == "position" ? "pose_capture.position"
                             : what.signal == "pose"     ? "pose_capture"
                             : what.signal == "twist"    ? "dvl and gyro"
                                                         : what.signal;
  result_.findings.push_back(
      {.run = run,
       .signal = signal,
       .reference = cause.seen[kTurning] && cause.before[kTurning] > cause.after[kTurning]
                        ? (what.signal == "gyro" ? reference_ : "gyro")
                        : (what.signal == "dvl" ? reference_ : "dvl"),
       .finding = what.finding,
       .size = what.size,
       .unit = "",
       .evidence = what.words + ": " + fractions(cause) + instead + (disagree ? "; the runs disagree about this" : ""),
       .action = "corrected: read as meant" + (what.map.empty() ? std::string() : "; in the map: " + what.map)});
}

void Check::take(std::size_t r, const Reading& reading) {
  Corrections& one = result_.corrections[r];
  one.quaternion = reading.quaternion;
  one.heading_sense = reading.sense;
  one.attitude_world = reading.attitude_world;
  one.attitude_axes = reading.attitude_axes;
  one.position_axes = reading.position;
  one.velocity_frame = reading.velocity_frame;
  one.rates_frame = reading.rates_frame;
  if (reading.velocity_frame == estimation::VectorFrame::kWorld) one.velocity_world = reading.velocity;
  if (reading.rates_frame == estimation::VectorFrame::kWorld) one.rates_world = reading.rates;
  if (reading.free_heading) one.heading = reading.heading;
  const PoseSeries meant = pose(r);
  estimation::to_body(one.velocity_frame, one.velocity_world, meant, dvl_[r]);
  estimation::to_body(one.rates_frame, one.rates_world, meant, gyro_[r]);
}

void Check::choose_readings() {
  const std::size_t count = runs_.size();
  std::vector<Evidence> evidence;
  std::vector<Selection> selections;
  evidence.reserve(count);
  for (std::size_t r = 0; r < count; ++r) {
    evidence.emplace_back(poses_[r], dvl_[r], gyro_[r], force_[r], runs_[r].depth);
    selections.push_back(select_reading(evidence.back()));
  }
  // What most of the runs that say anything say, the others are read by too, unless they contradict it.
  std::map<std::string, std::size_t> votes;
  for (const Selection& one : selections) {
    if (const std::string key = key_of(one); !key.empty()) ++votes[key];
  }
  if (votes.empty()) return;
  const std::string common = std::ranges::max_element(votes, {}, [](const auto& vote) { return vote.second; })->first;
  const auto model = std::ranges::find_if(selections, [&](const Selection& one) { return key_of(one) == common; });
  bool disagree = false;
  std::vector<const Selection*> chosen(count);
  for (std::size_t r = 0; r < count; ++r) {
    chosen[r] = &selections[r];
    if (!key_of(selections[r]).empty()) continue;
    const Judged as_read = evidence[r].judge({}), so = evidence[r].judge(ours(*model));
    if (so.total() > as_read.total() - kContradicts) chosen[r] = &*model;
  }
  for (const Selection* one : chosen) disagree = disagree || key_of(*one) != common;
  // One angle for runs that share it: the mean of what each says.
  double sine = 0.0, cosine = 0.0;
  for (const Selection* one : chosen) sine += std::sin(ours(*one).heading), cosine += std::cos(ours(*one).heading);
  const double mean = std::atan2(sine, cosine);
  const bool one_heading = std::ranges::all_of(chosen, [&](const Selection* one) {
    return std::abs(std::remainder(ours(*one).heading - mean, 360.0 * kDegree)) < kSameHeading;
  });
  for (std::size_t r = 0; r < count; ++r) {
    Reading reading = ours(*chosen[r]);
    if (reading.free_heading && one_heading) reading.heading = mean;
    take(r, reading);
    if (disagree) {
      for (const Cause& cause : chosen[r]->causes) {
        if (is_ours(cause)) report_cause(names_[r], cause, true);
      }
    }
  }
  if (disagree) return;
  for (const Cause& cause : model->causes) {
    if (is_ours(cause)) report_cause("all", cause, false);
  }
}

}  // namespace fathom::consistency
