// Windows and quadrature of the three kinematic identities. All equations are turned into the body frame in the middle
// of their window, so that a window's three lines belong to body axes.
#include <algorithm>
#include <cmath>

#include "common/base/spatial.hpp"
#include "common/base/statistics.hpp"
#include "common/estimation/compatibility.hpp"

namespace fathom::estimation {
namespace {

constexpr double kWindow = 0.8;  // s: long enough to beat noise, short enough to keep a 0.5 Hz motion
constexpr double kStride = 0.2;  // s
constexpr double kGravity = 9.81;

/// Mean variance of the attitude's white noise about one axis, rad^2.
double attitude_variance(const PoseSeries& pose) {
  double variance = 0.0;
  for (int k = 0; k < 3; ++k) {
    std::vector<double> step;
    for (std::size_t i = 1; i < pose.size(); ++i) {
      step.push_back(rotation_vector_from_quaternion(pose.q_WB[i - 1].conjugate() * pose.q_WB[i])[k]);
    }
    // Third differences of steps are fourth differences of the angle: variance 70 instead of 20.
    variance += std::pow(white_noise_sigma(step), 2) * 20.0 / 70.0 / 3.0;
  }
  return variance;
}

struct Frame {
  IncrementProblem problem;
  double squared{};
  void begin(const PoseSeries& pose) {
    problem.t = pose.t;
    problem.step = typical_step(pose.t);
  }
  /// Calls use(first, count, weights, R_BW in the middle) for every unbroken window.
  template <class Use>
  void windows(const PoseSeries& pose, double length, Use use) {
    const double step = problem.step;
    if (step <= 0.0) return;
    int intervals = std::max(8, static_cast<int>(std::lround(length / step)));
    intervals += intervals % 2;  // the triangle needs a middle
    const int stride = std::max(1, static_cast<int>(std::lround(kStride / step)));
    const int n = static_cast<int>(pose.size());
    for (int first = 0; first + intervals < n; first += stride) {
      bool whole = true;
      for (int i = first; i <= first + intervals && whole; ++i) {
        const auto k = static_cast<std::size_t>(i);
        whole = pose.valid[k] != 0 && (i == first || pose.t[k] - pose.t[k - 1] < 1.8 * step);
      }
      if (!whole) continue;
      const Eigen::Matrix3d R_BW =
          pose.q_WB[static_cast<std::size_t>(first + intervals / 2)].toRotationMatrix().transpose();
      use(first, intervals + 1, quadrature_weights(&pose.t[static_cast<std::size_t>(first)], intervals + 1), R_BW);
    }
    if (!problem.windows.empty()) problem.squared_weight = squared / static_cast<double>(problem.windows.size()) / step;
  }
  void add(int first, int count, const Eigen::Vector3d& y, const Eigen::Matrix<double, 3, Eigen::Dynamic>& fixed) {
    problem.windows.push_back({first, count, static_cast<int>(problem.basis.size()) - count});
    problem.y.push_back(y);
    problem.fixed.push_back(fixed);
    problem.fixed_columns = static_cast<int>(fixed.cols());
  }
};

}  // namespace

IncrementProblem rate_problem(const PoseSeries& pose) {
  Frame frame;
  frame.begin(pose);
  frame.windows(
      pose, kWindow, [&](int first, int count, const std::vector<double>& weight, const Eigen::Matrix3d& R_BW) {
        Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
        for (int s = 0; s < count; ++s) {
          const Eigen::Matrix3d A = R_BW * pose.q_WB[static_cast<std::size_t>(first + s)].toRotationMatrix();
          const double w = weight[static_cast<std::size_t>(s)];
          // The antisymmetric part of A [u]x is [B u]x with this B.
          const Eigen::Matrix3d B = 0.5 * w * (A.trace() * Eigen::Matrix3d::Identity() - A.transpose());
          frame.problem.basis.push_back(B);
          frame.squared += w * w;
          sum += B;
        }
        const Eigen::Matrix3d change =
            R_BW * (pose.q_WB[static_cast<std::size_t>(first + count - 1)].toRotationMatrix() -
                    pose.q_WB[static_cast<std::size_t>(first)].toRotationMatrix());
        const Eigen::Vector3d y = 0.5 * Eigen::Vector3d(change(2, 1) - change(1, 2), change(0, 2) - change(2, 0),
                                                        change(1, 0) - change(0, 1));
        frame.add(first, count, y, sum);
      });
  return std::move(frame.problem);
}

IncrementProblem velocity_problem(const PoseSeries& pose, const Series* rates) {
  Frame frame;
  frame.begin(pose);
  const Spline spline(rates != nullptr ? *rates : Series{});
  const int columns = rates != nullptr ? 13 : 7;
  frame.windows(
      pose, kWindow, [&](int first, int count, const std::vector<double>& weight, const Eigen::Matrix3d& R_BW) {
        Eigen::Matrix<double, 3, Eigen::Dynamic> fixed = Eigen::Matrix<double, 3, Eigen::Dynamic>::Zero(3, columns);
        const std::size_t basis_before = frame.problem.basis.size();
        double squared = 0.0;
        for (int s = 0; s < count; ++s) {
          const auto i = static_cast<std::size_t>(first + s);
          const double w = weight[static_cast<std::size_t>(s)];
          const Eigen::Matrix3d A = w * R_BW * pose.q_WB[i].toRotationMatrix();
          frame.problem.basis.push_back(A);
          squared += w * w;
          fixed.leftCols<3>() += A;
          if (rates == nullptr) continue;
          Eigen::Vector3d omega;
          if (!spline.at(pose.t[i], omega)) {
            frame.problem.basis.resize(basis_before);
            return;
          }
          for (std::size_t k = 0; k < kSymmetric.size(); ++k) {
            const auto [a, b] = kSymmetric[k];
            fixed.col(7 + static_cast<int>(k)) += A.col(a) * omega[b];
            if (a != b) fixed.col(7 + static_cast<int>(k)) += A.col(b) * omega[a];
          }
        }
        const auto i0 = static_cast<std::size_t>(first);
        const auto i1 = static_cast<std::size_t>(first + count - 1);
        // A lever arm's share is exact: the sensor's point moved by the change of R r more than the origin.
        fixed.middleCols<3>(3) = -R_BW * (pose.q_WB[i1].toRotationMatrix() - pose.q_WB[i0].toRotationMatrix());
        const Eigen::Vector3d y = R_BW * (pose.p_WB[i1] - pose.p_WB[i0]);
        fixed.col(6) = R_BW.col(2).cross(y);
        frame.squared += squared;
        frame.add(first, count, y, fixed);
      });
  frame.problem.lever = 3;
  frame.problem.lever_noise = 4.0 * attitude_variance(pose);  // two attitudes, two axes across each column
  return std::move(frame.problem);
}

IncrementProblem acceleration_problem(const PoseSeries& pose) {
  Frame frame;
  frame.begin(pose);
  // Twice the window: position noise enters with 1 / L^2.
  frame.windows(
      pose, 2.0 * kWindow, [&](int first, int count, const std::vector<double>& weight, const Eigen::Matrix3d& R_BW) {
        const auto i0 = static_cast<std::size_t>(first);
        const auto im = static_cast<std::size_t>(first + count / 2);
        const auto i1 = static_cast<std::size_t>(first + count - 1);
        const double half = 0.5 * (pose.t[i1] - pose.t[i0]);
        double area = 0.0;
        std::vector<double> triangle(static_cast<std::size_t>(count));
        for (int s = 0; s < count; ++s) {
          const auto k = static_cast<std::size_t>(s);
          triangle[k] = weight[k] * (half - std::abs(pose.t[i0 + k] - pose.t[i0] - half)) / (half * half);
          area += triangle[k];
        }
        for (int s = 0; s < count; ++s) {
          const auto k = static_cast<std::size_t>(s);
          const Eigen::Matrix3d A = triangle[k] / area * R_BW * pose.q_WB[i0 + k].toRotationMatrix();
          frame.problem.basis.push_back(A);
          frame.squared += triangle[k] * triangle[k];
        }
        Eigen::Matrix<double, 3, Eigen::Dynamic> fixed(3, 3);
        const auto rotation = [&](std::size_t i) { return pose.q_WB[i].toRotationMatrix(); };
        fixed = -R_BW * (rotation(i1) - 2.0 * rotation(im) + rotation(i0)) / (half * half);
        const Eigen::Vector3d y = R_BW * ((pose.p_WB[i1] - 2.0 * pose.p_WB[im] + pose.p_WB[i0]) / (half * half) -
                                          kGravity * Eigen::Vector3d::UnitZ());
        frame.add(first, count, y, fixed);
      });
  frame.problem.lever = 0;
  // Weights 1 -2 1, two axes, over the square of half the window.
  frame.problem.lever_noise = 12.0 * attitude_variance(pose) / std::pow(kWindow, 4);
  return std::move(frame.problem);
}

}  // namespace fathom::estimation
