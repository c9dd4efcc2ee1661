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

}  // namespace fathom::board
