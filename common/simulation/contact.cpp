#include "common/simulation/contact.hpp"

#include <algorithm>
#include <cmath>

namespace fathom::simulation {
namespace {

constexpr double kContactRate = 40.0;     // rad/s: the whole vehicle on four corners; 0.5 m/s goes 13 mm deep
constexpr double kDamping = 6.0;          // s/m: at 0.3 m/s the first push is nearly three times the spring's
constexpr double kFriction = 0.2;         // of the normal force
constexpr double kSliding = 0.05;         // m/s, where friction is nearly full
constexpr double kWaveDamping = 0.5;      // of critical, for the vehicle bobbing at the surface
constexpr double kPause = 0.25;           // s
constexpr double kTouchesSurface = 1e-3;  // m that must emerge

}  // namespace

Hull::Hull(const model::Site& site, const Eigen::Vector3d& size, double mass, double weight)
    : surface_{site.surface},
      half_{0.5 * size},
      reach_{half_.norm()},
      stiffness_{0.25 * mass * kContactRate * kContactRate},
      column_weight_{0.25 * weight / size.z()},
      column_damping_{0.25 * kWaveDamping * 2.0 * std::sqrt(4.0 * column_weight_ * mass)},
      planes_{solid_planes(site)},
      last_touch_(planes_.size() + 1, -1e9) {}

void Hull::solids(const Eigen::Vector3d& p_WB, const Eigen::Matrix3d& R_WB, const Vector6d& nu,
                  Vector6d& wrench) const {
  for (const Plane& plane : planes_) {
    const double gap = plane.n.dot(p_WB) - plane.offset;
    if (gap > reach_) continue;
    const Eigen::Vector3d n_B = R_WB.transpose() * plane.n;
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3d r{(corner & 1) != 0 ? half_.x() : -half_.x(), (corner & 2) != 0 ? half_.y() : -half_.y(),
                              (corner & 4) != 0 ? half_.z() : -half_.z()};
      const double depth = -(gap + n_B.dot(r));
      if (depth <= 0.0) continue;
      const Eigen::Vector3d v = nu.head<3>() + nu.tail<3>().cross(r);
      const double inward = -n_B.dot(v);
      const double push = stiffness_ * depth * std::max(0.0, 1.0 + kDamping * inward);
      const Eigen::Vector3d along = v + inward * n_B;
      const Eigen::Vector3d force =
          push * n_B - kFriction * push * along / std::sqrt(along.squaredNorm() + kSliding * kSliding);
      wrench.head<3>() += force;
      wrench.tail<3>() += r.cross(force);
    }
  }
}

// Four columns, one per quarter of the hull seen from above, each with its share of the displaced water.
void Hull::surface(const Eigen::Vector3d& p_WB, const Eigen::Matrix3d& R_WB, const Vector6d& nu,
                   Vector6d& wrench) const {
  if (p_WB.z() - reach_ > surface_) return;
  const Eigen::Vector3d down_B = R_WB.row(2).transpose();
  for (int quarter = 0; quarter < 4; ++quarter) {
    const Eigen::Vector3d r{(quarter & 1) != 0 ? 0.5 * half_.x() : -0.5 * half_.x(),
                            (quarter & 2) != 0 ? 0.5 * half_.y() : -0.5 * half_.y(), 0.0};
    const double out = std::min(surface_ - (p_WB.z() + down_B.dot(r) - half_.z()), 2.0 * half_.z());
    if (out <= 0.0) continue;
    const double sinking = down_B.dot(nu.head<3>() + nu.tail<3>().cross(r));
    const Eigen::Vector3d force = (column_weight_ * out - column_damping_ * sinking) * down_B;
    wrench.head<3>() += force;
    wrench.tail<3>() += r.cross(force);
  }
}

Vector6d Hull::wrench(const Eigen::Vector3d& p_WB, const Eigen::Matrix3d& R_WB, const Vector6d& nu) const {
  Vector6d wrench = Vector6d::Zero();
  solids(p_WB, R_WB, nu, wrench);
  surface(p_WB, R_WB, nu, wrench);
  return wrench;
}

double Hull::energy(const Eigen::Vector3d& p_WB, const Eigen::Matrix3d& R_WB) const {
  double energy = 0.0;
  for (const Plane& plane : planes_) {
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3d r{(corner & 1) != 0 ? half_.x() : -half_.x(), (corner & 2) != 0 ? half_.y() : -half_.y(),
                              (corner & 4) != 0 ? half_.z() : -half_.z()};
      const double depth = std::max(0.0, plane.offset - plane.n.dot(p_WB + R_WB * r));
      energy += 0.5 * stiffness_ * depth * depth;
    }
  }
  for (int quarter = 0; quarter < 4; ++quarter) {
    const Eigen::Vector3d r{(quarter & 1) != 0 ? 0.5 * half_.x() : -0.5 * half_.x(),
                            (quarter & 2) != 0 ? 0.5 * half_.y() : -0.5 * half_.y(), 0.0};
    const double out = std::max(0.0, surface_ - (p_WB.z() + R_WB.row(2).dot(r) - half_.z()));
    const double whole = 2.0 * half_.z();
    energy += column_weight_ * (out < whole ? 0.5 * out * out : whole * (out - 0.5 * whole));
  }
  return energy;
}

void Hull::count(const Eigen::Vector3d& p_WB, const Eigen::Matrix3d& R_WB, double t) {
  const Eigen::Matrix3d across = R_WB.cwiseAbs();
  const auto touch = [&](std::size_t which, int& counter) {
    if (t - last_touch_[which] > kPause) ++counter;
    last_touch_[which] = t;
  };
  for (std::size_t i = 0; i < planes_.size(); ++i) {
    const Plane& plane = planes_[i];
    const double gap = plane.n.dot(p_WB) - plane.offset;
    if (gap > reach_ || gap > plane.n.cwiseAbs().dot(across * half_)) continue;
    touch(i, plane.kind == Boundary::kFloor ? counts_.floor : counts_.walls);
  }
  if (surface_ - (p_WB.z() - across.row(2).dot(half_)) > kTouchesSurface) touch(planes_.size(), counts_.surface);
}

}  // namespace fathom::simulation
