#include "common/model/sensors/tag_pose.hpp"

#include <algorithm>

#include "common/model/sensors/attitude.hpp"

namespace fathom::model {

Pose body_from_tag(const Pose& X_WT, const Pose& X_CT, const Pose& X_BC) {
  const Eigen::Quaterniond q_BT = X_BC.q * X_CT.q;
  const Eigen::Vector3d p_BT = X_BC.p + X_BC.q * X_CT.p;
  const Eigen::Quaterniond q_WB = X_WT.q * q_BT.conjugate();
  return {X_WT.p - q_WB * p_BT, q_WB};
}

std::array<Observation, 6> observe_tag(const KinematicPoint& point, const Pose& X_WT, const Pose& X_BC,
                                       const Pose& X_CT, double across, double along, double attitude) {
  const Eigen::Matrix3d R_CB = X_BC.q.toRotationMatrix().transpose();
  const Eigen::Vector3d p_BT = point.R_WB.transpose() * (X_WT.p - point.group(at::kPosition));
  const Eigen::Vector3d innovation = X_CT.p - R_CB * (p_BT - X_BC.p);
  const Eigen::Matrix3d by_position = -R_CB * point.R_WB.transpose();
  const Eigen::Matrix3d by_angles = R_CB * point.turned_in(p_BT);
  std::array<Observation, 6> result;
  for (int i = 0; i < 3; ++i) {
    Observation& one = result[static_cast<std::size_t>(i)];
    one.innovation = innovation[i];
    one.variance = i < 2 ? across : along;
    one.set(at::kPosition, by_position.row(i).transpose());
    one.set(at::kAngles, by_angles.row(i).transpose());
  }
  const auto turns = observe_attitude(point, body_from_tag(X_WT, X_CT, X_BC).q, attitude);
  std::copy(turns.begin(), turns.end(), result.begin() + 3);
  return result;
}

}  // namespace fathom::model
