#include "common/estimation/corrections.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/spatial.hpp"

namespace fathom::estimation {

namespace {

constexpr double kLongestGap = 1.05;  // s between attitudes: a vehicle that turns by 10 deg/s is told within a degree

}  // namespace

Eigen::Quaterniond as_meant(QuaternionForm form, const Eigen::Quaterniond& q) {
  // Read as (w x y z) = (x y z w): what stands in z is w.
  const Eigen::Quaterniond last(q.z(), q.w(), q.x(), q.y());
  switch (form) {
    case QuaternionForm::kInverse:
      return q.conjugate();
    case QuaternionForm::kScalarLast:
      return last;
    case QuaternionForm::kScalarLastInverse:
      return last.conjugate();
    default:
      return q;
  }
}

Eigen::Quaterniond as_meant(HeadingSense sense, const Eigen::Quaterniond& q) {
  if (sense == HeadingSense::kAsRead) return q;
  Eigen::Vector3d euler = euler_from_rotation(q.toRotationMatrix());
  euler.z() = (sense == HeadingSense::kFromEast ? 0.5 * std::numbers::pi : 0.0) - euler.z();
  return Eigen::Quaterniond(rotation_from_euler(euler));
}

Eigen::Vector3d body_rates(const Eigen::Vector3d& euler_rates, const Eigen::Quaterniond& q_WB) {
  const Eigen::Vector3d euler = euler_from_rotation(q_WB.toRotationMatrix());
  const double roll = euler.x(), pitch = euler.y(), dpitch = euler_rates.y(), dyaw = euler_rates.z();
  return {euler_rates.x() - std::sin(pitch) * dyaw, std::cos(roll) * dpitch + std::sin(roll) * std::cos(pitch) * dyaw,
          -std::sin(roll) * dpitch + std::cos(roll) * std::cos(pitch) * dyaw};
}

bool attitude_at(const PoseSeries& pose, double t, Eigen::Quaterniond& q_WB) {
  const auto after = std::ranges::lower_bound(pose.t, t);
  const auto i = static_cast<std::size_t>(after - pose.t.begin());
  if (after == pose.t.end() || (i == 0 && *after > t)) return false;
  if (*after == t) {
    q_WB = pose.q_WB[i];
    return pose.valid[i] != 0;
  }
  const double gap = pose.t[i] - pose.t[i - 1];
  if (pose.valid[i] == 0 || pose.valid[i - 1] == 0 || gap > kLongestGap) return false;
  q_WB = pose.q_WB[i - 1].slerp((t - pose.t[i - 1]) / gap, pose.q_WB[i]);
  return true;
}

void to_body(VectorFrame frame, const Eigen::Matrix3d& world, const PoseSeries& pose, Series& vectors) {
  if (frame == VectorFrame::kBody) return;
  Series turned;
  Eigen::Quaterniond q_WB;
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    if (!attitude_at(pose, vectors.t[i], q_WB)) continue;
    turned.t.push_back(vectors.t[i]);
    turned.x.push_back(frame == VectorFrame::kWorld ? Eigen::Vector3d(q_WB.conjugate() * (world * vectors.x[i]))
                                                    : body_rates(vectors.x[i], q_WB));
  }
  vectors = std::move(turned);
}

namespace {

/// Each attitude gets the position that was logged so much later.
void draw_position_forward(double late, PoseSeries& pose) {
  Series position;
  for (std::size_t i = 0; i < pose.size(); ++i) {
    if (pose.valid[i] == 0) continue;
    position.t.push_back(pose.t[i]);
    position.x.push_back(pose.p_WB[i]);
  }
  const Spline spline(position);
  for (std::size_t i = 0; i < pose.size(); ++i) {
    if (!spline.at(pose.t[i] + late, pose.p_WB[i])) pose.valid[i] = 0;
  }
}

}  // namespace

void correct_pose(const Corrections& corrections, PoseSeries& pose) {
  const Eigen::Quaterniond heading(Eigen::AngleAxisd(corrections.heading, Eigen::Vector3d::UnitZ()));
  const Eigen::Quaterniond world(corrections.attitude_world), axes(corrections.attitude_axes);
  for (Eigen::Quaterniond& q : pose.q_WB)
    q = heading * world * as_meant(corrections.heading_sense, as_meant(corrections.quaternion, q)) * axes;
  if (corrections.position_late != 0.0 && pose.size() > 1) draw_position_forward(corrections.position_late, pose);
  for (Eigen::Vector3d& p : pose.p_WB) p = corrections.position_scale * (corrections.position_axes * p);
  make_continuous(pose.q_WB);
}

}  // namespace fathom::estimation
