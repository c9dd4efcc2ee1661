// Windows and quadrature of the three kinematic identities. All equations are turned into the body frame in the middle
// of their window, so that a window's three lines belong to body axes.
#include <algorithm>
#include <cmath>
#include <span>

#include "common/base/spatial.hpp"
#include "common/base/statistics.hpp"
#include "common/consistency/pairs/pair.hpp"

namespace fathom::consistency {
namespace {

constexpr double kWindow = 0.8;  // s: long enough to beat noise, short enough to keep a 0.5 Hz motion
constexpr double kStride = 0.2;  // s
constexpr double kNominalGravity = 9.81;

constexpr double kRateAgreed =
    0.9;  // squared correlation of turns by rates and by attitude: the rest is noise in either
constexpr double kRateSeen = 30.0;  // variance of a window's turn over that of white noise: as for lever arms

/// Mean variance of the attitude's white noise about one axis, rad^2.
double attitude_variance(const PoseSeries& pose) {
  if (pose.size() < 2) return 0.0;
  const std::span<const double> before = std::span{pose.t}.first(pose.size() - 1), after = std::span{pose.t}.subspan(1);
  double variance = 0.0;
  for (int k = 0; k < 3; ++k) {
    std::vector<double> step;
    for (std::size_t i = 1; i < pose.size(); ++i) {
      step.push_back(rotation_vector_from_quaternion(pose.q_WB[i - 1].conjugate() * pose.q_WB[i])[k]);
    }
    variance += std::pow(white_noise_of_steps(before, after, step), 2) / 3.0;
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

/// Turn of a window in the body frame of its middle: the antisymmetric part of its change of attitude.
Eigen::Vector3d turn_of(const Eigen::Matrix3d& change) {
  return 0.5 * Eigen::Vector3d(change(2, 1) - change(1, 2), change(0, 2) - change(2, 0), change(1, 0) - change(0, 1));
}

/// What a rate contributes to that turn: the antisymmetric part of A [u]x is [B u]x with this B.
Eigen::Matrix3d turn_basis(const Eigen::Matrix3d& A) {
  return 0.5 * (A.trace() * Eigen::Matrix3d::Identity() - A.transpose());
}

/// About which axes the vehicle truly turns. Where an axis shows noise alone, a lever arm and a symmetric coupling act
/// on the other axes alike, and that noise would choose between them.
class TurnsSeen {
 public:
  /// One window's turn by the attitude and by the rates, rad.
  void add(const Eigen::Vector3d& attitude, const Eigen::Vector3d& rates) {
    sum_ += (Eigen::Matrix<double, 3, 5>() << attitude, rates, attitude.cwiseAbs2(), rates.cwiseAbs2(),
             attitude.cwiseProduct(rates))
                .finished();
    count_ += 1.0;
  }
  /// Variances of a window's turn from white noise alone, rad^2.
  [[nodiscard]] std::array<bool, 3> axes(double attitude_noise, const Eigen::Vector3d& rate_noise) const {
    std::array<bool, 3> seen{};
    if (count_ == 0.0) return seen;
    const Eigen::Matrix<double, 3, 5> mean = sum_ / count_;
    for (Eigen::Index k = 0; k < 3; ++k) {
      const double attitude = mean(k, 2) - mean(k, 0) * mean(k, 0), rates = mean(k, 3) - mean(k, 1) * mean(k, 1);
      const double both = mean(k, 4) - mean(k, 0) * mean(k, 1);
      seen[static_cast<std::size_t>(k)] = both > 0.0 && both * both > kRateAgreed * attitude * rates &&
                                          attitude > kRateSeen * attitude_noise && rates > kRateSeen * rate_noise[k];
    }
    return seen;
  }

 private:
  Eigen::Matrix<double, 3, 5> sum_{Eigen::Matrix<double, 3, 5>::Zero()};
  double count_{};
};

/// Variance of one sample's white noise per axis, by its step: times the squared weights, that of a window's integral.
Eigen::Vector3d noise_density(const Series& rates, double step) {
  Eigen::Vector3d density;
  for (int k = 0; k < 3; ++k) {
    std::vector<double> part;
    for (const Eigen::Vector3d& x : rates.x) part.push_back(x[k]);
    density[k] = std::pow(white_noise_sigma(rates.t, part), 2) * std::max(typical_step(rates.t), step);
  }
  return density;
}

}  // namespace

IncrementProblem rate_problem(const PoseSeries& pose) {
  Frame frame;
  frame.begin(pose);
  frame.windows(pose, kWindow,
                [&](int first, int count, const std::vector<double>& weight, const Eigen::Matrix3d& R_BW) {
                  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
                  for (int s = 0; s < count; ++s) {
                    const Eigen::Matrix3d A = R_BW * pose.q_WB[static_cast<std::size_t>(first + s)].toRotationMatrix();
                    const double w = weight[static_cast<std::size_t>(s)];
                    const Eigen::Matrix3d B = w * turn_basis(A);
                    frame.problem.basis.push_back(B);
                    frame.squared += w * w;
                    sum += B;
                  }
                  const Eigen::Matrix3d change =
                      R_BW * (pose.q_WB[static_cast<std::size_t>(first + count - 1)].toRotationMatrix() -
                              pose.q_WB[static_cast<std::size_t>(first)].toRotationMatrix());
                  frame.add(first, count, turn_of(change), sum);
                });
  return std::move(frame.problem);
}

IncrementProblem velocity_problem(const PoseSeries& pose, const Series* rates) {
  Frame frame;
  frame.begin(pose);
  const Spline spline(rates != nullptr ? *rates : Series{});
  const int columns = rates != nullptr ? 13 : 7;
  const double noise = attitude_variance(pose);
  TurnsSeen turns;
  frame.windows(
      pose, kWindow, [&](int first, int count, const std::vector<double>& weight, const Eigen::Matrix3d& R_BW) {
        Eigen::Matrix<double, 3, Eigen::Dynamic> fixed = Eigen::Matrix<double, 3, Eigen::Dynamic>::Zero(3, columns);
        const std::size_t basis_before = frame.problem.basis.size();
        double squared = 0.0;
        Eigen::Vector3d turned = Eigen::Vector3d::Zero();
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
          turned += turn_basis(A) * omega;
          for (std::size_t k = 0; k < kSymmetric.size(); ++k) {
            const auto [a, b] = kSymmetric[k];
            fixed.col(7 + static_cast<int>(k)) += A.col(a) * omega[b];
            if (a != b) fixed.col(7 + static_cast<int>(k)) += A.col(b) * omega[a];
          }
        }
        const auto i0 = static_cast<std::size_t>(first);
        const auto i1 = static_cast<std::size_t>(first + count - 1);
        // A lever arm's share is exact: the sensor's point moved by the change of R r more than the origin.
        const Eigen::Matrix3d change = R_BW * (pose.q_WB[i1].toRotationMatrix() - pose.q_WB[i0].toRotationMatrix());
        fixed.middleCols<3>(3) = -change;
        if (rates != nullptr) turns.add(turn_of(change), turned);
        const Eigen::Vector3d y = R_BW * (pose.p_WB[i1] - pose.p_WB[i0]);
        fixed.col(6) = R_BW.col(2).cross(y);
        frame.squared += squared;
        frame.add(first, count, y, fixed);
      });
  frame.problem.lever = 3;
  frame.problem.lever_noise = 4.0 * noise;  // two attitudes, two axes across each column
  if (rates != nullptr) {
    const Eigen::Vector3d density = noise_density(*rates, frame.problem.step);
    const std::array<bool, 3> seen = turns.axes(2.0 * noise, density * frame.problem.squared_weight);
    for (std::size_t k = 0; k < kSymmetric.size(); ++k) {
      const auto [a, b] = kSymmetric[k];
      if (seen[static_cast<std::size_t>(a)] && seen[static_cast<std::size_t>(b)]) continue;
      for (auto& fixed : frame.problem.fixed) fixed.col(7 + static_cast<int>(k)).setZero();
    }
  }
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
        // The middle sample need not lie in the middle of the time.
        const double early = pose.t[im] - pose.t[i0], late = pose.t[i1] - pose.t[im], half = 0.5 * (early + late);
        double area = 0.0;
        std::vector<double> triangle(static_cast<std::size_t>(count));
        for (int s = 0; s < count; ++s) {
          const auto k = static_cast<std::size_t>(s);
          const double t = pose.t[i0 + k];
          triangle[k] = weight[k] / half * std::min((t - pose.t[i0]) / early, (pose.t[i1] - t) / late);
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
        fixed = -R_BW * ((rotation(i1) - rotation(im)) / late - (rotation(im) - rotation(i0)) / early) / half;
        const Eigen::Vector3d y =
            R_BW * (((pose.p_WB[i1] - pose.p_WB[im]) / late - (pose.p_WB[im] - pose.p_WB[i0]) / early) / half -
                    kNominalGravity * Eigen::Vector3d::UnitZ());
        frame.add(first, count, y, fixed);
      });
  frame.problem.lever = 0;
  // Weights 1 -2 1, two axes, over the square of half the window.
  frame.problem.lever_noise = 12.0 * attitude_variance(pose) / std::pow(kWindow, 4);
  return std::move(frame.problem);
}

}  // namespace fathom::consistency
