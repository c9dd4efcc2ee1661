#include "common/estimation/smoothing/turned_package.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/base/factors.hpp"
#include "common/base/spatial.hpp"
#include "common/base/statistics.hpp"

namespace fathom::estimation {
namespace {

constexpr double kWindow = 2.0;        // s: an attitude's own filter follows within it, its error hardly wanders
constexpr double kLongestStep = 0.1;   // s between samples whose rates are still summed
constexpr std::size_t kFewest = 30;    // windows
constexpr double kLeastKnown = 0.01;   // rad: worse than the mount of any instrument
constexpr double kLeastSpread = 1e-5;  // rad, of what windows leave: rounding
constexpr int kRounds = 4;             // of weighing

struct Window {
  Eigen::Vector3d told, summed;  // rad, rotation vectors by attitude and by rates
  double length{};               // s
};

std::vector<Window> windows_of(std::span<const Ahrs> stream) {
  std::vector<Window> windows;
  const Ahrs* begin = nullptr;
  const Ahrs* before = nullptr;
  Eigen::Quaterniond sum = Eigen::Quaterniond::Identity();
  for (const Ahrs& one : stream) {
    if (!one.has_rates || !one.has_attitude) {
      begin = before = nullptr;
      continue;
    }
    const double dt = before != nullptr ? seconds_between(before->utime, one.utime) : -1.0;
    if (begin == nullptr || !(dt > 0.0 && dt <= kLongestStep)) {
      if (begin != nullptr && dt == 0.0) continue;
      begin = before = &one;
      sum.setIdentity();
      continue;
    }
    sum = sum * quaternion_from_rotation_vector(0.5 * dt * (before->w_WB_B + one.w_WB_B));
    before = &one;
    const double length = seconds_between(begin->utime, one.utime);
    if (length < kWindow) continue;
    windows.push_back({rotation_vector_from_quaternion(begin->q_WB.conjugate() * one.q_WB),
                       rotation_vector_from_quaternion(sum), length});
    begin = &one;
    sum.setIdentity();
  }
  return windows;
}

}  // namespace

std::optional<TurnedPackage> turned_package(std::span<const Ahrs> stream) {
  const std::vector<Window> windows = windows_of(stream);
  if (windows.size() < kFewest) return std::nullopt;
  Eigen::MatrixXd information;
  Vector6d x = Vector6d::Zero();  // turn, bias
  double spread = 0.0;
  const auto left = [&](const Window& one) {
    return Eigen::Vector3d{one.summed - one.told - one.told.cross(Eigen::Vector3d{x.head<3>()}) -
                           one.length * x.tail<3>()};
  };
  for (int round = 0; round < kRounds; ++round) {
    std::vector<double> residuals;
    for (const Window& one : windows) residuals.push_back(left(one).norm() / std::sqrt(3.0));
    spread = std::max(median(residuals), kLeastSpread);
    information = Eigen::MatrixXd::Zero(6, 6);
    Vector6d right = Vector6d::Zero();
    for (std::size_t i = 0; i < windows.size(); ++i) {
      const double weight = huber_weight(residuals[i] / spread);
      Eigen::Matrix<double, 3, 6> row;
      row << skew(windows[i].told), windows[i].length * Eigen::Matrix3d::Identity();
      information += weight * row.transpose() * row;
      right += weight * row.transpose() * (windows[i].summed - windows[i].told);
    }
    x = solve_symmetric(information, right);
    if (!x.allFinite()) return std::nullopt;
  }
  const Eigen::MatrixXd covariance = inverse_symmetric(information);
  const double sigma = 1.5 * spread * std::sqrt(std::max(covariance.diagonal().head<3>().maxCoeff(), 0.0));
  if (!(sigma > 0.0 && sigma < kLeastKnown)) return std::nullopt;
  return TurnedPackage{x.head<3>(), sigma};
}

}  // namespace fathom::estimation
