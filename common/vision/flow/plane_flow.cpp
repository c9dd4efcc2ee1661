#include "common/vision/flow/plane_flow.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

namespace fathom::vision {
namespace {

constexpr int kRounds = 10;
constexpr double kTukey = 4.685;    // 95 % efficient on normal errors
constexpr double kSettled = 1e-7;   // 5e-5 px at 500 px
constexpr double kSmallest = 2e-5;  // spread below which nothing is measured: 0.01 px at 500 px

Eigen::Matrix<double, 2, 3> jacobian(const FlowRow& row) {
  Eigen::Matrix<double, 2, 3> a;
  a << -row.s, 0.0, row.s * row.y.x(), 0.0, -row.s, row.s * row.y.y();
  return a;
}

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// How many times larger the variance is than that of tracks which err each for itself: moving light, or a floor that is
// no plane, moves neighbours alike. By what the tracks of each part of the picture push the fit together (a
// cluster-robust covariance, Liang and Zeger 1986, in the mean over the three directions).
double shared_error(const std::vector<FlowRow>& rows, const PlaneFlow& fitted, const Eigen::Matrix3d& information) {
  constexpr int kAcross = 4, kDown = 3, kLeast = 4;  // parts of the picture; fewer tell nothing
  Eigen::Vector2d low{1e9, 1e9}, high{-1e9, -1e9};
  for (const FlowRow& row : rows) {
    low = low.cwiseMin(row.y);
    high = high.cwiseMax(row.y);
  }
  const Eigen::Vector2d extent = (high - low).cwiseMax(1e-6);
  std::array<Eigen::Vector3d, kAcross * kDown> push;
  std::array<int, kAcross * kDown> count{};
  push.fill(Eigen::Vector3d::Zero());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!fitted.agrees[i]) continue;
    const Eigen::Vector2d share = (rows[i].y - low).cwiseQuotient(extent);
    const int column = std::min(static_cast<int>(share.x() * kAcross), kAcross - 1);
    const int row = std::min(static_cast<int>(share.y() * kDown), kDown - 1);
    const auto part = static_cast<std::size_t>(row * kAcross + column);
    const auto a = jacobian(rows[i]);
    push[part] += a.transpose() * (rows[i].d - a * fitted.tau);
    ++count[part];
  }
  const auto parts = std::count_if(count.begin(), count.end(), [](int n) { return n > 0; });
  if (parts < kLeast) return 1.0;
  double sum = 0.0;
  for (const Eigen::Vector3d& each : push) sum += each.dot(information.ldlt().solve(each));
  const double few = static_cast<double>(parts) / (static_cast<double>(parts) - 1.5);  // three unknowns, two per part
  return std::max(few * sum / (3.0 * fitted.spread * fitted.spread), 1.0);
}

}  // namespace

PlaneFlow fit_plane_flow(const std::vector<FlowRow>& rows) {
  PlaneFlow result;
  const std::size_t n = rows.size();
  result.agrees.assign(n, false);
  const auto odd = [](const FlowRow& row) { return !row.d.allFinite() || !row.y.allFinite() || !std::isfinite(row.s); };
  if (n < 3 || std::ranges::any_of(rows, odd)) return result;
  // A start that half of the tracks cannot spoil: the median shift.
  std::vector<double> values(n);
  for (Eigen::Index axis = 0; axis < 2; ++axis) {
    for (std::size_t i = 0; i < n; ++i) values[i] = -rows[i].d[axis] / rows[i].s;
    result.tau[axis] = median(values);
  }
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  double sigma = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t i = 0; i < n; ++i) values[i] = (jacobian(rows[i]) * result.tau - rows[i].d).norm();
    // The median length of a plane error is 1.177 standard deviations of one axis.
    std::vector<double> sorted = values;
    sigma = std::max(median(sorted) / 1.1774, kSmallest);
    information.setZero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < n; ++i) {
      const double u = values[i] / (kTukey * sigma);
      if (u >= 1.0) continue;
      const double weight = (1.0 - u * u) * (1.0 - u * u);
      const auto a = jacobian(rows[i]);
      information += weight * a.transpose() * a;
      right += weight * a.transpose() * rows[i].d;
    }
    const Eigen::Vector3d tau = information.ldlt().solve(right);
    if (!tau.allFinite()) return {.agrees = std::vector<bool>(n, false)};
    const double moved = (tau - result.tau).norm();
    result.tau = tau;
    if (moved < kSettled) break;
  }
  double squares = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double e = (jacobian(rows[i]) * result.tau - rows[i].d).norm();
    result.agrees[i] = e < 3.5 * sigma;
    if (!result.agrees[i]) continue;
    ++result.n_agreed;
    squares += e * e;
  }
  result.spread = std::max(std::sqrt(squares / std::max(2.0 * result.n_agreed - 3.0, 1.0)), kSmallest);
  result.covariance = result.spread * result.spread * information.inverse();
  result.covariance *= shared_error(rows, result, information);
  return result;
}

Eigen::Matrix3d error_by_rotation(const std::vector<FlowRow>& rows, const PlaneFlow& fitted) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero(), right = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!fitted.agrees[i]) continue;
    const Eigen::Vector2d& y = rows[i].y;
    Eigen::Matrix<double, 2, 3> by_turn;  // y moves with the direction (y, 1) that is turned
    by_turn << -y.x() * y.y(), 1.0 + y.x() * y.x(), -y.y(), -1.0 - y.y() * y.y(), y.x() * y.y(), y.x();
    const auto a = jacobian(rows[i]);
    information += a.transpose() * a;
    right += a.transpose() * by_turn;
  }
  return information.ldlt().solve(right);
}

}  // namespace fathom::vision
