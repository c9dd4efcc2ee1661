// Was the pose read as it was meant? Other orders and senses of the quaternion, and other world axes of the position,
// are tried against gyro and DVL.
#include <algorithm>
#include <cmath>

#include "common/base/statistics.hpp"
#include "common/base/units.hpp"
#include "common/estimation/consistency_check.hpp"
#include "common/estimation/signed_permutation.hpp"
#include "common/estimation/wording.hpp"

namespace fathom::estimation {
namespace {

constexpr double kPoorRates = 0.995;           // robust R^2 below which other readings of the quaternion are tried
constexpr double kPoorVelocity = 0.99;         // robust R^2 below which other world axes are tried
constexpr double kAlike = 2.7, kUnlike = 1.5;  // sums of three cosines: the axes agree, the axes do not
constexpr double kClearlyBetter = 0.5;         // a hypothesis must halve the unexplained share

const char* words(QuaternionForm form) {
  switch (form) {
    case QuaternionForm::kInverse:
      return "the attitude is world-to-body, read as body-to-world";
    case QuaternionForm::kScalarLast:
      return "the quaternion's scalar stands last, read as first";
    case QuaternionForm::kScalarLastInverse:
      return "the quaternion's scalar stands last and it is world-to-body";
    default:
      return "";
  }
}

Eigen::Quaterniond as_meant(QuaternionForm form, const Eigen::Quaterniond& q) {
  // Read as (w x y z) = (x y z w): what stands in z is w.
  Eigen::Quaterniond last(q.z(), q.w(), q.x(), q.y());
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

}  // namespace

Check::AttitudeFit Check::quick_attitude(QuaternionForm form) const {
  std::vector<double> explained, likeness;
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    const bool by_gyro = !gyro_[r].empty();
    if (!poses_[r].has_attitude || (!by_gyro && (dvl_[r].empty() || !poses_[r].has_position))) continue;
    PoseSeries turned = poses_[r];
    for (Eigen::Quaterniond& q : turned.q_WB) q = as_meant(form, q);
    make_continuous(turned.q_WB);
    const IncrementProblem problem = by_gyro ? rate_problem(turned) : velocity_problem(turned, nullptr);
    const IncrementFit fit =
        fit_increments(problem, by_gyro ? gyro_[r] : dvl_[r], {.outlier_floor = 0.0, .quick = true});
    if (!fit.ok) continue;
    explained.push_back(fit.explained);
    likeness.push_back(0.0);
    for (int k = 0; k < 3; ++k) likeness.back() += fit.theta.segment<3>(3 * k).normalized()[k];
  }
  if (explained.empty()) return {};
  return {median(std::move(explained)), median(std::move(likeness))};
}

void Check::choose_quaternion() {
  const AttitudeFit as_read = quick_attitude(QuaternionForm::kAsRead);
  if (as_read.explained < -0.5 || (as_read.explained > kPoorRates && as_read.likeness > kAlike)) return;
  QuaternionForm best = QuaternionForm::kAsRead;
  AttitudeFit chosen = as_read;
  for (const QuaternionForm form :
       {QuaternionForm::kInverse, QuaternionForm::kScalarLast, QuaternionForm::kScalarLastInverse}) {
    const AttitudeFit fit = quick_attitude(form);
    const double unexplained = 1.0 - fit.explained, before = 1.0 - chosen.explained;
    // Two forms may differ by fixed turns only and explain alike: then the one that needs no swapped axes was meant.
    const bool better = unexplained < kClearlyBetter * before;
    const bool as_good = unexplained < before / kClearlyBetter && fit.likeness > kAlike && chosen.likeness < kUnlike;
    if (!better && !as_good) continue;
    best = form;
    chosen = fit;
  }
  const double best_explained = chosen.explained;
  if (best == QuaternionForm::kAsRead) return;
  for (Corrections& corrections : result_.corrections) corrections.quaternion = best;
  const bool order = best != QuaternionForm::kInverse;
  report(reference_ + ".attitude", order ? "quaternion_order" : "quaternion_inverse", 1.0, "",
         std::string(words(best)) +
             text(": explains %.4f of the sensor's increments, as read only %.4f", best_explained, as_read.explained),
         "corrected: read as meant", gyro_.empty() || gyro_[0].empty() ? "dvl" : "gyro");
}

double Check::quick_velocity(std::size_t r, const Eigen::Matrix3d& world, double reach) const {
  PoseSeries turned = pose(r);
  for (Eigen::Vector3d& p : turned.p_WB) p = world * p;
  const IncrementFit fit = fit_increments(velocity_problem(turned, nullptr), dvl_[r],
                                          {.longest_delay = reach, .outlier_floor = 0.0, .quick = true});
  return fit.ok ? fit.explained : -1.0;
}

void Check::choose_world() {
  std::vector<double> explained;
  std::size_t longest = 0;
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    if (!poses_[r].has_position || !poses_[r].has_attitude || dvl_[r].empty()) continue;
    const double one = quick_velocity(r, Eigen::Matrix3d::Identity(), 1.1);
    if (one < -0.5) continue;
    explained.push_back(one);
    if (dvl_[r].size() > dvl_[longest].size()) longest = r;
  }
  if (explained.empty() || median(explained) > kPoorVelocity) return;
  const double as_read = quick_velocity(longest, Eigen::Matrix3d::Identity(), 0.3);
  double best = 1.0 - kClearlyBetter * (1.0 - as_read);
  double heading = 0.0;
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  for (int step = 1; step < 24; ++step) {
    const double angle = step * 15.0 * kDegree;
    const double one =
        quick_velocity(longest, Eigen::AngleAxisd(-angle, Eigen::Vector3d::UnitZ()).toRotationMatrix(), 0.3);
    if (one > best) {
      best = one;
      heading = angle;
    }
  }
  // A permutation must do better still: a turned heading is the commoner fault.
  double needed = 1.0 - kClearlyBetter * (1.0 - best);
  for (const Eigen::Matrix3d& Q : signed_permutations()) {
    const double one = quick_velocity(longest, Q, 0.3);
    if (one > needed) {
      needed = one;
      axes = Q;
    }
  }
  if (!axes.isIdentity()) {
    for (Corrections& corrections : result_.corrections) corrections.position_axes = axes;
    std::string mapping;
    for (int row = 0; row < 3; ++row) {
      int column = 0;
      axes.row(row).cwiseAbs().maxCoeff(&column);
      mapping += std::string(row == 0 ? "" : ", ") + "xyz"[row] + " = " + (axes(row, column) < 0.0 ? "-" : "+") +
                 "xyz"[column];
    }
    report("pose_capture.position", axes.isDiagonal() ? "sign" : "axes", axes.isDiagonal() ? -1.0 : 1.0, "",
           "the position's world axes do not fit attitude and DVL: " + mapping +
               text(" explains %.3f, as read %.3f", needed, as_read),
           "corrected: " + mapping, "dvl");
  } else if (heading != 0.0) {
    for (Corrections& corrections : result_.corrections) corrections.heading = heading;
  }
}

void correct_pose(const Corrections& corrections, PoseSeries& pose) {
  const Eigen::Quaterniond heading(Eigen::AngleAxisd(corrections.heading, Eigen::Vector3d::UnitZ()));
  const Eigen::Quaterniond axes(corrections.attitude_axes);
  for (Eigen::Quaterniond& q : pose.q_WB) q = heading * as_meant(corrections.quaternion, q) * axes;
  for (Eigen::Vector3d& p : pose.p_WB) p = corrections.position_scale * (corrections.position_axes * p);
  make_continuous(pose.q_WB);
}

}  // namespace fathom::estimation
