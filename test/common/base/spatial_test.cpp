#include "common/base/spatial.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

using Eigen::Matrix3d;
using Eigen::Vector3d;
using namespace fathom;

namespace {
constexpr double kPi = std::numbers::pi;
constexpr double kRounding = 1e-14;  // products of sines and cosines
constexpr double kNearPole = 1e-7;   // asin loses half of the digits at +-90 degrees
}  // namespace

TEST_CASE("spatial: yaw of 90 degrees points the nose east") {
  const Matrix3d R_WB = rotation_from_euler({0.0, 0.0, kPi / 2.0});
  CHECK((R_WB * Vector3d::UnitX()).isApprox(Vector3d::UnitY(), kRounding));
  CHECK((R_WB * Vector3d::UnitY()).isApprox(-Vector3d::UnitX(), kRounding));
}

TEST_CASE("spatial: positive pitch lifts the nose (z down becomes negative), positive roll lowers starboard") {
  CHECK((rotation_from_euler({0.0, kPi / 6.0, 0.0}) * Vector3d::UnitX())
            .isApprox(Vector3d(std::sqrt(3.0) / 2.0, 0.0, -0.5), kRounding));
  CHECK((rotation_from_euler({kPi / 6.0, 0.0, 0.0}) * Vector3d::UnitY())
            .isApprox(Vector3d(0.0, std::sqrt(3.0) / 2.0, 0.5), kRounding));
}

TEST_CASE("spatial: euler angles come back, and pitch stays legal at the pole") {
  for (const Vector3d& euler : {Vector3d(0.1, -0.2, 3.0), Vector3d(-3.0, 1.5, -0.4), Vector3d(0.0, 0.0, 0.0)}) {
    CHECK((euler_from_rotation(rotation_from_euler(euler)) - euler).norm() < 1e-12);
  }
  const Vector3d pole = euler_from_rotation(rotation_from_euler({0.0, kPi / 2.0, 0.0}));
  CHECK(std::abs(pole.y() - kPi / 2.0) < kNearPole);
  CHECK(pole.allFinite());
}

TEST_CASE("spatial: a rotation vector survives the quaternion, small, large and mirrored") {
  for (const Vector3d& phi : {Vector3d(1e-9, -2e-9, 0.0), Vector3d(1e-4, 0.0, 0.0), Vector3d(0.3, -1.0, 2.0)}) {
    const Eigen::Quaterniond q = quaternion_from_rotation_vector(phi);
    CHECK(std::abs(q.norm() - 1.0) < kRounding);
    CHECK((rotation_vector_from_quaternion(q) - phi).norm() < 1e-14 + 1e-12 * phi.norm());
    const Eigen::Quaterniond mirrored(-q.w(), -q.x(), -q.y(), -q.z());
    CHECK((rotation_vector_from_quaternion(mirrored) - phi).norm() < 1e-14 + 1e-12 * phi.norm());
  }
  CHECK(quaternion_from_rotation_vector(Vector3d::Zero()).isApprox(Eigen::Quaterniond::Identity()));
  CHECK(rotation_vector_from_quaternion(Eigen::Quaterniond(0.0, 0.0, 0.0, 1.0)).isApprox(Vector3d(0, 0, kPi)));
}

TEST_CASE("spatial: the series of a small rotation meets the sine and cosine at its bound") {
  constexpr double kBound = 0.2;  // rad, where the code changes over
  for (const double angle : {0.1 * kBound, 0.5 * kBound, kBound * (1.0 - 1e-9), kBound * (1.0 + 1e-9), 2.0 * kBound}) {
    const Eigen::Quaterniond q = quaternion_from_rotation_vector({0.0, angle, 0.0});
    CHECK(std::abs(q.w() - std::cos(0.5 * angle)) < 2e-16);
    CHECK(std::abs(q.y() - std::sin(0.5 * angle)) < 2e-16);
  }
}

TEST_CASE("spatial: skew times a vector is the cross product") {
  const Vector3d a(1.0, 2.0, 3.0);
  CHECK((skew(a) * Vector3d(4.0, 5.0, 6.0)).isApprox(Vector3d(-3.0, 6.0, -3.0), kRounding));
  CHECK((skew(a) + skew(a).transpose()).isZero());
}

TEST_CASE("spatial: angles fold into (-pi, pi]") {
  CHECK(wrap_angle(3.0 * kPi) == doctest::Approx(kPi));
  CHECK(wrap_angle(-kPi) == doctest::Approx(kPi));
  CHECK(wrap_angle(0.5 - 40.0 * kPi) == doctest::Approx(0.5));
  CHECK(wrap_angle(-3.5) == doctest::Approx(2.0 * kPi - 3.5));
}

TEST_CASE("spatial: a small change of a rotation vector turns by its right Jacobian, small vectors and long ones") {
  constexpr double kStep = 1e-6, kDifference = 1e-8;
  for (const Vector3d& phi : {Vector3d(0.0, 0.0, 0.0), Vector3d(1e-4, -2e-4, 5e-5), Vector3d(6e-3, -8e-3, 1e-4),
                              Vector3d(0.4, -1.1, 0.7), Vector3d(2.0, 1.5, -1.2)}) {
    const Eigen::Quaterniond q = quaternion_from_rotation_vector(phi);
    Matrix3d J;
    for (int i = 0; i < 3; ++i) {
      const Vector3d step = kStep * Vector3d::Unit(i);
      J.col(i) = (rotation_vector_from_quaternion(q.conjugate() * quaternion_from_rotation_vector(phi + step)) -
                  rotation_vector_from_quaternion(q.conjugate() * quaternion_from_rotation_vector(phi - step))) /
                 (2.0 * kStep);
    }
    CAPTURE(phi.transpose());
    CHECK((right_jacobian(phi) - J).norm() < kDifference);
  }
}
