#include "common/consistency/conventions/evidence.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

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

constexpr double kWindow = 1.0;            // s
constexpr std::size_t kFewestSamples = 5;  // in a window
constexpr std::size_t kMostWindows = 400;  // of a recording, spread evenly
constexpr std::size_t kFewestWindows = 12;
constexpr double kLongestDelay = 1.0;  // s
constexpr double kDelayStep = 0.05;    // s
constexpr double kDelaySeen = 0.7;     // correlation of speeds that shows a delay
constexpr double kDelayBetter = 0.05;  // more correlation than without one
constexpr double kFreedom = 4.0;       // of Student's t
// Smaller misfits are no evidence: quadrature, rounding, lever arms.
constexpr std::array<double, kRelations> kFloor{0.004 /* m */, 0.004 /* rad */, 0.05 /* m/s^2 */, 0.01 /* m */};
constexpr std::array<double, kRelations> kDimension{3.0, 3.0, 3.0, 1.0};
constexpr std::array<double, kRelations> kMedianChi2{2.366, 2.366, 2.366, 0.455};  // median of chi-square
constexpr double kMostBias =
    0.5;  // m/s^2: 50 mg of an accelerometer's zero, or 3 deg of its mount and the attitude's level
constexpr double kUpsideDown = 15.0;  // nats: vehicles do not run keel up
constexpr std::size_t kMemory = 6;    // windows over which misfits may be alike (Newey-West)

/// sum over the window of w R_ij x_l; rows i + 3 j.
using Tensor = Eigen::Matrix<double, 9, 3>;

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

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const double n = static_cast<double>(a.size());
  double sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    sa += a[i], sb += b[i], saa += a[i] * a[i], sbb += b[i] * b[i], sab += a[i] * b[i];
  const double va = saa - sa * sa / n, vb = sbb - sb * sb / n;
  return va > 0.0 && vb > 0.0 ? (sab - sa * sb / n) / std::sqrt(va * vb) : 0.0;
}

/// By how much the sensor's stamps lag: where its magnitude goes best with the reference's, whatever their axes.
double delay_of(const std::vector<double>& t, const std::vector<double>& magnitude, const Series& sensor) {
  if (sensor.size() < 2 || t.size() < kFewestWindows) return 0.0;
  const Spline spline(sensor);
  const auto at = [&](double delay) {
    std::vector<double> a, b;
    Vector3d x;
    for (std::size_t i = 0; i < t.size(); ++i) {
      if (!spline.at(t[i] + delay, x)) continue;
      a.push_back(magnitude[i]);
      b.push_back(x.norm());
    }
    return a.size() < kFewestWindows ? 0.0 : correlation(a, b);
  };
  const double none = at(0.0);
  double best = none, delay = 0.0;
  for (int k = 1; k * kDelayStep <= kLongestDelay + 1e-9; ++k) {
    for (const double one : {k * kDelayStep, -k * kDelayStep}) {
      const double c = at(one);
      if (c > best) best = c, delay = one;
    }
  }
  return best > kDelaySeen && best > none + kDelayBetter ? delay : 0.0;
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

/// One way to read the attitude: everything else is linear in what a window holds.
struct Evidence::Windows {
  struct One {
    bool has_velocity{}, has_rates{}, has_force{}, has_depth{};
    Vector3d moved{Vector3d::Zero()};     // m, of the position
    Vector3d straight{Vector3d::Zero()};  // integral of the velocity as it is, m
    double deeper{};                      // m, by the depth sensor
    Tensor velocity{Tensor::Zero()}, rates{Tensor::Zero()}, force{Tensor::Zero()};
    Matrix3d turned{Matrix3d::Zero()};       // R(end) - R(begin)
    Matrix3d mean{Matrix3d::Zero()};         // integral of R, s
    Matrix3d euler_cross{Matrix3d::Zero()};  // integral of R [body rates of the logged Euler rates]x
    double length{};                         // s
  };
  std::vector<One> all;
};

Evidence::Evidence(const PoseSeries& pose, const Series& velocity, const Series& rates, const Series& force,
                   const Series& depth)
    : pose_(pose), velocity_(velocity), rates_(rates), force_(force), depth_(depth) {
  heading_alone_ = pose.has_attitude && std::ranges::all_of(pose.q_WB, [](const Eigen::Quaterniond& q) {
                     constexpr double kRounding = 1e-12;
                     return std::abs(q.x()) < kRounding && std::abs(q.y()) < kRounding;
                   });
  // Speeds and rates of turn over half a second.
  const double step = estimation::typical_step(pose.t);
  if (step <= 0.0 || !pose.has_attitude) return;
  const auto span = static_cast<std::size_t>(std::max(2.0, std::round(0.4 / step)));
  const std::size_t stride = std::max<std::size_t>(1, pose.size() / 1500);
  std::vector<double> t, speed, turning;
  for (std::size_t i = 0; i + span < pose.size(); i += stride) {
    const std::size_t j = i + span;
    if (!pose.valid[i] || !pose.valid[j] || pose.t[j] - pose.t[i] > 1.5 * static_cast<double>(span) * step) continue;
    t.push_back(0.5 * (pose.t[i] + pose.t[j]));
    speed.push_back((pose.p_WB[j] - pose.p_WB[i]).norm() / (pose.t[j] - pose.t[i]));
    turning.push_back(pose.q_WB[i].angularDistance(pose.q_WB[j]) / (pose.t[j] - pose.t[i]));
  }
  if (pose.has_position) velocity_delay_ = delay_of(t, speed, velocity);
  rates_delay_ = delay_of(t, turning, rates);
}

Evidence::~Evidence() = default;
Evidence::Evidence(Evidence&&) noexcept = default;

const Evidence::Windows& Evidence::windows(const Reading& reading) const {
  auto& made = forms_[{static_cast<int>(reading.quaternion), static_cast<int>(reading.sense)}];
  if (made) return *made;
  made = std::make_unique<Windows>();
  if (!pose_.has_attitude) return *made;
  estimation::Corrections form;
  form.quaternion = reading.quaternion;
  form.heading_sense = reading.sense;
  PoseSeries pose = pose_;
  estimation::correct_pose(form, pose);
  const double step = estimation::typical_step(pose.t);
  if (step <= 0.0) return *made;
  const std::size_t count = std::max(kFewestSamples, static_cast<std::size_t>(std::lround(kWindow / step)) + 1);
  if (pose.size() < count) return *made;
  const Spline velocity(velocity_), rates(rates_), force(force_), depth(depth_);
  const std::size_t possible = (pose.size() - 1) / (count - 1);
  const std::size_t stride = (count - 1) * std::max<std::size_t>(1, possible / kMostWindows);
  for (std::size_t first = 0; first + count <= pose.size(); first += stride) {
    Windows::One one;
    bool whole = true;
    for (std::size_t i = first; i < first + count && whole; ++i)
      whole = pose.valid[i] != 0 && (i == first || pose.t[i] - pose.t[i - 1] < 2.5 * step);
    if (!whole) continue;
    const std::size_t last = first + count - 1;
    one.has_velocity = pose.has_position && !velocity_.empty();
    one.has_rates = !rates_.empty();
    one.has_force = !force_.empty();
    one.length = pose.t[last] - pose.t[first];
    one.moved = pose.p_WB[last] - pose.p_WB[first];
    one.turned = pose.q_WB[last].toRotationMatrix() - pose.q_WB[first].toRotationMatrix();
    for (std::size_t i = first; i <= last; ++i) {
      const double w = 0.5 * (pose.t[std::min(i + 1, last)] - pose.t[i == first ? first : i - 1]);
      const Matrix3d R = pose.q_WB[i].toRotationMatrix();
      const Eigen::Map<const Eigen::Matrix<double, 9, 1>> r(R.data());
      Vector3d x;
      one.mean += w * R;
      if (one.has_velocity && (one.has_velocity = velocity.at(pose.t[i] + velocity_delay_, x))) {
        one.velocity += w * r * x.transpose();
        one.straight += w * x;
      }
      if (one.has_rates && (one.has_rates = rates.at(pose.t[i] + rates_delay_, x))) {
        one.rates += w * r * x.transpose();
        one.euler_cross += w * R * skew(estimation::body_rates(x, pose.q_WB[i]));
      }
      if (one.has_force && (one.has_force = force.at(pose.t[i], x))) one.force += w * r * x.transpose();
    }
    Vector3d from, to;
    one.has_depth = pose.has_position && !depth_.empty() && depth.at(pose.t[first], from) && depth.at(pose.t[last], to);
    if (one.has_depth) one.deeper = to.z() - from.z();
    made->all.push_back(one);
  }
  return *made;
}

bool Evidence::speaks() const {
  const Windows& all = windows({});
  const auto tells = [](const Windows::One& one) { return one.has_velocity || one.has_rates || one.has_force; };
  return std::ranges::count_if(all.all, tells) >= static_cast<std::ptrdiff_t>(kFewestWindows);
}

namespace {

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

}  // namespace

Judged Evidence::judge(const Reading& reading) const {
  const std::vector<Windows::One>& all = windows(reading).all;
  const double none = std::nan("");
  Judged judged;
  judged.unexplained.fill(1.0);
  judged.log_likelihood.assign(all.size(), 0.0);
  const Matrix3d &W = reading.attitude_world, &A = reading.attitude_axes;
  std::vector<double> squares(all.size(), none);
  double energy = 0.0;

  // Travel: P dp = c R_h W (integral of R A Q v); c is free, for units are another matter.
  std::vector<Vector3d> y(all.size()), x(all.size());
  double xx = 0.0, xy = 0.0, sine = 0.0, cosine = 0.0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Windows::One& one = all[i];
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

  // Turning: (integral of R [A Q w]x) = c (R1 - R0) + (integral of R) [b]x; c and the bias b are free. The sensor's is
  // the side that no reading of the attitude changes in size.
  squares.assign(all.size(), none);
  energy = 0.0;
  std::vector<Eigen::Matrix<double, 9, 5>> rows(all.size());
  Eigen::Matrix4d h = Eigen::Matrix4d::Zero();
  Eigen::Vector4d g = Eigen::Vector4d::Zero();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Windows::One& one = all[i];
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
    Eigen::Vector4d fit = h.ldlt().solve(g);
    if (fit[0] < 0.0) {
      fit[0] = 0.0;
      fit.tail<3>() = h.bottomRightCorner<3, 3>().ldlt().solve(g.tail<3>());
    }
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all[i].has_rates) squares[i] = 0.5 * (rows[i].col(4) - rows[i].leftCols<4>() * fit).squaredNorm();
    }
  }
  add_relation(kTurning, squares, energy, judged);

  // Gravity: mean of R_WB (f - b) = -c e_z, and the vehicle's own acceleration as noise. The bias b is free within what
  // accelerometers and mounts do: of a craft that keeps its attitude a small misfit says nothing about axes.
  squares.assign(all.size(), none);
  energy = 0.0;
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
    Vector3d bias = normal.ldlt().solve(right);
    if (const double most = kMostBias / unit; bias.norm() > most) bias *= most / bias.norm();
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all[i].has_force)
        squares[i] = unit * unit * (x[i] + felt * Vector3d::UnitZ() - turn_of(i) * bias).squaredNorm();
    }
    energy *= unit * unit;
  }
  add_relation(kGravity, squares, energy, judged);

  // Depth: how much deeper, by sensor and by position.
  squares.assign(all.size(), none);
  energy = xx = xy = 0.0;
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

  double keel_down = 0.0;
  for (const Windows::One& one : all) keel_down += (W * one.mean * A)(2, 2);
  judged.upside_down = keel_down < 0.0;
  return judged;
}

}  // namespace fathom::consistency
