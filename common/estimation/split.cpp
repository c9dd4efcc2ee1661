#include "common/estimation/split.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "common/base/error.hpp"
#include "common/estimation/wording.hpp"
#include "common/samples/trial_part.hpp"

namespace fathom::estimation {
namespace {

/// Calls use(valid, first, end) for one stretch of equal validity after the other.
template <class Use>
void stretches(const std::vector<std::uint8_t>& valid, Use use) {
  for (std::size_t first = 0, end = 0; first < valid.size(); first = end) {
    while (end < valid.size() && valid[end] == valid[first]) ++end;
    use(valid[first] != 0, first, end);
  }
}

}  // namespace

Parts split(const Trial& trial, double held_out, Kept kept) {
  const double before = kept == Kept::kLast ? 0.0 : kept == Kept::kEnds ? 0.5 * held_out : held_out;
  const double behind = held_out - before;
  const auto n = static_cast<double>(trial.size());
  const auto from = static_cast<std::size_t>(std::lround(before * n));
  const auto to = static_cast<std::size_t>(std::lround((1.0 - behind) * n));
  if (to <= from || (before > 0.0 && from < 1) || (behind > 0.0 && to >= trial.size())) {
    throw InputError(trial.name + ": too short to hold a part out; give a validation run with --validate");
  }
  const auto named = [&](const char* which, double share) {
    return trial.name + " (" + which + " " + std::to_string(std::lround(100.0 * share)) + " %)";
  };
  const char* fitted = kept == Kept::kLast ? "first" : kept == Kept::kEnds ? "middle" : "last";
  Parts parts{part_of(trial, from, to, named(fitted, 1.0 - held_out)), {}};
  if (before > 0.0) parts.judged.push_back(part_of(trial, 0, from, named("first", before)));
  if (behind > 0.0) parts.judged.push_back(part_of(trial, to, trial.size(), named("last", behind)));
  return parts;
}

std::pair<Trial, Trial> split(const Trial& trial, double held_out) {
  Parts parts = split(trial, held_out, Kept::kLast);
  return {std::move(parts.fitted), std::move(parts.judged.front())};
}

std::vector<Trial> known_stretches(Trial trial, double shortest) {
  std::vector<Trial> known;
  if (std::ranges::all_of(trial.input_valid, [](std::uint8_t one) { return one != 0; })) {
    known.push_back(std::move(trial));
    return known;
  }
  stretches(trial.input_valid, [&](bool valid, std::size_t first, std::size_t end) {
    if (!valid || static_cast<double>(end - first - 1) * trial.dt < shortest) return;
    known.push_back(part_of(trial, first, end, trial.name));
  });
  return known;
}

InputGaps input_gaps(const Trial& trial) {
  InputGaps gaps;
  stretches(trial.input_valid, [&](bool valid, std::size_t first, std::size_t end) {
    if (valid) return;
    const double length = static_cast<double>(end - first + 1) * trial.dt;
    ++gaps.count;
    gaps.longest = std::max(gaps.longest, length);
    gaps.total += length;
  });
  return gaps;
}

std::vector<ConsistencyFinding> gap_findings(std::span<const Trial> runs) {
  std::vector<ConsistencyFinding> findings;
  for (const Trial& run : runs) {
    const InputGaps gaps = input_gaps(run);
    if (gaps.count == 0) continue;
    findings.push_back({.run = run.name,
                        .signal = "thrusters",
                        .reference = "itself",
                        .finding = "gap",
                        .size = gaps.longest,
                        .unit = "s",
                        .evidence = std::to_string(gaps.count) +
                                    text(" gaps, %.3g s in all, the longest %.3g s: what drove the vehicle "
                                         "is not known there",
                                         gaps.total, gaps.longest),
                        .action = "left out: nothing is simulated across them"});
  }
  return findings;
}

}  // namespace fathom::estimation
