#include "common/vision/camera_pose.hpp"

#include <cmath>
#include <opencv2/calib3d.hpp>

#include "common/base/factors.hpp"

namespace fathom::vision {
namespace {

constexpr int kMostRounds = 25;
constexpr double kNearest = 1e-3;  // m before the lens

// Cost [px^2], and if wanted the normal equations; negative when a point is behind the camera.
double accumulate(const Projection& projection, const std::vector<Correspondence>& points, const Pose& pose,
                  double scale, Matrix6d* information, Vector6d* gradient, double* squares) {
  double cost = 0.0;
  if (information != nullptr) information->setZero();
  if (gradient != nullptr) gradient->setZero();
  if (squares != nullptr) *squares = 0.0;
  for (const Correspondence& each : points) {
    const Eigen::Vector3d p_C = pose.R_WC.transpose() * (each.p_W - pose.p_WC);
    if (!(p_C.z() > kNearest)) return -1.0;
    const Eigen::Vector2d error = projection.pixel(p_C) - each.pixel;
    const double e2 = error.squaredNorm();
    double weight = 1.0;
    if (scale > 0.0 && e2 > scale * scale) {  // Huber
      const double e = std::sqrt(e2);
      weight = scale / e;
      cost += scale * (2.0 * e - scale);
    } else {
      cost += e2;
    }
    if (squares != nullptr) *squares += e2;
    if (information == nullptr) continue;
    Eigen::Matrix<double, 2, 6> by;
    const Eigen::Matrix<double, 2, 3> by_point = projection.derivative(p_C);
    by.leftCols<3>() = -by_point * pose.R_WC.transpose();
    by.rightCols<3>() = by_point * skew(p_C);  // R_WC exp(turn): p_C turns the other way
    *information += weight * by.transpose() * by;
    *gradient += weight * by.transpose() * error;
  }
  return cost;
}

cv::Mat planar_objects(const std::vector<Correspondence>& points, Eigen::Matrix3d& R_WS, Eigen::Vector3d& p_WS) {
  p_WS.setZero();
  for (const Correspondence& each : points) p_WS += each.p_W;
  p_WS /= static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Correspondence& each : points) spread += (each.p_W - p_WS) * (each.p_W - p_WS).transpose();
  R_WS = symmetric_eigen(spread).vectors.rowwise().reverse();  // widest axis first
  if (R_WS.determinant() < 0.0) R_WS.col(2) *= -1.0;
  cv::Mat objects(static_cast<int>(points.size()), 1, CV_64FC3);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d s = R_WS.transpose() * (points[i].p_W - p_WS);
    objects.at<cv::Vec3d>(static_cast<int>(i)) = {s.x(), s.y(), 0.0};
  }
  return objects;
}

}  // namespace

std::optional<FittedPose> fit_pose(const Projection& projection, const std::vector<Correspondence>& points,
                                   const Pose& start, double scale) {
  FittedPose fitted{.pose = start};
  Matrix6d information;
  Vector6d gradient;
  double cost = accumulate(projection, points, fitted.pose, scale, &information, &gradient, nullptr);
  if (cost < 0.0) return {};
  double damping = 1e-4;
  for (int round = 0; round < kMostRounds; ++round) {
    Matrix6d damped = information;
    damped.diagonal() *= 1.0 + damping;
    const Vector6d step = -solve_symmetric(damped, gradient);
    if (!step.allFinite()) return {};
    Pose tried = fitted.pose;
    tried.p_WC += step.head<3>();
    tried.R_WC = tried.R_WC * quaternion_from_rotation_vector(step.tail<3>()).toRotationMatrix();
    Matrix6d new_information;
    Vector6d new_gradient;
    const double new_cost = accumulate(projection, points, tried, scale, &new_information, &new_gradient, nullptr);
    if (new_cost < 0.0 || new_cost > cost) {
      damping *= 10.0;
      if (damping > 1e8) break;
      continue;
    }
    const bool done = cost - new_cost < 1e-9 * cost + 1e-14;
    fitted.pose = tried;
    cost = new_cost;
    information = new_information;
    gradient = new_gradient;
    damping = std::max(0.1 * damping, 1e-9);
    if (done) break;
  }
  double squares = 0.0;
  accumulate(projection, points, fitted.pose, 0.0, nullptr, nullptr, &squares);
  fitted.cost = cost;
  fitted.information = information;
  fitted.rms = std::sqrt(squares / static_cast<double>(points.size()));
  return fitted;
}

std::vector<Pose> planar_poses(const Projection& projection, const std::vector<Correspondence>& points) {
  if (points.size() < 4) return {};
  Eigen::Matrix3d R_WS;
  Eigen::Vector3d p_WS;
  const cv::Mat objects = planar_objects(points, R_WS, p_WS);
  cv::Mat seen(static_cast<int>(points.size()), 1, CV_64FC2);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d at = projection.normalized(points[i].pixel);
    seen.at<cv::Vec2d>(static_cast<int>(i)) = {at.x(), at.y()};
  }
  std::vector<cv::Mat> turns, shifts;
  try {
    cv::solvePnPGeneric(objects, seen, cv::Matx33d::eye(), cv::noArray(), turns, shifts, false, cv::SOLVEPNP_IPPE);
  } catch (const cv::Exception&) {
    return {};  // points in one line, or worse
  }
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    const Eigen::Vector3d turn{turns[i].at<double>(0), turns[i].at<double>(1), turns[i].at<double>(2)};
    const Eigen::Vector3d p_CS{shifts[i].at<double>(0), shifts[i].at<double>(1), shifts[i].at<double>(2)};
    if (!turn.allFinite() || !p_CS.allFinite() || p_CS.z() <= kNearest) continue;
    const Eigen::Matrix3d R_CS = quaternion_from_rotation_vector(turn).toRotationMatrix();
    const Eigen::Matrix3d R_WC = R_WS * R_CS.transpose();
    poses.push_back({.p_WC = p_WS - R_WC * p_CS, .R_WC = R_WC});
  }
  return poses;
}

Pose mirrored(const Pose& pose, const std::vector<Correspondence>& points, const Eigen::Vector3d& normal_W) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Correspondence& each : points) middle += each.p_W;
  middle /= static_cast<double>(points.size());
  const Eigen::Vector3d p_C = pose.R_WC.transpose() * (middle - pose.p_WC);
  const Eigen::Vector3d sight = p_C.normalized(), normal = pose.R_WC.transpose() * normal_W;
  const Eigen::Vector3d other = 2.0 * normal.dot(sight) * sight - normal;
  // The smallest turn from one to the other, by Rodrigues; half a turn where the plane is seen edge on.
  const Eigen::Matrix3d by = skew(normal.cross(other));
  const double beside = 1.0 + normal.dot(other);
  const Eigen::Matrix3d turn = beside > 1e-12
                                   ? Eigen::Matrix3d(Eigen::Matrix3d::Identity() + by + by * by / beside)
                                   : Eigen::Matrix3d(2.0 * sight * sight.transpose() - Eigen::Matrix3d::Identity());
  Pose result;
  result.R_WC = pose.R_WC * turn.transpose();
  result.p_WC = middle - result.R_WC * p_C;
  return result;
}

}  // namespace fathom::vision
