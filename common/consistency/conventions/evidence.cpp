#include "common/consistency/conventions/evidence.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "common/base/factors.hpp"
#include "common/base/spatial.hpp"
#include "common/base/statistics.hpp"

namespace fathom::consistency {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using estimation::PoseSeries;
using estimation::Series;
using estimation::Spline;
using estimation::VectorFrame;

constexpr std::size_t kFewestWindows = 12;
constexpr double kFreedom = 4.0;  // of Student's t
// Smaller misfits are no evidence: quadrature, rounding, lever arms.
constexpr std::array<double, kRelations> kFloor{0.004 /* m */, 0.004 /* rad */, 0.05 /* m/s^2 */, 0.01 /* m */};
constexpr std::array<double, kRelations> kDimension{3.0, 3.0, 3.0, 1.0};
constexpr std::array<double, kRelations> kMedianChi2{2.366, 2.366, 2.366, 0.455};  // median of chi-square
constexpr double kMostBias =
    0.5;  // m/s^2: 50 mg of an accelerometer's zero, or 3 deg of its mount and the attitude's level
constexpr double kUpsideDown = 15.0;  // nats: vehicles do not run keel up
constexpr std::size_t kMemory = 6;    // windows over which misfits may be alike (Newey-West)

/// sum_jl T_ij,l Q_jl: the integral of R Q x.
Vector3d contract(const Tensor& T, const Matrix3d& Q) {
  Vector3d sum = Vector3d::Zero();
  for (int j = 0; j < 3; ++j) {
    for (int l = 0; l < 3; ++l) sum += T.block<3, 1>(3 * j, l) * Q(j, l);
  }
  return sum;
}
/// The integral of R [Q x]x.
Matrix3d contract_cross(const Tensor& T, const Matrix3d& Q) {
  std::array<Matrix3d, 3> by;  // by[m]: integral of R times component m of Q x
  for (int m = 0; m < 3; ++m) {
    Eigen::Matrix<double, 9, 1> sum = Eigen::Matrix<double, 9, 1>::Zero();
    for (int l = 0; l < 3; ++l) sum += T.col(l) * Q(m, l);
    by[static_cast<std::size_t>(m)] = Eigen::Map<const Matrix3d>(sum.data());
  }
  Matrix3d result;  // columns of [u]x: (0, u3, -u2), (-u3, 0, u1), (u2, -u1, 0)
  result.col(0) = by[2].col(1) - by[1].col(2);
  result.col(1) = by[0].col(2) - by[2].col(0);
  result.col(2) = by[1].col(0) - by[0].col(1);
  return result;
}
/// The integral of [Q x]x R.
Matrix3d cross_contract(const Tensor& T, const Matrix3d& Q) {
  std::array<Matrix3d, 3> by;
  for (int m = 0; m < 3; ++m) {
    Eigen::Matrix<double, 9, 1> sum = Eigen::Matrix<double, 9, 1>::Zero();
    for (int l = 0; l < 3; ++l) sum += T.col(l) * Q(m, l);
    by[static_cast<std::size_t>(m)] = Eigen::Map<const Matrix3d>(sum.data());
  }
  Matrix3d result;  // rows of [u]x R: (-u3 R2 + u2 R3), (u3 R1 - u1 R3), (-u2 R1 + u1 R2)
  result.row(0) = by[1].row(2) - by[2].row(1);
  result.row(1) = by[2].row(0) - by[0].row(2);
  result.row(2) = by[0].row(1) - by[1].row(0);
  return result;
}

/// Squared misfits of one relation to log-likelihoods; windows without it have NaN.
void add_relation(Relation relation, const std::vector<double>& squares, double energy, Judged& judged) {
  std::vector<double> there;
  double sum = 0.0;
  for (const double one : squares) {
    if (std::isnan(one)) continue;
    there.push_back(one);
    sum += one;
  }
  if (there.size() < kFewestWindows || !(energy > 0.0)) return;
  judged.seen[relation] = true;
  judged.unexplained[relation] = sum / energy;
  const double floor = kFloor[relation], d = kDimension[relation];
  const double variance = std::max(median(std::move(there)) / kMedianChi2[relation], floor * floor);
  for (std::size_t i = 0; i < squares.size(); ++i) {
    if (std::isnan(squares[i])) continue;
    judged.log_likelihood[i] -=
        0.5 * d * std::log(variance) + 0.5 * (kFreedom + d) * std::log1p(squares[i] / (kFreedom * variance));
  }
}

/// Travel: P dp = c R_h W (integral of R A Q v); c is free, for units are another matter.
void judge_travel(const std::vector<EvidenceWindow>& all, const Reading& reading, Judged& judged) {
  std::vector<double> squares(all.size(), std::nan(""));
  const Matrix3d &W = reading.attitude_world, &A = reading.attitude_axes;
  std::vector<Vector3d> y(all.size()), x(all.size());
  double energy = 0.0, xx = 0.0, xy = 0.0, sine = 0.0, cosine = 0.0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const EvidenceWindow& one = all[i];
    if (!one.has_velocity) continue;
    y[i] = reading.position * one.moved;
    x[i] = reading.velocity_frame == VectorFrame::kWorld ? Vector3d(reading.velocity * one.straight)
                                                         : Vector3d(W * contract(one.velocity, A * reading.velocity));
    cosine += x[i].head<2>().dot(y[i].head<2>());
    sine += x[i].x() * y[i].y() - x[i].y() * y[i].x();
  }
  if (reading.free_heading && reading.velocity_frame == VectorFrame::kBody) {
    judged.heading = std::atan2(sine, cosine);
    const Matrix3d turn = Eigen::AngleAxisd(judged.heading, Vector3d::UnitZ()).toRotationMatrix();
    for (Vector3d& one : x) one = turn * one;
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!all[i].has_velocity) continue;
    xx += x[i].squaredNorm();
    xy += x[i].dot(y[i]);
    energy += y[i].squaredNorm();
  }
  const double travelled = xx > 0.0 ? std::max(xy / xx, 0.0) : 0.0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].has_velocity) squares[i] = (y[i] - travelled * x[i]).squaredNorm();
  }
  add_relation(kTravel, squares, energy, judged);
}

/// Turning: (integral of R [A Q w]x) = c (R1 - R0) + (integral of R) [b]x; c and the bias b are free. The sensor's is
/// the side that no reading of the attitude changes in size.
void judge_turning(const std::vector<EvidenceWindow>& all, const Reading& reading, Judged& judged) {
  std::vector<double> squares(all.size(), std::nan(""));
  double energy = 0.0;
  const Matrix3d &W = reading.attitude_world, &A = reading.attitude_axes;
  std::vector<Eigen::Matrix<double, 9, 5>> rows(all.size());
  Eigen::Matrix4d h = Eigen::Matrix4d::Zero();
  Eigen::Vector4d g = Eigen::Vector4d::Zero();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const EvidenceWindow& one = all[i];
    if (!one.has_rates) continue;
    Matrix3d by_sensor;
    if (reading.rates_frame == VectorFrame::kWorld) {
      by_sensor = cross_contract(one.rates, W.transpose() * reading.rates);
    } else if (reading.rates_frame == VectorFrame::kEulerRates) {
      by_sensor = one.euler_cross;
    } else {
      by_sensor = contract_cross(one.rates, A * reading.rates);
    }
    Eigen::Matrix<double, 9, 5>& row = rows[i];
    row.col(0) = Eigen::Map<const Eigen::Matrix<double, 9, 1>>(one.turned.data());
    for (int k = 0; k < 3; ++k) {
      const Matrix3d bias = one.mean * skew(Vector3d::Unit(k));
      row.col(1 + k) = Eigen::Map<const Eigen::Matrix<double, 9, 1>>(bias.data());
    }
    row.col(4) = Eigen::Map<const Eigen::Matrix<double, 9, 1>>(by_sensor.data());
    h += row.leftCols<4>().transpose() * row.leftCols<4>();
    g += row.leftCols<4>().transpose() * row.col(4);
    energy += 0.5 * row.col(4).squaredNorm();
  }
  if (energy > 0.0) {
    h.diagonal().array() += 1e-9 * h.trace() + 1e-12;
    Eigen::Vector4d fit = solve_symmetric(h, g);
    if (fit[0] < 0.0) {
      fit[0] = 0.0;
      fit.tail<3>() = solve_symmetric(h.bottomRightCorner<3, 3>(), g.tail<3>());
    }
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all[i].has_rates) squares[i] = 0.5 * (rows[i].col(4) - rows[i].leftCols<4>() * fit).squaredNorm();
    }
  }
  add_relation(kTurning, squares, energy, judged);
}

/// Gravity: mean of R_WB (f - b) = -c e_z, and the vehicle's own acceleration as noise. The bias b is free within what
/// accelerometers and mounts do: of a craft that keeps its attitude a small misfit says nothing about axes.
void judge_gravity(const std::vector<EvidenceWindow>& all, const Reading& reading, Judged& judged) {
  std::vector<double> squares(all.size(), std::nan(""));
  double energy = 0.0;
  std::vector<Vector3d> x(all.size());
  const Matrix3d &W = reading.attitude_world, &A = reading.attitude_axes;
  std::vector<double> up;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!all[i].has_force) continue;
    x[i] = W * contract(all[i].force, A * reading.force) / all[i].length;
    energy += x[i].squaredNorm();
    up.push_back(-x[i].z());
  }
  if (!up.empty()) {
    const double felt = std::max(median(up), 0.0);
    const double unit = felt > 0.0 ? 9.81 / felt : 9.81 / std::max(std::abs(median(up)), 1e-9);
    Matrix3d normal = Matrix3d::Zero();
    Vector3d right = Vector3d::Zero();
    const auto turn_of = [&](std::size_t i) { return Matrix3d(W * all[i].mean * A / all[i].length); };
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (!all[i].has_force) continue;
      const Matrix3d turn = turn_of(i);
      normal += turn.transpose() * turn;
      right += turn.transpose() * (x[i] + felt * Vector3d::UnitZ());
    }
    normal.diagonal().array() += 1e-9 * normal.trace() + 1e-12;
    Vector3d bias = solve_symmetric(normal, right);
    if (const double most = kMostBias / unit; bias.norm() > most) bias *= most / bias.norm();
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all[i].has_force)
        squares[i] = unit * unit * (x[i] + felt * Vector3d::UnitZ() - turn_of(i) * bias).squaredNorm();
    }
    energy *= unit * unit;
  }
  add_relation(kGravity, squares, energy, judged);
}

/// Depth: how much deeper, by sensor and by position.
void judge_depth(const std::vector<EvidenceWindow>& all, const Reading& reading, Judged& judged) {
  std::vector<double> squares(all.size(), std::nan(""));
  double energy = 0.0, xx = 0.0, xy = 0.0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!all[i].has_depth) continue;
    const double z = (reading.position * all[i].moved).z();
    xx += all[i].deeper * all[i].deeper;
    xy += all[i].deeper * z;
    energy += z * z;
  }
  const double sunk = xx > 0.0 ? std::max(xy / xx, 0.0) : 0.0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].has_depth) squares[i] = std::pow((reading.position * all[i].moved).z() - sunk * all[i].deeper, 2);
  }
  add_relation(kDepth, squares, energy, judged);
}

}  // namespace

double Judged::total() const {
  double sum = upside_down ? -kUpsideDown : 0.0;
  for (const double one : log_likelihood) sum += one;
  return sum;
}

Advantage compare(const Judged& better, const Judged& than) {
  Advantage result;
  const std::size_t n = std::min(better.log_likelihood.size(), than.log_likelihood.size());
  if (n == 0) return result;
  std::vector<double> d(n);
  double mean = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    d[i] = better.log_likelihood[i] - than.log_likelihood[i];
    mean += d[i] / static_cast<double>(n);
  }
  double variance = 0.0;
  for (std::size_t lag = 0; lag <= kMemory && lag < n; ++lag) {
    double sum = 0.0;
    for (std::size_t i = lag; i < n; ++i) sum += (d[i] - mean) * (d[i - lag] - mean);
    variance += (lag == 0 ? 1.0 : 2.0 * (1.0 - static_cast<double>(lag) / (kMemory + 1.0))) * sum;
  }
  result.gain = better.total() - than.total();
  const double sum = mean * static_cast<double>(n);
  result.z = sum == 0.0 ? 0.0 : sum / std::sqrt(std::max(variance, 1e-12 * sum * sum));
  return result;
}

Evidence::Evidence(const PoseSeries& pose, const Series& velocity, const Series& rates, const Series& force,
                   const Series& depth)
    : streams_{pose, velocity, rates, force, depth} {
  heading_alone_ = pose.has_attitude && std::ranges::all_of(pose.q_WB, [](const Eigen::Quaterniond& q) {
                     constexpr double kRounding = 1e-12;
                     return std::abs(q.x()) < kRounding && std::abs(q.y()) < kRounding;
                   });
  find_delays(streams_);
}

const std::vector<EvidenceWindow>& Evidence::windows(const Reading& reading) const {
  const std::pair form{static_cast<int>(reading.quaternion), static_cast<int>(reading.sense)};
  if (const auto made = forms_.find(form); made != forms_.end()) return made->second;
  return forms_[form] = evidence_windows(streams_, reading);
}

bool Evidence::speaks() const {
  const std::vector<EvidenceWindow>& all = windows({});
  const auto tells = [](const EvidenceWindow& one) { return one.has_velocity || one.has_rates || one.has_force; };
  return std::ranges::count_if(all, tells) >= static_cast<std::ptrdiff_t>(kFewestWindows);
}

Judged Evidence::judge(const Reading& reading) const {
  const std::vector<EvidenceWindow>& all = windows(reading);
  Judged judged;
  judged.unexplained.fill(1.0);
  judged.log_likelihood.assign(all.size(), 0.0);
  judge_travel(all, reading, judged);
  judge_turning(all, reading, judged);
  judge_gravity(all, reading, judged);
  judge_depth(all, reading, judged);
  double keel_down = 0.0;
  for (const EvidenceWindow& one : all) keel_down += (reading.attitude_world * one.mean * reading.attitude_axes)(2, 2);
  judged.upside_down = keel_down < 0.0;
  return judged;
}

}  // namespace fathom::consistency
