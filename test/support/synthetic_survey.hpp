// What the sensors of a trial say of a made-up motion that is known at every instant: shallow (tags, flow, laser) or
// deep (acoustic fixes, velocity log, depth), each with its rate, noise, latency and the faults that a test asks for.
#pragma once

#include <algorithm>
#include <functional>
#include <random>
#include <variant>
#include <vector>

#include "common/estimation/online/navigator.hpp"
#include "test/support/synthetic_recording.hpp"

namespace fathom::test {

using SurveySample = std::variant<Ahrs, TagPose, OpticalFlow, LaserRange, Dvl, Usbl, Depth>;

struct Arrival {
  Utime at{};
  SurveySample sample;
};

struct SurveyOptions {
  unsigned seed{1};
  double duration{60.0};  // s
  double rest{0.0};       // s before it begins to move, over two more
  bool shallow{true};
  bool noisy{true};
  double gap_from{1e9}, gap_to{1e9};                     // s without tags
  double lateness{1.0};                                  // share of the usual latencies
  double force_bias{0.03};                               // m/s^2
  std::function<bool(SurveySample&, double t)> spoil{};  // false: the sample is lost
};

constexpr double kFloor = 1.2;  // m

inline estimation::CameraMount survey_camera() {
  estimation::CameraMount mount;
  mount.p_BC = {0.1, -0.02, 0.05};
  mount.R_BC << 0, -1, 0, 1, 0, 0, 0, 0, 1;  // x_C to starboard, y_C aft, z_C down
  return mount;
}

inline estimation::NavigatorPlaces survey_places() {
  estimation::NavigatorPlaces places;
  places.cameras["down"] = survey_camera();
  int number = 0;
  for (double x = -3.0; x <= 3.0; x += 0.4) {
    for (double y = -3.0; y <= 3.0; y += 0.4) places.tags[number++] = {x, y, kFloor};
  }
  places.floor = kFloor;
  places.p_BI = {0.05, 0.0, -0.02};
  return places;
}

inline estimation::NavigatorSettings survey_settings(bool shallow) {
  estimation::NavigatorSettings s;
  s.attitude_noise = 0.002;
  s.rate_noise = 0.002;
  s.acceleration_noise = 0.008;
  s.bias_walk = 0.002;
  s.bias_prior = 0.05;
  s.largest_position_sigma = 0.5;
  s.largest_velocity_sigma = 0.2;
  if (shallow) {
    s.tags = {true, 4.0, 4.0, 1.0, 1.0, 0.008, 0.0, 0.06, 1.0};
    s.flow = {true, 4.0, 0.0, 3.0, 1.0, 0.002, 0.0, 0.06, 1.0};
    s.laser = {true, 0.0, 2.0, 1.0, 1.0, 0.0, 0.0, 0.06, 1.0};
  } else {
    s.usbl = {true, 0.1, 0.1, 1.0, 1.0, 0.0, 0.0, 0.8, 5.0};
    s.dvl = {true, 2.0, 2.0, 1.0, 1.0, 0.006, 0.0, 0.25, 1.0};
    s.depth = {true, 0.0, 2.0, 1.0, 1.0, 0.01, 0.0, 0.02, 1.0};
  }
  return s;
}

/// The same way, at rest until then: its time stands still at first.
class RestingMotion {
 public:
  RestingMotion(const SyntheticMotion& motion, double rest) : motion_{motion}, rest_{rest} {}
  [[nodiscard]] Eigen::Vector3d p_WB(double t) const { return motion_.p_WB(time(t)); }
  [[nodiscard]] Eigen::Matrix3d R_WB(double t) const { return motion_.R_WB(time(t)); }
  [[nodiscard]] Eigen::Vector3d v_B(double t) const { return pace(t) * motion_.v_B(time(t)); }
  [[nodiscard]] Eigen::Vector3d w_B(double t) const { return pace(t) * motion_.w_B(time(t)); }
  [[nodiscard]] Eigen::Vector3d f_B(double t) const {
    const Eigen::Vector3d held = -kGravity * R_WB(t).transpose() * Eigen::Vector3d::UnitZ();
    const double gain = since(t) > 0.0 && since(t) < kStart ? 1.0 / kStart : 0.0;
    return held + pace(t) * pace(t) * (motion_.f_B(time(t)) - held) + gain * motion_.v_B(time(t));
  }

 private:
  static constexpr double kStart = 2.0, kGravity = 9.81;
  [[nodiscard]] double since(double t) const { return rest_ > 0.0 ? std::max(t - rest_, 0.0) : kStart; }
  [[nodiscard]] double pace(double t) const { return std::min(since(t) / kStart, 1.0); }
  [[nodiscard]] double time(double t) const {
    if (rest_ == 0.0) return t;
    const double s = since(t);
    return s < kStart ? 0.5 * s * s / kStart : s - 0.5 * kStart;
  }
  const SyntheticMotion& motion_;
  double rest_;
};

/// In the order of arrival.
inline std::vector<Arrival> synthetic_survey(const SurveyOptions& o) {
  const SyntheticMotion way{o.seed};
  const RestingMotion motion{way, o.rest};
  const auto places = survey_places();
  const auto mount = survey_camera();
  std::mt19937 random{o.seed * 31u + 7u};
  std::normal_distribution<double> normal;
  const double on = o.noisy ? 1.0 : 0.0;
  const auto noise = [&](double sigma) {
    return Eigen::Vector3d{on * sigma * normal(random), on * sigma * normal(random), on * sigma * normal(random)};
  };
  std::vector<Arrival> arrivals;
  const auto add = [&](SurveySample sample, double t, double latency) {
    if (o.spoil && !o.spoil(sample, t)) return;
    const Utime utime = std::visit([](const auto& s) { return s.utime; }, sample);
    arrivals.push_back({utime_after(utime, latency * o.lateness), std::move(sample)});
  };
  const auto every = [&](double rate, auto use) {
    for (int i = 0; i < static_cast<int>(o.duration * rate); ++i) use(i / rate, utime_after(1'000'000'000, i / rate));
  };
  const Eigen::Vector3d bias = o.force_bias * Eigen::Vector3d{1.0, -0.7, 0.5};
  every(100.0, [&](double t, Utime utime) {
    const double h = 1e-4;
    const Eigen::Vector3d turning = (motion.w_B(t + h) - motion.w_B(t - h)) / (2.0 * h), w = motion.w_B(t);
    Ahrs ahrs{.utime = utime, .has_rates = true, .has_specific_force = true, .has_attitude = true};
    ahrs.w_WB_B = w + noise(0.002);
    ahrs.f_B = motion.f_B(t) + turning.cross(places.p_BI) + w.cross(w.cross(places.p_BI)) + bias + noise(0.05);
    ahrs.q_WB = (Eigen::Quaterniond{motion.R_WB(t)} * quaternion_from_rotation_vector(noise(0.002))).normalized();
    add(ahrs, t, 0.0);
  });
  if (o.shallow) {
    every(30.0, [&](double t, Utime utime) {
      const Eigen::Matrix3d R = motion.R_WB(t);
      const Eigen::Vector3d p_WC = motion.p_WB(t) + R * mount.p_BC;
      const Eigen::Matrix3d R_WC = R * mount.R_BC;
      int seen = 0;
      for (const auto& [number, p_WT] : places.tags) {
        const Eigen::Vector3d p_CT = R_WC.transpose() * (p_WT - p_WC);
        if (p_CT.z() <= 0.0 || std::abs(p_CT.x() / p_CT.z()) > 0.5 || std::abs(p_CT.y() / p_CT.z()) > 0.4) continue;
        if (t >= o.gap_from && t < o.gap_to) continue;
        if (++seen > 4) break;
        add(TagPose{.utime = utime, .camera = "down", .tag = number, .p_CT = p_CT + noise(0.008)}, t, 0.04);
      }
      const double distance = (kFloor - p_WC.z()) / R_WC(2, 2);
      const Eigen::Vector3d v_C = mount.R_BC.transpose() * (motion.v_B(t) + motion.w_B(t).cross(mount.p_BC));
      const Eigen::Vector3d flow = -v_C / distance + noise(0.01).cwiseProduct(Eigen::Vector3d{1.0, 1.0, 3.0});
      add(OpticalFlow{.utime = utime,
                      .camera = "down",
                      .interval = 1.0 / 30.0,
                      .flow_C = flow,
                      .covariance = Eigen::Vector3d{1e-4, 1e-4, 9e-4}.asDiagonal(),
                      .n_tracks = 50},
          t, 0.045);
      add(
          LaserRange{
              .utime = utime, .camera = "down", .p_CL = {0.0, 0.0, distance + noise(0.01).x()}, .sigma_range = 0.01},
          t, 0.04);
    });
  } else {
    every(8.0, [&](double t, Utime utime) {
      add(Dvl{.utime = utime, .v_WB_B = motion.v_B(t) + noise(0.006), .altitude = 1.0}, t, 0.15);
    });
    every(1.0, [&](double t, Utime utime) {
      add(Usbl{.utime = utime, .p_WB = motion.p_WB(t) + noise(0.1), .sigma = Eigen::Vector3d::Constant(0.1)}, t, 0.6);
    });
    every(20.0, [&](double t, Utime utime) {
      add(Depth{.utime = utime, .z = motion.p_WB(t).z() + noise(0.01).z()}, t, 0.01);
    });
  }
  std::stable_sort(arrivals.begin(), arrivals.end(), [](const Arrival& a, const Arrival& b) { return a.at < b.at; });
  return arrivals;
}

inline std::vector<StateEstimate> feed(estimation::Navigator& navigator, const std::vector<Arrival>& arrivals) {
  std::vector<StateEstimate> states;
  for (const Arrival& arrival : arrivals) {
    std::visit(
        [&](const auto& sample) {
          const auto& output = navigator.step(sample);
          states.insert(states.end(), output.begin(), output.end());
        },
        arrival.sample);
  }
  return states;
}

}  // namespace fathom::test
