// The regressor against momentum balance by finite differences and against the four-axis rows of Karras et al.,
// with the printed signs shown to be wrong for a frame whose z axis points down.
#include "common/model/regressor.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

using namespace fathom;
using model::BaseParameter;
using Theta = Eigen::Matrix<double, model::kBaseParameterCount, 1>;

namespace {

constexpr double kRounding = 1e-12;  // sums of a few products of numbers near 1..10
constexpr double kFiniteDifference =
    1e-6;  // central differences with a step of 1e-5: truncation near 1e-9, rounding near 1e-10

struct Draw {
  std::mt19937 engine{7};
  double operator()(double scale) { return std::uniform_real_distribution<double>{-scale, scale}(engine); }
  Vector6d six(double scale) {
    Vector6d x;
    for (int i = 0; i < 6; ++i) x(i) = (*this)(scale);
    return x;
  }
};

double& at(Theta& theta, BaseParameter parameter) { return theta(model::index(parameter)); }

}  // namespace

TEST_CASE("regressor: inertia and Coriolis rows are the rate of change of momentum in the world") {
  Draw draw;
  for (int trial = 0; trial < 20; ++trial) {
    Theta theta = Theta::Zero();
    for (int i = 0; i < 6; ++i) theta(i) = 5.0 + draw(4.0);
    const Vector6d nu0 = draw.six(1.0);
    const Vector6d nu_dot = draw.six(1.0);
    const Eigen::Matrix3d R0 = rotation_from_euler({draw(1.0), draw(1.0), draw(3.0)});
    const Eigen::Vector3d p0{draw(2.0), draw(2.0), draw(2.0)};
    // World momentum [linear; angular about Wo] a time t later, for a motion with constant nu_dot.
    const auto momentum = [&](double t) {
      const Vector6d nu = nu0 + t * nu_dot;
      const Eigen::Vector3d turn = t * nu0.tail<3>() + 0.5 * t * t * nu_dot.tail<3>();
      const Eigen::Matrix3d R = R0 * quaternion_from_rotation_vector(turn).toRotationMatrix();
      const Eigen::Vector3d p = p0 + t * (R0 * nu0.head<3>());
      const Eigen::Vector3d P = R * theta.head<3>().cwiseProduct(nu.head<3>());
      const Eigen::Vector3d L = R * theta.segment<3>(3).cwiseProduct(nu.tail<3>());
      Vector6d h;
      h << P, L + p.cross(P);
      return h;
    };
    constexpr double kStep = 1e-5;
    const Vector6d rate = (momentum(kStep) - momentum(-kStep)) / (2.0 * kStep);
    const Vector6d tau = model::base_regressor(nu_dot, nu0, R0) * theta;
    const Eigen::Vector3d force = R0 * tau.head<3>();
    const Eigen::Vector3d moment = R0 * tau.tail<3>() + p0.cross(force);
    CHECK((rate.head<3>() - force).norm() < kFiniteDifference);
    CHECK((rate.tail<3>() - moment).norm() < kFiniteDifference);
  }
}

TEST_CASE("regressor: gyroscopic terms do no work and drag takes power") {
  Draw draw;
  for (int trial = 0; trial < 20; ++trial) {
    const Vector6d nu = draw.six(2.0);
    const model::BaseRegressor Y = model::motion_regressor(nu, Eigen::Vector3d::UnitZ());
    for (int i = 0; i < 6; ++i) CHECK(std::abs(nu.dot(Y.col(i))) < kRounding);
    // A drag derivative of -1: the power that the wrench must supply is positive.
    for (int i = 6; i < 18; ++i) CHECK(nu.dot(-Y.col(i)) > 0.0);
  }
}

TEST_CASE("regressor: the corrected rows of Karras et al. are its four-axis case; the printed ones are not") {
  Draw draw;
  double printed_error_X = 0.0;
  double printed_error_Z = 0.0;
  for (int trial = 0; trial < 50; ++trial) {
    const Vector6d nu = draw.six(1.0);
    const Vector6d a = draw.six(1.0);
    const double u = nu(0), v = nu(1), w = nu(2), p = nu(3), q = nu(4), r = nu(5);
    const double roll = draw(0.5), pitch = draw(0.5), yaw = draw(3.0);
    const double sphi = std::sin(roll), cphi = std::cos(roll), stheta = std::sin(pitch), ctheta = std::cos(pitch);
    Theta theta = Theta::Zero();  // Table 1.1
    const double m_X = at(theta, BaseParameter::m_X) = 9.7532;
    const double m_Y = at(theta, BaseParameter::m_Y) = 8.6636;
    const double m_Z = at(theta, BaseParameter::m_Z) = 10.898;
    const double I_Z = at(theta, BaseParameter::I_Z) = 0.1589;
    const double X_u = at(theta, BaseParameter::X_u) = -8.6040;
    const double Y_v = at(theta, BaseParameter::Y_v) = -18.1106;
    const double Z_w = at(theta, BaseParameter::Z_w) = -17.1828;
    const double N_r = at(theta, BaseParameter::N_r) = -1.4146;
    const double X_uu = at(theta, BaseParameter::X_uu) = -17.8534;
    const double Y_vv = at(theta, BaseParameter::Y_vv) = -1.0594;
    const double Z_ww = at(theta, BaseParameter::Z_ww) = -3.6482;
    const double N_rr = at(theta, BaseParameter::N_rr) = -10.3483;
    const double W_B = at(theta, BaseParameter::W_B) = -1.1881;
    const Vector6d tau = model::base_regressor(a, nu, rotation_from_euler({roll, pitch, yaw})) * theta;

    const double X = a(0) * m_X - v * r * m_Y + q * w * m_Z - u * X_u - u * std::abs(u) * X_uu;
    const double Y = a(1) * m_Y + u * r * m_X - p * w * m_Z - v * Y_v - v * std::abs(v) * Y_vv;
    const double Z = a(2) * m_Z - u * q * m_X - w * Z_w - w * std::abs(w) * Z_ww;
    const double N = a(5) * I_Z - u * v * m_X + u * v * m_Y - r * N_r - r * std::abs(r) * N_rr;
    CHECK(tau(0) == doctest::Approx(X + stheta * W_B).epsilon(kRounding));
    CHECK(tau(1) == doctest::Approx(Y - sphi * ctheta * W_B).epsilon(kRounding));
    CHECK(tau(2) == doctest::Approx(Z + p * v * m_Y - cphi * ctheta * W_B).epsilon(kRounding));
    CHECK(tau(5) == doctest::Approx(N).epsilon(kRounding));
    printed_error_X = std::max(printed_error_X, std::abs(tau(0) - (X - stheta * W_B)));
    printed_error_Z = std::max(printed_error_Z, std::abs(tau(2) - (Z + u * v * m_Y + cphi * ctheta * W_B)));
  }
  CHECK(printed_error_X > 0.5);  // N: the restoring sign, 2 |W-B| sin(pitch)
  CHECK(printed_error_Z > 5.0);  // N: u v for p v, on 8.7 kg
}

TEST_CASE("regressor: a heavy vehicle at rest without thrust sinks, whatever its heading") {
  Theta theta = Theta::Zero();
  at(theta, BaseParameter::W_B) = 3.0;
  const Vector6d tau =
      model::base_regressor(Vector6d::Zero(), Vector6d::Zero(), rotation_from_euler({0, 0, 1.2})) * theta;
  // It takes 3 N upward (negative z) to hold it; without them M nu_dot = -tau points down.
  CHECK(tau(2) == doctest::Approx(-3.0));
  CHECK(tau.head<2>().norm() < kRounding);
}

TEST_CASE("regressor: a centre of gravity below the centre of buoyancy rights the vehicle") {
  Theta theta = Theta::Zero();
  at(theta, BaseParameter::G_z) = 2.0;  // N m: weight low
  const double angle = 0.3;
  const Vector6d rolled =
      model::base_regressor(Vector6d::Zero(), Vector6d::Zero(), rotation_from_euler({angle, 0, 0.7})) * theta;
  CHECK(rolled(3) == doctest::Approx(2.0 * std::sin(angle)));  // wrench needed to hold it there
  const Vector6d pitched =
      model::base_regressor(Vector6d::Zero(), Vector6d::Zero(), rotation_from_euler({0, angle, 0})) * theta;
  CHECK(pitched(4) == doctest::Approx(2.0 * std::sin(angle)));
  CHECK(std::abs(pitched(3)) < kRounding);

  // A weight forward of the buoyancy puts the nose down: negative pitch acceleration without thrust.
  theta.setZero();
  at(theta, BaseParameter::G_x) = 1.0;
  const Vector6d level = model::base_regressor(Vector6d::Zero(), Vector6d::Zero(), Eigen::Matrix3d::Identity()) * theta;
  CHECK(level(4) == doctest::Approx(1.0));
}
