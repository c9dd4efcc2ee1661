#include "common/estimation/online/navigation_filter.hpp"

#include <cmath>

namespace fathom::estimation {
namespace {

constexpr double kTiltTime = 1.0;  // s, for which a vehicle stays tilted the same way
using Axis = NavigationFilter::AxisCovariance;

// x' = F x with p' = p + dt v - dt^2/2 b, v' = v - dt b.
void propagate(Axis& c, double dt, double noise_v, double noise_b) {
  const double h = -0.5 * dt * dt;
  const double pv = c.pv + dt * c.vv + h * c.vb;  // covariance of the new p with the old v, and so on
  const double pb = c.pb + dt * c.vb + h * c.bb;
  c.pp += dt * (c.pv + pv) + h * (c.pb + pb) + noise_v * dt * dt * dt / 3.0;
  c.pv = pv - dt * pb + 0.5 * noise_v * dt * dt;
  c.pb = pb;
  c.vv += -2.0 * dt * c.vb + dt * dt * c.bb + noise_v * dt;
  c.vb -= dt * c.bb;
  c.bb += noise_b * dt;
}

// P - g s' - s g' + g g' (s_h + r) with s = P h: Joseph's form, right for any gain.
void correct(Axis& c, double sp, double sv, double sb, double total, double gp, double gv, double gb) {
  c.pp += gp * (gp * total - 2.0 * sp);
  c.pv += gp * gv * total - gp * sv - gv * sp;
  c.pb += gp * gb * total - gp * sb - gb * sp;
  c.vv += gv * (gv * total - 2.0 * sv);
  c.vb += gv * gb * total - gv * sb - gb * sv;
  c.bb += gb * (gb * total - 2.0 * sb);
}

}  // namespace

void NavigationFilter::start(const Eigen::Vector3d& p_WB, const Eigen::Vector3d& sigma_p, const Eigen::Vector3d& v_WB,
                             double sigma_v) {
  p_WB_ = p_WB;
  v_WB_ = v_WB;
  b_.setZero();
  tilt_.setZero();
  for (std::size_t i = 0; i < 3; ++i) {
    const double sigma = sigma_p[static_cast<Eigen::Index>(i)];
    covariance_[i] = {.pp = sigma * sigma, .vv = sigma_v * sigma_v, .bb = noise_.bias_prior * noise_.bias_prior};
  }
}

void NavigationFilter::predict(double dt, const Eigen::Matrix3d& R_WB, const Eigen::Vector3d& f_B) {
  const Eigen::Vector3d felt_B = f_B - b_;
  const Eigen::Vector3d a_W = R_WB * (felt_B + tilt_.cross(felt_B)) + noise_.gravity * Eigen::Vector3d::UnitZ();
  p_WB_ += dt * v_WB_ + (0.5 * dt * dt) * a_W;
  v_WB_ += dt * a_W;
  const double across = noise_.acceleration * noise_.acceleration;
  const double vertical = noise_.vertical_acceleration * noise_.vertical_acceleration;
  const double noise_b = noise_.bias_walk * noise_.bias_walk;
  // A bias of the accelerometer across passes for a wrong attitude while level, and a tilt turns it up until the
  // vertical has told it; as large as what a wrong attitude makes of gravity, since the two are learnt as one.
  const double tilted = noise_.gravity * noise_.attitude * std::hypot(R_WB(2, 0), R_WB(2, 1));
  const Eigen::Vector3d noise_v{across, across,
                                (vertical > 0.0 ? vertical : across) + 2.0 * kTiltTime * tilted * tilted};
  for (Eigen::Index i = 0; i < 3; ++i) {
    propagate(covariance_[static_cast<std::size_t>(i)], dt, noise_v[i], noise_b);
  }
}

// What acceleration lacks across is a wrong attitude's, which gravity multiplies, and stays across however the vehicle
// tilts; up and down it is the accelerometer's. A tilted vehicle thus tells the accelerometer's other axes as well.
void NavigationFilter::learn(const Eigen::Vector3d& lacking_W, const Eigen::Matrix3d& R_WB) {
  tilt_ += R_WB.transpose() * Eigen::Vector3d{lacking_W.y(), -lacking_W.x(), 0.0} / noise_.gravity;
  b_ -= lacking_W.z() * R_WB.row(2).transpose();
}

void NavigationFilter::correct_position(const Eigen::Vector3d& innovation_W, const AxisGains& gains,
                                        const Eigen::Vector3d& variance, const Eigen::Matrix3d& R_WB) {
  p_WB_ += gains.value.cwiseProduct(innovation_W);
  v_WB_ += gains.rate.cwiseProduct(innovation_W);
  learn(gains.second.cwiseProduct(innovation_W), R_WB);
  for (Eigen::Index i = 0; i < 3; ++i) {
    Axis& c = covariance_[static_cast<std::size_t>(i)];
    if (gains.value[i] == 0.0) continue;
    correct(c, c.pp, c.pv, c.pb, c.pp + variance[i], gains.value[i], gains.rate[i], -gains.second[i]);
  }
}

void NavigationFilter::correct_velocity(const Eigen::Vector3d& innovation_B, const AxisGains& gains,
                                        const Eigen::Vector3d& variance, const Eigen::Matrix3d& R_WB) {
  v_WB_ += R_WB * gains.value.cwiseProduct(innovation_B);
  learn(R_WB * gains.rate.cwiseProduct(innovation_B), R_WB);
  const Eigen::Matrix3d share = R_WB.cwiseAbs2();
  const Eigen::Vector3d value = share * gains.value;
  const Eigen::Vector3d rate = share * gains.rate;
  const Eigen::Vector3d noise = share * variance;
  for (Eigen::Index i = 0; i < 3; ++i) {
    Axis& c = covariance_[static_cast<std::size_t>(i)];
    correct(c, c.pv, c.vv, c.vb, c.vv + noise[i], 0.0, value[i], -rate[i]);
  }
}

void NavigationFilter::correct_horizontal_velocity(const Eigen::Vector2d& innovation_W, const AxisGains& gains,
                                                   const Eigen::Vector2d& variance, const Eigen::Matrix3d& R_WB) {
  v_WB_.head<2>() += gains.value.head<2>().cwiseProduct(innovation_W);
  const Eigen::Vector2d across = gains.rate.head<2>().cwiseProduct(innovation_W);
  learn({across.x(), across.y(), 0.0}, R_WB);
  for (Eigen::Index i = 0; i < 2; ++i) {
    Axis& c = covariance_[static_cast<std::size_t>(i)];
    correct(c, c.pv, c.vv, c.vb, c.vv + variance[i], 0.0, gains.value[i], -gains.rate[i]);
  }
}

void NavigationFilter::forget_motion(double seconds, double acceleration) {
  const double v = acceleration * seconds;
  const double p = 0.5 * v * seconds;
  for (Axis& c : covariance_) {
    c.pp += p * p + c.vv * seconds * seconds;
    c.pv = 0.0;
    c.vv += v * v;
    c.pb = c.vb = 0.0;
  }
}

void NavigationFilter::set_position(const Eigen::Vector3d& p_WB, const Eigen::Vector3d& axes,
                                    const Eigen::Vector3d& variance) {
  for (Eigen::Index i = 0; i < 3; ++i) {
    if (axes[i] == 0.0) continue;
    Axis& c = covariance_[static_cast<std::size_t>(i)];
    p_WB_[i] = p_WB[i];
    c.pp = variance[i];
    c.pv = c.pb = 0.0;
  }
}

void NavigationFilter::set_velocity(const Eigen::Vector3d& v_WB, const Eigen::Vector3d& axes,
                                    const Eigen::Vector3d& variance) {
  for (Eigen::Index i = 0; i < 3; ++i) {
    if (axes[i] == 0.0) continue;
    Axis& c = covariance_[static_cast<std::size_t>(i)];
    v_WB_[i] = v_WB[i];
    c.vv = variance[i];
    c.pv = c.vb = 0.0;
  }
}

Matrix6d NavigationFilter::covariance_body(const Eigen::Matrix3d& R_WB) const {
  Eigen::Vector3d pp, pv, vv;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Axis& c = covariance_[static_cast<std::size_t>(i)];
    pp[i] = c.pp;
    pv[i] = c.pv;
    vv[i] = c.vv;
  }
  Matrix6d P;
  P.topLeftCorner<3, 3>() = pp.asDiagonal();
  P.topRightCorner<3, 3>() = pv.asDiagonal() * R_WB;
  P.bottomLeftCorner<3, 3>() = P.topRightCorner<3, 3>().transpose();
  P.bottomRightCorner<3, 3>() = R_WB.transpose() * vv.asDiagonal() * R_WB;
  return P;
}

}  // namespace fathom::estimation
