// A camera flown over a rendered floor as a vehicle is in a trial: what flow says of every pair of pictures against the
// truth. Way, floor, water and light are drawn from the seed.
#pragma once

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <random>

#include "common/vision/jpeg.hpp"
#include "common/vision/laser/laser_dot.hpp"
#include "test/common/vision/scene.hpp"

namespace fathom::vision::test_scene {

struct FlightSettings {
  bool tags{true}, dot{true};
  int dirt{};              ///< dark spots on the window
  bool drawn_look{false};  ///< water, light and floor by the seed; else those of `look`
  RenderSettings look;
  int quality{90};    ///< of JPEG; 0 for none
  double haste{1.0};  ///< times faster
  double near{0.75};  ///< m above the floor, in the mean
  double seconds{20.0};
  std::uint64_t seed{1};
};

struct FlightTally {
  int pairs{}, valid{}, beyond{};  ///< beyond: error squared over covariance above 30, by chance one in a million
  double squares{};                ///< sum of errors squared over covariance, 3 expected of each
  double errors{}, stated{};       ///< sums along the floor [m^2/s^2]
  double worst{};                  ///< m/s along the floor
  double along{}, slow{};          ///< sums of error times truth and of truth's square where the floor moves slowly

  [[nodiscard]] double mean_square() const { return squares / std::max(valid, 1); }
  [[nodiscard]] double rms() const { return std::sqrt(errors / std::max(2 * valid, 1)); }  ///< m/s, per axis
  [[nodiscard]] double said() const { return std::sqrt(stated / std::max(2 * valid, 1)); }
  /// Share of a slow motion that is not seen.
  [[nodiscard]] double pull() const { return -along / std::max(slow, 1e-12); }
  void add(const FlightTally& other) {
    pairs += other.pairs;
    valid += other.valid;
    beyond += other.beyond;
    squares += other.squares;
    along += other.along;
    slow += other.slow;
    errors += other.errors;
    stated += other.stated;
    worst = std::max(worst, other.worst);
  }
};

/// Place and attitude as sums of two swings per axis: 0.3 to 0.5 m/s along the floor, 0.3 to 1.2 m above it.
class Course {
 public:
  Course(std::mt19937_64& random, double haste, double near) : near_{near} {
    const auto draw = [&random](double low, double high) {
      return std::uniform_real_distribution<double>{low, high}(random);
    };
    constexpr std::array<double, 6> kReach{0.55, 0.55, 0.22, 0.06, 0.1, 0.5};  // m, rad
    for (std::size_t axis = 0; axis < kReach.size(); ++axis) {
      for (Swing& each : swings_[axis])
        each = {kReach[axis] * (axis == 2 ? near / 0.75 : 1.0) * draw(0.5, 1.0), haste * draw(0.3, 1.1),
                draw(0.0, 6.28)};
    }
    heading_ = draw(-3.1, 3.1);
  }
  [[nodiscard]] Pose at(double t, double floor) const {
    std::array<double, 6> q{0.0, 0.0, floor - near_, 0.0, 0.0, heading_};
    for (std::size_t axis = 0; axis < q.size(); ++axis) {
      for (const Swing& each : swings_[axis]) q[axis] += each.reach * std::sin(each.omega * t + each.phase);
    }
    return pose({q[0], q[1], q[2]}, q[3], q[4], q[5]);
  }

 private:
  struct Swing {
    double reach, omega, phase;
  };
  std::array<std::array<Swing, 2>, 6> swings_{};
  double heading_{}, near_;
};

inline RenderSettings drawn_look(std::mt19937_64& random) {
  const auto draw = [&random](double low, double high) {
    return std::uniform_real_distribution<double>{low, high}(random);
  };
  RenderSettings look;
  look.attenuation = draw(0.05, 0.7);
  look.blur = draw(0.4, 1.4);
  look.noise = draw(1.0, 4.0);
  look.caustics = draw(0.0, 0.5);
  look.texture = draw(0.08, 0.4);
  return look;
}

/// What a window with so many spots lets through, of 255.
inline cv::Mat dirty_window(int spots, std::mt19937_64& random) {
  cv::Mat window(480, 640, CV_8UC3, cv::Scalar::all(255));
  std::uniform_int_distribution<int> x{0, 639}, y{0, 479}, radius{1, 6}, dark{60, 220};
  for (int i = 0; i < spots; ++i) {
    const cv::Point at{x(random), y(random)};
    cv::circle(window, at, radius(random), cv::Scalar::all(dark(random)), cv::FILLED);
  }
  cv::GaussianBlur(window, window, {}, 1.5);
  return window;
}

inline FlightTally fly(const FlightSettings& settings) {
  constexpr double kPeriod = 1.0 / 30.0, kBeyond = 30.0, kSlow = 0.3;  // 1/s
  std::mt19937_64 random{settings.seed};
  const Course course{random, settings.haste, settings.near};
  const RenderSettings look = settings.drawn_look ? drawn_look(random) : settings.look;
  model::Site place = site();
  if (!settings.tags) place.tags.clear();
  Renderer renderer{place, lens(), settings.dot ? std::optional{laser()} : std::nullopt, look, settings.seed};
  FlowTracker tracker{lens(), {}};
  if (settings.dot) {
    const LaserSettings beam;
    tracker.leave_out(LaserFinder{lens(), laser(), beam}.line(), beam.strip + beam.largest);
  }
  const cv::Mat window = dirty_window(settings.dirt, random);
  FlightTally tally;
  std::optional<Pose> before;
  for (int i = 0; i * kPeriod < settings.seconds; ++i) {
    const double t = i * kPeriod;
    const Pose now = course.at(t, place.floor);
    Picture seen = picture(renderer, t, now);
    cv::multiply(seen.bgr, window, seen.bgr, 1.0 / 255.0);
    seen.grey = grey_of(seen.bgr);
    if (settings.quality > 0) {
      const cv::Mat bgr = seen.bgr.clone();
      (void)decode_jpeg(encode_jpeg(bgr, settings.quality), false, seen.grey, seen.bgr);
    }
    std::optional<Eigen::Matrix3d> R_AB;
    if (before) R_AB = before->R_WC.transpose() * now.R_WC;
    const Flow flow = tracker.step(seen.utime, seen.grey, R_AB, now.R_WC.row(2));
    before = now;
    if (i == 0) continue;
    ++tally.pairs;
    if (flow.state != FlowState::kValid) continue;
    ++tally.valid;
    const Pose middle = course.at(t - 0.5 * kPeriod, place.floor);
    constexpr double kStep = 1e-4;
    const Eigen::Vector3d v_W = (course.at(t - 0.5 * kPeriod + kStep, place.floor).p_WC -
                                 course.at(t - 0.5 * kPeriod - kStep, place.floor).p_WC) /
                                (2.0 * kStep);
    const double z = (place.floor - middle.p_WC.z()) / middle.R_WC(2, 2);
    const Eigen::Vector3d truth = middle.R_WC.transpose() * v_W / z, error = flow.rate - truth;
    const double square = error.dot(flow.covariance.inverse() * error);
    for (int axis = 0; axis < 2; ++axis) {
      if (std::abs(truth[axis]) > kSlow) continue;
      tally.along += error[axis] * truth[axis];
      tally.slow += truth[axis] * truth[axis];
    }
    tally.squares += square;
    tally.beyond += square > kBeyond ? 1 : 0;
    tally.errors += (z * error.head<2>()).squaredNorm();
    tally.stated += z * z * flow.covariance.topLeftCorner<2, 2>().trace();
    tally.worst = std::max(tally.worst, z * error.head<2>().norm());
  }
  return tally;
}

}  // namespace fathom::vision::test_scene
