#include "common/consistency/conventions/selection.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace fathom::consistency {
namespace {

constexpr SelectionThresholds kThresholds{};

struct Candidate {
  const Hypothesis *first{}, *second{};  ///< second: only where two are tried at once
  Reading reading;
  Judged judged;
  double penalty{};
  [[nodiscard]] double posterior() const { return judged.total() - penalty; }
};

/// Whether some relation is explained at least twice as well, and none a good deal worse.
bool matters(const Judged& before, const Judged& after) {
  bool better = false;
  for (std::size_t r = 0; r < kRelations; ++r) {
    if (!before.seen[r] || !after.seen[r]) continue;
    better = better || after.unexplained[r] < kThresholds.halves * before.unexplained[r];
    if (after.unexplained[r] > before.unexplained[r] / kThresholds.halves && after.unexplained[r] > kThresholds.well)
      return false;
  }
  // A vehicle that was keel up, and is not any more, is better read too.
  return better || (before.upside_down && !after.upside_down);
}

/// Worst explained of travel and turning.
double worst(const Judged& judged) {
  double most = 0.0;
  for (const Relation r : {kTravel, kTurning}) {
    if (judged.seen[r]) most = std::max(most, judged.unexplained[r]);
  }
  return most;
}

/// What a heading alone cannot have been: four numbers in another order, or axes that lay the craft on its side.
bool tilts(const Reading& change) {
  using estimation::QuaternionForm;
  return (change.quaternion != QuaternionForm::kAsRead && change.quaternion != QuaternionForm::kInverse) ||
         change.attitude_world(2, 2) * change.attitude_axes(2, 2) < 0.5;
}

std::optional<Candidate> made(const Evidence& evidence, const Reading& base, const Hypothesis& hypothesis) {
  if (evidence.heading_alone() && tilts(hypothesis.change)) return std::nullopt;
  Candidate one{.first = &hypothesis};
  if (!compose(base, hypothesis.change, one.reading)) return std::nullopt;
  one.judged = evidence.judge(one.reading);
  one.penalty = penalty(hypothesis.kind);
  const bool turned = hypothesis.kind == Kind::kTurn || hypothesis.kind == Kind::kReflection;
  if (turned && !hypothesis.change.attitude_axes.isIdentity()) one.penalty += PriorPenalties{}.body_axes;
  if (one.reading.free_heading && !base.free_heading && std::abs(one.judged.heading) < kThresholds.heading)
    return std::nullopt;
  return one;
}

}  // namespace

Selection select_reading(const Evidence& evidence) {
  Selection selection;
  if (!evidence.speaks()) return selection;
  Judged now = evidence.judge(selection.reading);
  while (static_cast<int>(selection.causes.size()) < kThresholds.causes) {
    const double more = selection.causes.empty() ? 0.0 : PriorPenalties{}.second;
    std::vector<Candidate> candidates;
    for (const Hypothesis& hypothesis : hypotheses()) {
      if (auto one = made(evidence, selection.reading, hypothesis)) candidates.push_back(std::move(*one));
    }
    const auto likelier = [](const Candidate& a, const Candidate& b) { return a.posterior() < b.posterior(); };
    auto best = std::ranges::max_element(candidates, likelier);
    if (best == candidates.end()) break;
    // Where no single cause explains the motion, two named ones at once may.
    std::vector<Candidate> pairs;
    if (worst(now) > kThresholds.well && worst(best->judged) > kThresholds.well) {
      const auto named = [](const Candidate& one) { return one.first->kind == Kind::kNamed; };
      for (const Candidate& one : candidates) {
        if (!named(one)) continue;
        for (const Candidate& two : candidates) {
          if (!named(two) || two.first <= one.first) continue;
          Candidate both{.first = one.first, .second = two.first};
          if (!compose(one.reading, two.first->change, both.reading)) continue;
          both.judged = evidence.judge(both.reading);
          both.penalty = one.penalty + two.penalty + PriorPenalties{}.second;
          pairs.push_back(std::move(both));
        }
      }
      const auto pair = std::ranges::max_element(pairs, likelier);
      if (pair != pairs.end() && pair->posterior() > best->posterior() + kThresholds.gain) best = pair;
    }
    const Advantage against = compare(best->judged, now);
    if (against.gain - best->penalty - more < kThresholds.gain || against.z < kThresholds.z ||
        !matters(now, best->judged))
      break;
    Cause cause{.hypothesis = best->first,
                .gain = against.gain,
                .z = against.z,
                .heading = best->judged.heading,
                .before = now.unexplained,
                .after = best->judged.unexplained,
                .seen = best->judged.seen};
    for (const Candidate& other : candidates) {
      if (&other == &*best || best->second != nullptr) continue;
      if (best->penalty + PriorPenalties{}.turn < other.penalty) continue;
      const Advantage rival = compare(best->judged, other.judged);
      const bool tied =
          rival.gain < kThresholds.gain || (rival.z < kThresholds.tied && rival.gain < 2.0 * kThresholds.gain);
      if (tied && other.first->kind == best->first->kind) cause.instead.push_back(other.first);
    }
    selection.causes.push_back(cause);
    if (best->second != nullptr) {
      cause.hypothesis = best->second;
      selection.causes.push_back(cause);
    }
    selection.reading = best->reading;
    selection.reading.heading = best->judged.heading;
    now = std::move(best->judged);
  }
  return selection;
}

}  // namespace fathom::consistency
