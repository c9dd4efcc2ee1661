#include "common/joint/joint_rows.hpp"

#include "common/base/spatial.hpp"

namespace fathom::joint {
namespace {

void begin(const JointVector& x, double innovation, JointRow& row) {
  row.h.setZero(x.size());
  row.innovation = innovation;
  row.shared.setZero();
  row.of_motion = true;
}

}  // namespace

Eigen::Matrix3d true_attitude(const JointVector& x, const Eigen::Matrix3d& told) {
  return told * quaternion_from_rotation_vector(x.segment<3>(part::kAttitude)).toRotationMatrix();
}

// d(R arm)/de = -R skew(arm). Heights alone have a scale: across, arms of many tags cancel.
void see_point(const JointVector& x, const Eigen::Matrix3d& told, const Eigen::Vector3d& p_WT,
               const Eigen::Vector3d& arm, std::span<JointRow, 3> rows) {
  const Eigen::Matrix3d R = true_attitude(x, told);
  const Eigen::Vector3d arm_W = R * arm, lacks = p_WT - arm_W - x.segment<3>(part::kPosition);
  const Eigen::Matrix3d by_attitude = -R * skew(arm);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    begin(x, lacks[axis], rows[i]);
    rows[i].h(part::kPosition + axis) = 1.0;
    rows[i].h.segment<3>(part::kAttitude) = by_attitude.row(axis).transpose();
  }
  const double scale = x(part::kScale);
  rows[2].innovation += scale * arm_W.z();
  rows[2].h(part::kScale) = -arm_W.z();
  rows[2].h.segment<3>(part::kAttitude) *= 1.0 - scale;
}

void see_floor(const JointVector& x, const Eigen::Matrix3d& told, double floor, const Eigen::Vector3d& arm,
               JointRow& row) {
  const Eigen::Matrix3d R = true_attitude(x, told);
  const double height = (R * arm).z(), scale = x(part::kScale);
  begin(x, floor - (1.0 - scale) * height - x(part::kPosition + 2) - x(part::kHeight), row);
  row.h(part::kPosition + 2) = 1.0;
  row.h.segment<3>(part::kAttitude) = -(1.0 - scale) * (R * skew(arm)).row(2).transpose();
  row.h(part::kScale) = -height;
  row.h(part::kHeight) = 1.0;
}

double distance(const JointVector& x, const Eigen::Matrix3d& told, double floor,
                const estimation::CameraMount& camera) {
  return estimation::distance_to_floor(floor, x.segment<3>(part::kPosition), camera, true_attitude(x, told));
}

// -flow d - c (v + w x p_BC) - d (z x c) (turned x w), c and z the camera's axes, with d = (floor - z - down p_BC) /
// (down axis); d(down)/de = skew(down).
void see_flow(const JointVector& x, const Eigen::Matrix3d& told, double floor, const estimation::CameraMount& camera,
              const Eigen::Vector3d& flow, std::span<JointRow, 3> rows) {
  const Eigen::Vector3d down = true_attitude(x, told).row(2).transpose(), axis = camera.R_BC.col(2);
  const double facing = down.dot(axis);
  const double d = (floor - x(part::kPosition + 2) - down.dot(camera.p_BC)) / facing;
  const Eigen::Vector3d by_attitude = -(camera.p_BC.cross(down) + d * Eigen::Vector3d{axis.cross(down)}) / facing;
  const Eigen::Vector3d v = x.segment<3>(part::kNu), w = x.segment<3>(part::kNu + 3);
  const Eigen::Vector3d at_camera = v + w.cross(camera.p_BC), turned = x.segment<3>(part::kTurned);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis_C = static_cast<Eigen::Index>(i);
    const Eigen::Vector3d c = camera.R_BC.col(axis_C);
    const Eigen::Vector3d about = axis.cross(c);
    const double left = -about.dot(turned.cross(w));  // of the rotation, rad/s
    begin(x, -(flow[axis_C] + left) * d - c.dot(at_camera), rows[i]);
    rows[i].h.segment<3>(part::kNu) = c;
    rows[i].h.segment<3>(part::kNu + 3) = camera.p_BC.cross(c) - d * about.cross(turned);
    rows[i].h.segment<3>(part::kTurned) = -d * w.cross(about);
    rows[i].h(part::kPosition + 2) = -(flow[axis_C] + left) / facing;
    rows[i].h.segment<3>(part::kAttitude) = (flow[axis_C] + left) * by_attitude;
  }
}

void see_velocity(const JointVector& x, const Eigen::Vector3d& v_B, std::span<JointRow, 3> rows) {
  const Eigen::Vector3d v = x.segment<3>(part::kNu);
  const double scale = 1.0 + x(part::kScale);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    begin(x, v_B[axis] - scale * v[axis] - x(part::kOffset + axis), rows[i]);
    rows[i].h(part::kNu + axis) = scale;
    rows[i].h(part::kScale) = v[axis];
    rows[i].h(part::kOffset + axis) = 1.0;
  }
}

// The turn is small: 1 + skew. Its own products would be of 1e-5.
void see_rates(const JointVector& x, const Eigen::Vector3d& w, std::span<JointRow, 3> rows) {
  const Eigen::Vector3d own = x.segment<3>(part::kNu + 3), turned = x.segment<3>(part::kTurned);
  const Eigen::Matrix3d by_turn = -skew(own), by_rate = Eigen::Matrix3d::Identity() + skew(turned);
  const Eigen::Vector3d lacks = w - by_rate * own;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    begin(x, lacks[axis], rows[i]);
    rows[i].h.segment<3>(part::kNu + 3) = by_rate.row(axis).transpose();
    rows[i].h.segment<3>(part::kTurned) = by_turn.row(axis).transpose();
  }
}

void see_state(const JointVector& x, int which, double value, JointRow& row) {
  begin(x, value - x(which), row);
  row.h(which) = 1.0;
}

std::size_t feel_force(const Normalised& model, const JointVector& x, const Felt& felt, const Eigen::Vector3d& f,
                       std::span<JointRow, 3> rows) {
  const Eigen::Matrix3d R = true_attitude(x, felt.told);
  const Eigen::Vector3d down = R.row(2).transpose(), &r = felt.p_BI;
  const Vector6d nu = x.segment<6>(part::kNu);
  const Eigen::Vector3d v = nu.head<3>(), w = nu.tail<3>();
  AccelerationSlope slope;
  const ParameterVector phi = x.tail(model.size());
  Vector6d nu_dot = model.acceleration(phi, nu, true_attitude(x, felt.carried), felt.tau, &slope);
  for (int i = 0; i < 3; ++i) {
    if (!model.moves(3 + i)) nu_dot[3 + i] = felt.w_dot[i];
  }
  const Eigen::Vector3d w_dot = nu_dot.tail<3>(), turned = w.cross(r);
  const Eigen::Vector3d force = nu_dot.head<3>() + w.cross(v) + w_dot.cross(r) + w.cross(turned) - felt.gravity * down;
  const Eigen::Matrix3d turn = Eigen::Matrix3d::Identity() + skew(Eigen::Vector3d{x.segment<3>(part::kTurned)});
  const Eigen::Vector3d foretold = turn * force + x.segment<3>(part::kBias);
  const Eigen::Matrix3d by_turn = -skew(force);
  const Eigen::Matrix3d skew_r = skew(r);
  Eigen::Matrix<double, 3, 9> by_motion = slope.by_motion.topRows<3>() - skew_r * slope.by_motion.bottomRows<3>();
  by_motion.leftCols<3>() -= felt.gravity * skew(down);
  by_motion.middleCols<3>(3) += skew(w);
  by_motion.rightCols<3>() -= skew(v) + skew(turned) + skew(w) * skew_r;
  by_motion = (turn * by_motion).eval();
  Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, model::kBaseParameterCount> by_parameters =
      slope.by_parameters.topRows<3>() - skew_r * slope.by_parameters.bottomRows<3>();
  by_parameters = (turn * by_parameters).eval();
  std::size_t count = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (!model.moves(axis)) continue;
    JointRow& row = rows[count++];
    begin(x, f[axis] - foretold[axis], row);
    row.of_motion = false;
    row.h.segment<3>(part::kAttitude) = by_motion.row(axis).head<3>().transpose();
    row.h.segment<6>(part::kNu) = by_motion.row(axis).tail<6>().transpose();
    row.h(part::kBias + axis) = 1.0;
    row.h.segment<3>(part::kTurned) = by_turn.row(axis).transpose();
    row.h.tail(model.size()) = by_parameters.row(axis).transpose();
  }
  return count;
}

}  // namespace fathom::joint
