#include "common/live/heard_trial.hpp"

#include <algorithm>
#include <iterator>

namespace fathom::live {
namespace {

constexpr Utime kPart = 60'000'000;  // us: a minute shows what acts (docs/decisions/197)

/// visit(stream, the same stream of the other) for each.
template <class One, class Other, class Visit>
void visit_both(One& one, Other& other, Visit visit) {
  wire::visit_streams(one, [&](const char*, auto& mine) {
    wire::visit_streams(other, [&](const char*, auto& theirs) {
      if constexpr (std::is_same_v<std::decay_t<decltype(mine)>, std::decay_t<decltype(theirs)>>) visit(mine, theirs);
    });
  });
}

void append(const Recording& part, Utime end, Recording& to) {
  visit_both(part, to, [&](const auto& heard, auto& kept) {
    std::ranges::copy_if(heard, std::back_inserter(kept), [&](const auto& sample) { return sample.utime <= end; });
  });
}

}  // namespace

Recording* HeardTrial::part_of(Utime utime) {
  const std::int64_t number = utime / kPart;
  if (!keeps(number)) return nullptr;
  Recording& part = parts_[number];
  if (1e-6 * kPart * static_cast<double>(parts_.size() - 1) <= most_) return &part;  // the first may have begun late
  first_ = parts_.begin()->first;
  every_ *= 2;
  std::erase_if(parts_, [&](const auto& one) { return !keeps(one.first); });
  return keeps(number) ? &part : nullptr;
}

bool HeardTrial::keeps(std::int64_t part) const {
  return every_ == 1 || (part >= first_ && (part - first_) % every_ == 0);
}

std::vector<Recording> HeardTrial::until(Utime end) const {
  std::vector<Recording> recordings;
  for (const auto& [number, part] : parts_) {
    if (number * kPart > end) break;
    if (recordings.empty() || every_ > 1) {
      Recording& next = recordings.emplace_back();
      next.name = "trial";
      if (every_ > 1 && number > first_)
        next.name += " from " + std::to_string((number - first_) * kPart / 1'000'000) + " s";
    }
    append(part, end, recordings.back());
  }
  for (Recording& recording : recordings) wire::put_in_order(recording);
  return recordings;
}

void HeardTrial::reset() {
  parts_.clear();
  first_ = 0;
  every_ = 1;
}

}  // namespace fathom::live
