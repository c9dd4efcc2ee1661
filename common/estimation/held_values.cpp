#include "common/estimation/held_values.hpp"

namespace fathom::estimation {
namespace {

constexpr double kLongestHold = 0.5;  // s: a value that repeats for longer is frozen, or at rest
constexpr double kMostlyHeld = 0.8;   // of the samples that do not stand still: what is held is held all the time
constexpr std::size_t kFewestMoving = 20;

/// How many samples repeat the one before, where values are held in steps that last; 0 where they are not.
template <class T>
std::size_t held_repeats(const std::vector<T>& x, double step) {
  std::size_t moving = 0, held = 0, repeats = 0;
  const std::vector<std::size_t> length = repeat_lengths(x);
  for (std::size_t i = 0; i < x.size(); ++i) {
    repeats += i > 0 && x[i] == x[i - 1] ? 1 : 0;
    if (static_cast<double>(length[i]) * step > kLongestHold) continue;
    ++moving;
    held += length[i] > 1 ? 1 : 0;
  }
  return moving >= kFewestMoving && static_cast<double>(held) > kMostlyHeld * static_cast<double>(moving) ? repeats : 0;
}

}  // namespace

Series without_held(const Series& series) {
  Series fresh;
  if (held_repeats(series.x, typical_step(series.t)) == 0) return fresh;
  for (std::size_t i = 0; i < series.size(); ++i) {
    if (i > 0 && series.x[i] == series.x[i - 1]) continue;
    fresh.t.push_back(series.t[i]);
    fresh.x.push_back(series.x[i]);
  }
  return fresh;
}

PoseSeries without_held(const PoseSeries& pose) {
  const double step = typical_step(pose.t);
  std::vector<Eigen::Vector4d> q;
  for (const Eigen::Quaterniond& one : pose.q_WB) q.push_back(one.coeffs());
  const std::size_t by_position = held_repeats(pose.p_WB, step), by_attitude = held_repeats(q, step);
  PoseSeries fresh;
  if (by_position == 0 && by_attitude == 0) return fresh;
  fresh.has_position = pose.has_position;
  fresh.has_attitude = pose.has_attitude;
  for (std::size_t i = 0; i < pose.size(); ++i) {
    if (i > 0 && (by_position >= by_attitude ? pose.p_WB[i] == pose.p_WB[i - 1] : q[i] == q[i - 1])) continue;
    fresh.t.push_back(pose.t[i]);
    fresh.p_WB.push_back(pose.p_WB[i]);
    fresh.q_WB.push_back(pose.q_WB[i]);
    fresh.valid.push_back(pose.valid[i]);
  }
  return fresh;
}

}  // namespace fathom::estimation
