#include "common/consistency/merged.hpp"

#include <algorithm>
#include <cmath>

#include "common/estimation/corrections_file.hpp"

namespace fathom::consistency {
namespace {

constexpr std::size_t kNamed = 3;  // parts that a finding names; the others are counted

bool is_count(const std::string& unit) { return unit == "samples" || unit == "windows"; }

/// A quantity over several checks, each of which is one measurement of it.
Statement mean_of(const std::vector<Statement>& all) {
  Statement mean = all.front();
  std::vector<double> values, sigmas;
  const auto any = [&](Answer answer) {
    return std::ranges::any_of(all, [&](const Statement& one) { return one.answer == answer; });
  };
  // A part that shows nothing, for the motion was not there, takes nothing from one that does.
  mean.answer = any(Answer::kDisagree) ? Answer::kDisagree : any(Answer::kAgree) ? Answer::kAgree : Answer::kCannotTell;
  for (const Statement& one : all) {
    mean.seen = std::min(mean.seen, one.seen);
    if (mean.quantity == "axis" && one.answer == mean.answer) mean.value = one.value;
    if (!std::isfinite(one.sigma) || !(one.sigma > 0.0)) continue;
    values.push_back(one.value);
    sigmas.push_back(one.sigma);
  }
  if (mean.quantity == "axis" || values.empty()) return mean;
  const Pooled pooled = pool(values, sigmas);
  mean.value = pooled.value;
  mean.sigma = pooled.sigma;
  return mean;
}

}  // namespace

void Merged::take_findings(const std::vector<ConsistencyFinding>& findings, std::span<const CheckedPart> parts) {
  for (const ConsistencyFinding& finding : findings) {
    const auto part = std::ranges::find(parts, finding.run, &CheckedPart::name);
    const std::string run = part == parts.end() ? finding.run : runs_[part->run];
    const Key key{run, finding.signal, finding.reference, finding.finding};
    Seen& seen = seen_[key];
    if (seen.parts++ == 0) {
      order_.push_back(key);
      seen.first = finding;
      seen.first.run = run;
    }
    if (seen.names.size() < kNamed) seen.names.push_back(part != parts.end() ? part->name : parts.front().name);
    seen.sizes.push_back(finding.size);
    seen.stds.push_back(finding.std);
  }
}

void Merged::take_statements(const ConsistencyResult& result) {
  for (const auto& [name, pair] : result.pairs) {
    auto& quantities = statements_[name];
    for (const Statement& statement : pair.statements) {
      const auto same = std::ranges::find_if(quantities, [&](const std::vector<Statement>& all) {
        return all.front().signal == statement.signal && all.front().reference == statement.reference &&
               all.front().quantity == statement.quantity;
      });
      if (same != quantities.end()) {
        same->push_back(statement);
      } else {
        quantities.push_back({statement});
      }
    }
  }
  if (result.distance.count > 0) {
    distances_.push_back(result.distance);
    distance_limits_.push_back(result.distance_limit);
  }
}

void Merged::add(ConsistencyResult result, std::span<const CheckedPart> parts) {
  corrections_.resize(runs_.size());
  for (std::size_t i = 0; i < parts.size(); ++i) corrections_[parts[i].run].push_back(result.corrections[i]);
  take_findings(result.findings, parts);
  take_statements(result);
  if (checks_++ == 0) only_ = std::move(result);
}

ConsistencyResult Merged::result() && {
  if (checks_ <= 1) return std::move(only_);
  ConsistencyResult result;
  for (const std::vector<Corrections>& one : corrections_)
    result.corrections.push_back(one.empty() ? Corrections{} : estimation::most_shared(one).corrections);
  for (const Key& key : order_) {
    Seen& seen = seen_.at(key);
    ConsistencyFinding& all = seen.first;
    const auto [least, greatest] = std::ranges::minmax(seen.sizes);
    const bool measured = std::ranges::all_of(seen.stds, [](double std) { return std > 0.0; });
    if (measured) {
      const Pooled pooled = pool(seen.sizes, seen.stds);
      all.size = pooled.value;
      all.std = pooled.sigma;
    } else if (is_count(all.unit)) {
      all.size = 0.0;
      for (const double size : seen.sizes) all.size += size;
    } else {
      all.size = *std::ranges::max_element(seen.sizes, {}, [](double size) { return std::abs(size); });
    }
    std::string where = seen.names.front();
    for (std::size_t i = 1; i < seen.names.size(); ++i) where += ", " + seen.names[i];
    if (seen.parts > seen.names.size()) where += ", ...";
    all.evidence = "in " + std::to_string(seen.parts) + " of " + std::to_string(checks_) + " parts (" + where + ")" +
                   (seen.parts > 1 ? text(": %.4g to %.4g ", least, greatest) + all.unit : std::string()) +
                   "; in the first of them: " + all.evidence;
    result.findings.push_back(std::move(all));
  }
  for (const auto& [name, quantities] : statements_) {
    PairResult& pair = result.pairs[name];
    pair.checked = !quantities.empty();
    for (const std::vector<Statement>& all : quantities) pair.statements.push_back(mean_of(all));
  }
  if (!distances_.empty()) {
    std::vector<double> values, sigmas;
    for (const Pooled& one : distances_) {
      values.push_back(one.value);
      sigmas.push_back(one.sigma);
    }
    result.distance = pool(values, sigmas);
    result.distance_limit = std::ranges::max(distance_limits_);
  }
  return result;
}

}  // namespace fathom::consistency
