#include "common/estimation/online/complementary_filter.hpp"

#include <cmath>

#include "common/base/spatial.hpp"

namespace fathom::estimation {
namespace {

const Eigen::Vector3d kGravity{0.0, 0.0, 9.81};  // m/s^2, NED

}  // namespace

Gains first_order_gains(double cutoff, double dt) { return {.value = dt / (dt + 1.0 / cutoff)}; }

Gains second_order_gains(double cutoff, double damping, double dt) {
  const double square = cutoff * cutoff;
  const double x = (2.0 * damping * cutoff + dt * square) * dt;
  return {.value = x / (1.0 + x), .rate = dt * square / (1.0 + x)};
}

Gains third_order_gains(double cutoff, double damping, double dt) {
  const double a = (2.0 * damping + 1.0) * cutoff;
  const double b = (2.0 * damping + 1.0) * cutoff * cutoff;
  const double c = cutoff * cutoff * cutoff;
  const double x = (a + (b + c * dt) * dt) * dt;
  return {.value = x / (1.0 + x), .rate = (b + c * dt) * dt / (1.0 + x), .second = c * dt / (1.0 + x)};
}

// Backward Euler's shares of value, rate and second depend on the interval. Two sources that disagree by e, one of
// which skips a measurement now and then, then cancel in the second but not in the value, and a false speed makes up
// for it.
Gains proportional_third_order_gains(double cutoff, double damping, double dt) {
  constexpr double kStable = 2.0;  // cutoff times dt; from 2.3 on a source that is alone would make it swing
  if (cutoff * dt > kStable) return third_order_gains(cutoff, damping, dt);
  const double a = (2.0 * damping + 1.0) * cutoff;
  const double value = a * dt / (1.0 + a * dt);
  return {.value = value, .rate = cutoff * value, .second = cutoff * cutoff / (2.0 * damping + 1.0) * value};
}

void PairCovariance::predict(double coupling, double dt, double noise_xx, double noise_xr, double noise_rr) {
  const double h = coupling * dt;
  xx += 2.0 * h * xr + h * h * rr + noise_xx;
  xr += h * rr + noise_xr;
  rr += noise_rr;
}

// Joseph's form: right for any gain.
void PairCovariance::correct_value(double gain_x, double gain_r, double noise) {
  const double xx0 = xx, xr0 = xr;
  const double keep = 1.0 - gain_x;
  xx = keep * keep * xx0 + gain_x * gain_x * noise;
  xr = keep * (xr0 - gain_r * xx0) + gain_x * gain_r * noise;
  rr += gain_r * gain_r * (xx0 + noise) - 2.0 * gain_r * xr0;
}

void PairCovariance::correct_rate(double gain, double noise) {
  const double keep = 1.0 - gain;
  xr *= keep;
  rr = keep * keep * rr + gain * gain * noise;
}

AttitudeFilter::AttitudeFilter(double cutoff, double damping, const Noise& noise)
    : cutoff_{cutoff}, damping_{damping}, noise_{noise} {}

void AttitudeFilter::start(const Eigen::Quaterniond& q_WB, double sigma) {
  q_WB_ = q_WB;
  const double rate_prior = 1.0;  // rad/s: what vehicles do
  with_gyro_ = {sigma * sigma, 0.0, noise_.bias_prior * noise_.bias_prior};
  without_ = {sigma * sigma, 0.0, rate_prior * rate_prior};
}

void AttitudeFilter::set_gyro(const Eigen::Vector3d& w) {
  if (!has_gyro_) with_gyro_.xx = without_.xx > 0.0 ? without_.xx : with_gyro_.xx;
  gyro_ = w;
  has_gyro_ = true;
}

void AttitudeFilter::drop_gyro() {
  if (!has_gyro_) return;
  rate_ = gyro_ - bias_;
  const double sigma = sigma_rates();
  without_ = {with_gyro_.xx, 0.0, sigma * sigma};
  has_gyro_ = false;
}

void AttitudeFilter::predict(double dt) { predict(dt, gyro_); }

void AttitudeFilter::predict(double dt, const Eigen::Vector3d& mean_gyro) {
  const Eigen::Vector3d rate = has_gyro_ ? Eigen::Vector3d(mean_gyro - bias_) : rate_;
  q_WB_ = (q_WB_ * quaternion_from_rotation_vector(rate * dt)).normalized();
  const double step = noise_.rate * dt;
  with_gyro_.predict(-1.0, dt, step * step, 0.0, noise_.bias_walk * noise_.bias_walk * dt);
  const double walk = noise_.rate_walk * noise_.rate_walk;
  without_.predict(1.0, dt, walk * dt * dt * dt / 3.0, walk * dt * dt / 2.0, walk * dt);
}

Eigen::Vector3d AttitudeFilter::innovation(const Eigen::Quaterniond& measured) const {
  return rotation_vector_from_quaternion(q_WB_.conjugate() * measured);
}

void AttitudeFilter::correct(const Eigen::Vector3d& innovation, double interval, double sigma) {
  const Gains gains = second_order_gains(cutoff_, damping_, interval);
  q_WB_ = (q_WB_ * quaternion_from_rotation_vector(gains.value * innovation)).normalized();
  if (has_gyro_) {
    bias_ -= gains.rate * innovation;
    with_gyro_.correct_value(gains.value, -gains.rate, sigma * sigma);
  } else {
    rate_ += gains.rate * innovation;
    without_.correct_value(gains.value, gains.rate, sigma * sigma);
  }
}

double AttitudeFilter::sigma_rotation() const { return std::sqrt(has_gyro_ ? with_gyro_.xx : without_.xx); }

double AttitudeFilter::sigma_rates() const {
  return has_gyro_ ? std::sqrt(noise_.rate * noise_.rate + with_gyro_.rr) : std::sqrt(without_.rr);
}

TranslationFilter::TranslationFilter(double cutoff, double damping, double velocity_cutoff, const Noise& noise)
    : cutoff_{cutoff}, damping_{damping}, velocity_cutoff_{velocity_cutoff}, noise_{noise} {}

void TranslationFilter::start(const Eigen::Vector3d& p_WB, const Eigen::Vector3d& sigma) {
  p_WB_ = p_WB;
  v_WB_.setZero();
  for (int i = 0; i < 3; ++i) {
    covariance_[i] = {sigma[i] * sigma[i], 0.0, noise_.velocity_prior * noise_.velocity_prior};
  }
}

void TranslationFilter::grow(double dt) {
  const double walk = noise_.acceleration * noise_.acceleration;
  for (PairCovariance& one : covariance_) {
    one.predict(1.0, dt, walk * dt * dt * dt / 3.0, walk * dt * dt / 2.0, walk * dt);
  }
}

void TranslationFilter::predict(double dt, const Eigen::Matrix3d& turn) {
  has_force_ = false;
  const Eigen::Vector3d before = v_WB_;
  v_WB_ = turn * before;
  p_WB_ += 0.5 * dt * (before + v_WB_);
  grow(dt);
}

void TranslationFilter::predict(double dt, const Eigen::Matrix3d& R_WB, const Eigen::Vector3d& f_B) {
  has_force_ = true;
  const Eigen::Vector3d a_W = R_WB * (f_B - bias_) + kGravity;
  p_WB_ += dt * v_WB_ + 0.5 * dt * dt * a_W;
  v_WB_ += dt * a_W;
  grow(dt);
}

void TranslationFilter::correct_position(const Eigen::Vector3d& innovation, const Eigen::Vector3d& axes,
                                         double interval, double sigma, const Eigen::Matrix3d& R_WB) {
  const Gains gains =
      has_force_ ? third_order_gains(cutoff_, damping_, interval) : second_order_gains(cutoff_, damping_, interval);
  const Eigen::Vector3d seen = axes.cwiseProduct(innovation);
  p_WB_ += gains.value * seen;
  v_WB_ += gains.rate * seen;
  bias_ -= gains.second * (R_WB.transpose() * seen);
  for (int i = 0; i < 3; ++i) {
    if (axes[i] > 0.0) covariance_[i].correct_value(gains.value, gains.rate, sigma * sigma);
  }
}

void TranslationFilter::correct_velocity(const Eigen::Vector3d& innovation_W, double interval, double sigma) {
  const double gain = first_order_gains(velocity_cutoff_, interval).value;
  v_WB_ += gain * innovation_W;
  for (PairCovariance& one : covariance_) one.correct_rate(gain, sigma * sigma);
}

Eigen::Vector3d TranslationFilter::sigma_position() const {
  return {std::sqrt(covariance_[0].xx), std::sqrt(covariance_[1].xx), std::sqrt(covariance_[2].xx)};
}

Eigen::Vector3d TranslationFilter::sigma_velocity_body(const Eigen::Matrix3d& R_WB) const {
  const Eigen::Vector3d variance{covariance_[0].rr, covariance_[1].rr, covariance_[2].rr};
  const Eigen::Matrix3d squares = R_WB.transpose().cwiseAbs2();
  return (squares * variance).cwiseSqrt();
}

}  // namespace fathom::estimation
