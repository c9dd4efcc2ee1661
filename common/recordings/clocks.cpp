#include "common/recordings/clocks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

#include "common/base/time.hpp"

namespace fathom::recordings {
namespace {

constexpr std::int64_t kSameClock = 2'000'000;   // us: a delay that may be one; clocks differ by more or by nothing
constexpr std::int64_t kOneCluster = 1'000'000;  // us between the least delays of topics that share a clock
constexpr std::int64_t kWrong = 10'000'000;      // us from the middle delay: that stamp was no measurement's
constexpr std::size_t kMostDelays = std::size_t{1} << 19U;  // more than quantiles need
constexpr double kMostAbsent = 0.1;                         // of the messages may lack a measured time
constexpr std::int64_t kLongEnough = 60'000'000;            // us: below, a drift is not told from scatter
constexpr double kDriftTold = 5e-3;                         // s over the recording: below, scatter of the delays
constexpr double kWorstRate = 1e-3;                         // beyond, it is no drift of a clock

double seconds(std::int64_t us) { return 1e-6 * static_cast<double>(us); }

std::string milliseconds(std::int64_t us) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.0f ms", 1e-3 * static_cast<double>(us));
  return text.data();
}

std::int64_t quantile(std::vector<std::int64_t> values, double part) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Delays of a topic whose messages carry both times; of a very long one evenly some.
std::vector<std::int64_t> delays_of(const TopicStamps& topic) {
  std::vector<std::int64_t> delays;
  const std::size_t every = 1 + topic.stamps.size() / kMostDelays;
  std::size_t with_both = 0;
  for (const Stamp stamp : topic.stamps) {
    if (stamp.measured != kNoTime && with_both++ % every == 0) delays.push_back(stamp.log - stamp.measured);
  }
  const auto absent = static_cast<double>(topic.stamps.size() - with_both);
  if (absent > kMostAbsent * static_cast<double>(topic.stamps.size())) delays.clear();
  return delays;
}

/// log = measured + offset + rate (measured - origin)
struct Clock {
  std::int64_t least{};  ///< us, the smallest difference of any topic
  std::vector<std::size_t> topics;
  std::int64_t offset{};
  double rate{};
  std::int64_t origin{};

  [[nodiscard]] std::int64_t on_log(std::int64_t measured) const {
    return measured + offset + static_cast<std::int64_t>(std::llround(rate * static_cast<double>(measured - origin)));
  }
};

/// The earliest arrivals of the first and the last third say how the clocks run against each other.
void set_rate(Clock& clock, const std::vector<TopicStamps>& topics) {
  std::int64_t begin = kLatest, end = -kLatest;
  for (const std::size_t i : clock.topics) {
    for (const Stamp stamp : topics[i].stamps) {
      if (stamp.measured == kNoTime || std::abs(stamp.log - stamp.measured - clock.least) > kOneCluster) continue;
      begin = std::min(begin, stamp.measured);
      end = std::max(end, stamp.measured);
    }
  }
  clock.origin = begin;
  clock.offset = clock.least;
  if (end - begin < kLongEnough) return;
  std::int64_t early = kLatest, late = kLatest, early_at = 0, late_at = 0;
  for (const std::size_t i : clock.topics) {
    for (const Stamp stamp : topics[i].stamps) {
      if (stamp.measured == kNoTime) continue;
      const std::int64_t delay = stamp.log - stamp.measured;
      if (std::abs(delay - clock.least) > kOneCluster) continue;
      if (stamp.measured < begin + (end - begin) / 3 && delay < early) early = delay, early_at = stamp.measured;
      if (stamp.measured > end - (end - begin) / 3 && delay < late) late = delay, late_at = stamp.measured;
    }
  }
  if (early == kLatest || late == kLatest || late_at <= early_at) return;
  const double rate = seconds(late - early) / seconds(late_at - early_at);
  if (std::abs(rate * seconds(end - begin)) < kDriftTold || std::abs(rate) > kWorstRate) return;
  clock.rate = rate;
  clock.offset = early - static_cast<std::int64_t>(std::llround(rate * static_cast<double>(early_at - begin)));
}

}  // namespace

AlignedClocks align_clocks(const std::vector<TopicStamps>& topics) {
  AlignedClocks out;
  std::vector<Clock> clocks;
  std::vector<std::optional<std::size_t>> clock_of(topics.size());
  std::vector<bool> measured(topics.size());
  for (std::size_t i = 0; i < topics.size(); ++i) {
    const std::vector<std::int64_t> delays = delays_of(topics[i]);
    if (delays.empty()) continue;
    measured[i] = true;
    const std::int64_t median = quantile(delays, 0.5);
    if (std::abs(median) <= kSameClock) {
      if (median != 0 || quantile(delays, 0.95) != 0)
        out.notes.push_back(topics[i].topic + ": times of measurement are used; receipt is " +
                            milliseconds(quantile(delays, 0.05)) + " to " + milliseconds(quantile(delays, 0.95)) +
                            " later, " + milliseconds(median) + " in the middle");
      continue;
    }
    std::int64_t least = median;
    for (const Stamp stamp : topics[i].stamps) {
      const std::int64_t delay = stamp.log - stamp.measured;
      if (stamp.measured != kNoTime && delay > median - kOneCluster) least = std::min(least, delay);
    }
    auto found = std::find_if(clocks.begin(), clocks.end(),
                              [&](const Clock& one) { return std::abs(one.least - least) < kOneCluster; });
    if (found == clocks.end()) found = clocks.insert(clocks.end(), Clock{.least = least});
    found->least = std::min(found->least, least);
    found->topics.push_back(i);
    clock_of[i] = static_cast<std::size_t>(found - clocks.begin());
  }
  for (Clock& clock : clocks) {
    set_rate(clock, topics);
    std::string names;
    for (const std::size_t i : clock.topics) names += (names.empty() ? "" : ", ") + topics[i].topic;
    std::array<char, 160> text{};
    std::snprintf(text.data(), text.size(), ": their own clock, %.3f s behind the recording's by its earliest arrival",
                  seconds(clock.offset));
    std::string note = names + text.data();
    if (clock.rate != 0.0) {
      std::snprintf(text.data(), text.size(), ", and %.0f millionths slower", 1e6 * clock.rate);
      note += text.data();
    }
    out.notes.push_back(note);
  }
  for (std::size_t i = 0; i < topics.size(); ++i) {
    Paged<std::int64_t> times;
    std::int64_t delay = 0;  // of the message before: for the few that lack a measured time
    std::size_t wrong = 0;
    for (const Stamp stamp : topics[i].stamps) {
      std::int64_t time = stamp.log - delay;
      if (measured[i] && stamp.measured != kNoTime) {
        const std::int64_t own = clock_of[i] ? clocks[*clock_of[i]].on_log(stamp.measured) : stamp.measured;
        if (std::abs(stamp.log - own) < kWrong) {
          time = own;
          delay = stamp.log - time;
        } else {
          ++wrong;
        }
      }
      times.push_back(time);
    }
    if (wrong > 0)
      out.notes.push_back(topics[i].topic + ": " + std::to_string(wrong) +
                          " times of measurement fit nothing around them (a clock that was set?); receipt is used");
    out.times.push_back(std::move(times));
  }
  return out;
}

}  // namespace fathom::recordings
