#include "common/recordings/merge.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <set>
#include <utility>

#include "common/base/error.hpp"

namespace fathom::recordings {
namespace {

constexpr double kCoarse = 0.2, kFine = 0.02;  // s: grids of the search and of its last step
constexpr double kLeastOverlap = 20.0;         // s that both must have measured at once
constexpr double kLeastCorrelation = 0.8;      // below, the two did not see the same motion
constexpr double kAhead = 0.1;                 // by which every other shift must be worse: motion may repeat
constexpr double kPeakWidth = 3.0;             // s around the best shift that belong to its peak
constexpr Utime kDay = 978'307'200'000'000;    // us, 2001: later times are those of a clock of the day
constexpr double kGap = 1.0;                   // s: beyond, nothing is interpolated

struct Series {
  const char* name;
  std::vector<double> t, x;  ///< s, any unit
};

template <class Sample, class Value>
void add_all(Series& signal, const std::vector<Sample>& samples, Value value) {
  for (const Sample& one : samples) {
    if (const std::optional<double> x = value(one)) {
      signal.t.push_back(1e-6 * static_cast<double>(one.utime));
      signal.x.push_back(*x);
    }
  }
}

/// Magnitudes, which no mounting and no choice of axes changes.
std::vector<Series> signals_of(const Recording& recording) {
  Series turn{.name = "turn rate", .t = {}, .x = {}}, depth{.name = "depth", .t = {}, .x = {}},
      speed{.name = "speed", .t = {}, .x = {}};
  add_all(turn, recording.ahrs,
          [](const Ahrs& one) { return one.has_rates ? std::optional{one.w_WB_B.norm()} : std::nullopt; });
  const auto turned = [&](const auto& samples, auto usable) {
    for (std::size_t i = 1; i < samples.size(); ++i) {
      const double step = seconds_between(samples[i - 1].utime, samples[i].utime);
      if (!usable(samples[i - 1]) || !usable(samples[i]) || step <= 0.0 || step > kGap) continue;
      turn.t.push_back(1e-6 * static_cast<double>(samples[i].utime) - 0.5 * step);
      turn.x.push_back(samples[i - 1].q_WB.angularDistance(samples[i].q_WB) / step);
    }
  };
  if (turn.t.empty()) turned(recording.ahrs, [](const Ahrs& one) { return one.has_attitude; });
  if (turn.t.empty())
    turned(recording.pose_capture, [](const PoseCapture& one) { return one.valid && one.has_attitude; });
  add_all(depth, recording.depth, [](const Depth& one) { return std::optional{one.z}; });
  if (depth.t.empty())
    add_all(depth, recording.pose_capture, [](const PoseCapture& one) {
      return one.valid && one.has_position ? std::optional{one.p_WB.z()} : std::nullopt;
    });
  add_all(speed, recording.dvl,
          [](const Dvl& one) { return one.valid ? std::optional{one.v_WB_B.norm()} : std::nullopt; });
  if (speed.t.empty()) {
    const auto& poses = recording.pose_capture;
    for (std::size_t i = 1; i < poses.size(); ++i) {
      const double step = seconds_between(poses[i - 1].utime, poses[i].utime);
      if (!poses[i].valid || !poses[i - 1].valid || !poses[i].has_position || step <= 0.0 || step > kGap) continue;
      speed.t.push_back(1e-6 * static_cast<double>(poses[i].utime) - 0.5 * step);
      speed.x.push_back((poses[i].p_WB - poses[i - 1].p_WB).norm() / step);
    }
  }
  return {turn, depth, speed};
}

/// Means over cells of a grid from `begin` on; NaN where a gap is.
std::vector<double> gridded(const Series& signal, double begin, double end, double step) {
  std::vector<double> sum(static_cast<std::size_t>((end - begin) / step) + 1, 0.0);
  std::vector<int> count(sum.size(), 0);
  for (std::size_t i = 0; i < signal.t.size(); ++i) {
    const double cell = (signal.t[i] - begin) / step;
    if (cell < 0.0 || cell >= static_cast<double>(sum.size())) continue;
    sum[static_cast<std::size_t>(cell)] += signal.x[i];
    ++count[static_cast<std::size_t>(cell)];
  }
  std::vector<double> grid(sum.size(), std::nan(""));
  std::size_t last = grid.size();
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (count[i] == 0) continue;
    grid[i] = sum[i] / count[i];
    if (last < i && static_cast<double>(i - last) * step <= kGap) {
      for (std::size_t k = last + 1; k < i; ++k)
        grid[k] = grid[last] + (grid[i] - grid[last]) * static_cast<double>(k - last) / static_cast<double>(i - last);
    }
    last = i;
  }
  return grid;
}

/// Correlation of a[i + lag] with b[i]; NaN for too little in common.
double correlation(const std::vector<double>& a, const std::vector<double>& b, std::ptrdiff_t lag, double least) {
  double n = 0, sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0;
  const auto size_a = static_cast<std::ptrdiff_t>(a.size()), size_b = static_cast<std::ptrdiff_t>(b.size());
  for (std::ptrdiff_t i = std::max<std::ptrdiff_t>(0, -lag); i < std::min(size_b, size_a - lag); ++i) {
    const double x = a[static_cast<std::size_t>(i + lag)], y = b[static_cast<std::size_t>(i)];
    if (std::isnan(x) || std::isnan(y)) continue;
    n += 1, sa += x, sb += y, saa += x * x, sbb += y * y, sab += x * y;
  }
  if (n < least) return std::nan("");
  const double va = saa - sa * sa / n, vb = sbb - sb * sb / n;
  return va > 0.0 && vb > 0.0 ? (sab - sa * sb / n) / std::sqrt(va * vb) : std::nan("");
}

std::optional<FoundShift> shift_by(const Series& a, const Series& b) {
  if (a.t.size() < 2 || b.t.size() < 2) return std::nullopt;
  const double a0 = a.t.front(), a1 = a.t.back(), b0 = b.t.front(), b1 = b.t.back();
  const double overlap = std::min({kLeastOverlap, 0.5 * (a1 - a0), 0.5 * (b1 - b0)});
  if (overlap < 0.25 * kLeastOverlap || a1 - a0 > 1e5 || b1 - b0 > 1e5) return std::nullopt;
  std::vector<double> ga = gridded(a, a0, a1, kCoarse), gb = gridded(b, b0, b1, kCoarse);
  const auto first = -static_cast<std::ptrdiff_t>(gb.size()), end = static_cast<std::ptrdiff_t>(ga.size());
  std::vector<double> found;
  for (std::ptrdiff_t lag = first; lag < end; ++lag) found.push_back(correlation(ga, gb, lag, overlap / kCoarse));
  std::ptrdiff_t best = -1;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (!std::isnan(found[i]) && (best < 0 || found[i] > found[static_cast<std::size_t>(best)]))
      best = static_cast<std::ptrdiff_t>(i);
  }
  if (best < 0 || found[static_cast<std::size_t>(best)] < kLeastCorrelation) return std::nullopt;
  const double peak = found[static_cast<std::size_t>(best)];
  for (std::size_t i = 0; i < found.size(); ++i) {
    const double away = kCoarse * std::abs(static_cast<double>(static_cast<std::ptrdiff_t>(i) - best));
    if (away > kPeakWidth && found[i] > peak - kAhead) return std::nullopt;
  }
  // Again on a finer grid around it, and between its cells by a parabola.
  const std::ptrdiff_t middle = (best + first) * std::llround(kCoarse / kFine);
  const std::ptrdiff_t around = 2 * std::llround(kCoarse / kFine);
  ga = gridded(a, a0, a1, kFine);
  gb = gridded(b, b0, b1, kFine);
  std::vector<double> fine;
  for (std::ptrdiff_t lag = middle - around; lag <= middle + around; ++lag)
    fine.push_back(correlation(ga, gb, lag, overlap / kFine / 2));
  std::size_t top = 0;
  for (std::size_t i = 0; i < fine.size(); ++i) {
    if (std::isnan(fine[top]) || fine[i] > fine[top]) top = i;
  }
  double lag = static_cast<double>(middle - around) + static_cast<double>(top);
  if (top > 0 && top + 1 < fine.size()) {
    const double bend = fine[top - 1] - 2.0 * fine[top] + fine[top + 1];
    if (bend < 0.0) lag += std::clamp(0.5 * (fine[top - 1] - fine[top + 1]) / bend, -0.5, 0.5);
  }
  return FoundShift{
      .seconds = a0 - b0 + kFine * lag, .correlation = std::isnan(fine[top]) ? peak : fine[top], .by = a.name};
}

template <class Use>
void each_stream(Recording& recording, const Use& use) {
  use("pose_capture", recording.pose_capture);
  use("ahrs", recording.ahrs);
  use("dvl", recording.dvl);
  use("depth", recording.depth);
  use("thrusters", recording.thrusters);
  use("battery", recording.battery);
  use("usbl", recording.usbl);
  use("ranges", recording.ranges);
  use("loads", recording.loads);
  use("signals", recording.signals);
  use("tag_pose", recording.tag_pose);
  use("optical_flow", recording.optical_flow);
  use("laser_range", recording.laser_range);
}

std::pair<Utime, Utime> range_of(Recording& recording) {
  std::pair<Utime, Utime> range{std::numeric_limits<Utime>::max(), std::numeric_limits<Utime>::min()};
  each_stream(recording, [&](const char*, const auto& stream) {
    if (stream.empty()) return;
    range.first = std::min(range.first, stream.front().utime);
    range.second = std::max(range.second, stream.back().utime);
  });
  return range;
}

/// What the run has no column of that name of; the names of those that it has.
std::string add_signals(std::vector<Signal>& run, std::vector<Signal>& part) {
  std::set<std::string> known, left_out;
  for (const Signal& one : run) known.insert(one.name);
  for (Signal& one : part) {
    if (known.contains(one.name)) {
      left_out.insert(one.name);
    } else {
      run.push_back(std::move(one));
    }
  }
  std::ranges::stable_sort(run, {}, &Signal::utime);
  std::string text;
  for (const std::string& name : left_out) text += (text.empty() ? "column '" : ", column '") + name + "'";
  return text;
}

}  // namespace

void shift(Recording& recording, double seconds) {
  each_stream(recording, [&](const char*, auto& stream) {
    for (auto& one : stream) one.utime = utime_after(one.utime, seconds);
  });
}

std::optional<FoundShift> find_shift(const Recording& first, const Recording& second) {
  const std::vector<Series> a = signals_of(first), b = signals_of(second);
  std::optional<FoundShift> best;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const std::optional<FoundShift> found = shift_by(a[i], b[i]);
    if (found && (!best || found->correlation > best->correlation)) best = found;
  }
  return best;
}

Recording merge(std::vector<Recording> parts, const std::vector<std::optional<double>>& stated,
                std::vector<std::string>& notes) {
  Recording run = std::move(parts.front());
  if (stated.front()) shift(run, *stated.front());
  for (std::size_t i = 1; i < parts.size(); ++i) {
    Recording& part = parts[i];
    std::array<char, 160> text{};
    if (stated[i]) {
      shift(part, *stated[i]);
    } else if (const std::optional<FoundShift> found = find_shift(run, part)) {
      shift(part, found->seconds);
      std::snprintf(text.data(), text.size(),
                    ": %.3f s are added to its times, by the %s that both measured (correlation %.2f)", found->seconds,
                    found->by.c_str(), found->correlation);
      notes.push_back(part.name + text.data());
    } else {
      const auto [begin, end] = range_of(run);
      const auto [own_begin, own_end] = range_of(part);
      const bool of_day = begin > kDay && own_begin > kDay && own_begin < end && begin < own_end;
      if (!of_day)
        throw InputError(part.name + ": its clock is not that of " + run.name +
                         ", and nothing that both measured tells how they differ; state it: --shift " + part.name +
                         "=SECONDS, what is to be added to its times");
      notes.push_back(part.name + ": its clock is taken for that of " + run.name +
                      ": both show the time of day and overlap, and no motion that both measured says otherwise");
    }
    std::string left_out;
    each_stream(part, [&](const char* name, auto& stream) {
      using Stream = std::remove_reference_t<decltype(stream)>;
      each_stream(run, [&](const char* own, auto& into) {
        if constexpr (std::is_same_v<Stream, std::remove_reference_t<decltype(into)>>) {
          if (std::string_view{own} != name || stream.empty()) return;
          if (into.empty()) {
            into = std::move(stream);
            return;
          }
          std::string again = name;
          if constexpr (std::is_same_v<Stream, std::vector<Signal>>) again = add_signals(into, stream);
          if (!again.empty()) left_out += (left_out.empty() ? "" : ", ") + again;
        }
      });
    });
    if (!left_out.empty())
      notes.push_back(part.name + ": " + left_out + " left out: " + run.name +
                      " has them; leave them out of its map to take these");
  }
  return run;
}

}  // namespace fathom::recordings
