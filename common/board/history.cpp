#include "common/board/history.hpp"

#include "common/base/spatial.hpp"

namespace fathom::board {

MotionRow motion_row(const StateEstimate& state) {
  const Eigen::Vector3d euler = euler_from_rotation(state.q_WB.toRotationMatrix());
  MotionRow row{};
  for (int i = 0; i < 3; ++i) {
    row[static_cast<std::size_t>(i)] = state.p_WB[i];
    row[static_cast<std::size_t>(3 + i)] = euler[i];
  }
  for (int i = 0; i < 6; ++i) row[static_cast<std::size_t>(6 + i)] = state.nu[i];
  return row;
}

void History::add(const StateEstimate& state, double now) {
  forget(now);
  if (!points_.empty() && now - points_.back().at < kSpacing) return;
  points_.push_back({now, motion_row(state)});
}

void History::forget(double now) {
  while (!points_.empty() && now - points_.front().at > kLength) points_.pop_front();
}

}  // namespace fathom::board
