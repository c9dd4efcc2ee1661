#include "common/consistency/summary.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string_view>

namespace fathom::consistency {
namespace {

constexpr double kPracticalDistance = 0.05;  // of a ratio of distances

const char* word_of(Answer answer) {
  switch (answer) {
    case Answer::kAgree:
      return "agree";
    case Answer::kDisagree:
      return "disagree";
    default:
      return "cannot tell";
  }
}

std::vector<Statement> statements_of(const ConsistencyResult& result) {
  std::vector<Statement> all;
  for (const auto& [name, pair] : result.pairs) all.insert(all.end(), pair.statements.begin(), pair.statements.end());
  if (result.distance.count > 0) {
    Statement distance{.signal = "pose_capture.position",
                       .reference = "dvl",
                       .quantity = "distance",
                       .value = result.distance.value,
                       .sigma = result.distance.sigma,
                       .neutral = 1.0,
                       .seen = result.distance_limit * result.distance.sigma,
                       .practical = kPracticalDistance};
    const bool found = std::ranges::any_of(result.findings, [](const auto& one) { return one.finding == "distance"; });
    distance.answer = found                                ? Answer::kDisagree
                      : distance.seen < distance.practical ? Answer::kAgree
                                                           : Answer::kCannotTell;
    all.push_back(distance);
  }
  return all;
}

}  // namespace

void keep_axes(ConsistencyResult& result, const std::array<bool, 6>& dof) {
  constexpr std::string_view kAxes = "uvwpqr";
  for (auto& [name, pair] : result.pairs) {
    if (name != "dvl" && name != "gyro") continue;
    std::erase_if(pair.statements, [&](const Statement& one) {
      const auto axis = one.signal.size() > 2 && one.signal[one.signal.size() - 2] == '.'
                            ? kAxes.find(one.signal.back())
                            : std::string_view::npos;
      return axis != std::string_view::npos && !dof[axis];
    });
  }
}

std::vector<std::string> table_of(const ConsistencyResult& result) {
  std::vector<std::string> lines;
  std::string silent;
  for (const Statement& one : statements_of(result)) {
    const bool measured = one.quantity == "axis" ? one.answer != Answer::kCannotTell : std::isfinite(one.sigma);
    if (!measured) {
      silent += (silent.empty() ? "" : ", ") + one.signal + " " + one.quantity;
      continue;
    }
    std::array<char, 64> mismatch{};
    if (one.quantity == "axis") {
      std::snprintf(mismatch.data(), mismatch.size(), "along itself by %.3f", one.value);
    } else {
      std::snprintf(mismatch.data(), mismatch.size(), "%.4g +- %.2g %s", one.value, one.sigma, one.unit.c_str());
    }
    std::array<char, 64> seen{};
    if (one.quantity != "axis")
      std::snprintf(seen.data(), seen.size(), "a fault of %.2g %s would have been seen", one.seen, one.unit.c_str());
    std::array<char, 256> line{};
    std::snprintf(line.data(), line.size(), "%-22s %-14s %-15s %-26s %-12s %s", one.signal.c_str(),
                  one.reference.c_str(), one.quantity.c_str(), mismatch.data(), word_of(one.answer), seen.data());
    lines.emplace_back(line.data());
  }
  if (!silent.empty()) lines.push_back("cannot tell, for the motion does not show it: " + silent);
  return lines;
}

std::string conclusion_of(const ConsistencyResult& result) {
  const std::vector<Statement> all = statements_of(result);
  const auto count = [&](Answer answer) { return std::ranges::count(all, answer, &Statement::answer); };
  const auto unknown = count(Answer::kCannotTell);
  if (!result.findings.empty()) return {};
  if (all.empty()) return "nothing can be compared: no two sensors of these recordings measure one motion";
  if (unknown == 0) return "the sensors agree with each other, in all " + std::to_string(all.size()) + " quantities";
  std::string names;
  for (const Statement& one : all) {
    if (one.answer == Answer::kCannotTell) names += (names.empty() ? "" : ", ") + one.signal + " " + one.quantity;
  }
  return "no sensor contradicts another in " + std::to_string(count(Answer::kAgree)) + " of " +
         std::to_string(all.size()) + " quantities; of the others nobody can tell (" + names + ")";
}

}  // namespace fathom::consistency
