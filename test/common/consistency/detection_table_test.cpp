// How often each named convention is found, over random motions, sizes and noise, and how often a healthy recording is
// altered. Slow: not part of a plain run; test_common_consistency --no-skip -tc="table of detection*" prints it.
#include <doctest/doctest.h>

#include <cstdio>
#include <cstdlib>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "common/base/units.hpp"
#include "test/support/consistency.hpp"

namespace fathom {
namespace {

using test::SyntheticOptions;

const Eigen::Matrix3d kFlip = Eigen::Vector3d(1, -1, -1).asDiagonal();
const Eigen::Matrix3d kEnu = (Eigen::Matrix3d() << 0, 1, 0, 1, 0, 0, 0, 0, -1).finished();

/// What was done to a recording, and whether the corrections undo that and nothing else.
struct Convention {
  const char* name;
  std::function<void(Recording&)> spoil;
  std::function<bool(const estimation::Corrections&)> right;
};

Eigen::Quaterniond attitude_at(const Recording& run, Utime utime) {
  std::size_t i = 0;
  while (i + 1 < run.pose_capture.size() && run.pose_capture[i + 1].utime <= utime) ++i;
  const PoseCapture& a = run.pose_capture[i];
  if (i + 1 >= run.pose_capture.size() || a.utime >= utime) return a.q_WB;
  const PoseCapture& b = run.pose_capture[i + 1];
  return a.q_WB.slerp(seconds_between(a.utime, utime) / seconds_between(a.utime, b.utime), b.q_WB);
}

bool sensors_untouched(const estimation::Corrections& c) {
  return (c.gyro.matrix() - Eigen::Matrix3d::Identity()).norm() < 0.2 &&
         (c.dvl.matrix() - Eigen::Matrix3d::Identity()).norm() < 0.2;
}
bool pose_untouched(const estimation::Corrections& c) {
  return c.quaternion == estimation::QuaternionForm::kAsRead && c.heading_sense == estimation::HeadingSense::kAsRead &&
         c.attitude_world.isIdentity() && (c.attitude_axes - Eigen::Matrix3d::Identity()).norm() < 0.2 &&
         c.position_axes.isIdentity() && std::abs(c.heading) < 0.1;
}
bool frames_untouched(const estimation::Corrections& c) {
  return c.velocity_frame == estimation::VectorFrame::kBody && c.rates_frame == estimation::VectorFrame::kBody;
}

std::vector<Convention> conventions() {
  using estimation::Corrections;
  using estimation::HeadingSense;
  using estimation::QuaternionForm;
  using estimation::VectorFrame;
  const auto each_pose = [](auto change) {
    return [change](Recording& run) {
      for (PoseCapture& pose : run.pose_capture) change(pose);
    };
  };
  const auto to_world = [](Recording& run, bool velocity, bool rates, const Eigen::Matrix3d& axes) {
    if (velocity) {
      for (Dvl& dvl : run.dvl) dvl.v_WB_B = axes.transpose() * (attitude_at(run, dvl.utime) * dvl.v_WB_B);
    }
    if (rates) {
      for (Ahrs& ahrs : run.ahrs) ahrs.w_WB_B = axes.transpose() * (attitude_at(run, ahrs.utime) * ahrs.w_WB_B);
    }
  };
  const Eigen::Matrix3d none = Eigen::Matrix3d::Identity();
  return {
      {"velocity along NED", [=](Recording& run) { to_world(run, true, false, none); },
       [](const Corrections& c) {
         return c.velocity_frame == VectorFrame::kWorld && c.velocity_world.isIdentity() && pose_untouched(c) &&
                c.rates_frame == VectorFrame::kBody && sensors_untouched(c);
       }},
      {"velocity along ENU", [=](Recording& run) { to_world(run, true, false, kEnu); },
       [](const Corrections& c) {
         return c.velocity_frame == VectorFrame::kWorld && c.velocity_world.isApprox(kEnu) && pose_untouched(c) &&
                sensors_untouched(c);
       }},
      {"velocity and rates along NED", [=](Recording& run) { to_world(run, true, true, none); },
       [](const Corrections& c) {
         return c.velocity_frame == VectorFrame::kWorld && c.rates_frame == VectorFrame::kWorld && pose_untouched(c) &&
                sensors_untouched(c);
       }},
      {"rates along NED", [=](Recording& run) { to_world(run, false, true, none); },
       [](const Corrections& c) {
         return c.rates_frame == VectorFrame::kWorld && c.velocity_frame == VectorFrame::kBody && pose_untouched(c) &&
                sensors_untouched(c);
       }},
      {"position ENU", each_pose([](PoseCapture& pose) { pose.p_WB = kEnu * pose.p_WB; }),
       [](const Corrections& c) {
         return c.position_axes.isApprox(kEnu) && frames_untouched(c) && sensors_untouched(c) &&
                c.quaternion == QuaternionForm::kAsRead && std::abs(c.heading) < 0.1;
       }},
      {"position NWU", each_pose([](PoseCapture& pose) { pose.p_WB = kFlip * pose.p_WB; }),
       [](const Corrections& c) {
         return c.position_axes.isApprox(kFlip) && frames_untouched(c) && sensors_untouched(c);
       }},
      {"heading from east", each_pose([](PoseCapture& pose) {
         Eigen::Vector3d angles = euler_from_rotation(pose.q_WB.toRotationMatrix());
         angles.z() = 90.0 * kDegree - angles.z();
         pose.q_WB = Eigen::Quaterniond(rotation_from_euler(angles));
       }),
       [](const Corrections& c) {
         return c.heading_sense == HeadingSense::kFromEast && c.position_axes.isIdentity() && frames_untouched(c) &&
                sensors_untouched(c);
       }},
      {"conjugate quaternion", each_pose([](PoseCapture& pose) { pose.q_WB = pose.q_WB.conjugate(); }),
       [](const Corrections& c) {
         return c.quaternion == QuaternionForm::kInverse && frames_untouched(c) && sensors_untouched(c);
       }},
      {"xyzw read as wxyz", each_pose([](PoseCapture& pose) {
         pose.q_WB = Eigen::Quaterniond(pose.q_WB.x(), pose.q_WB.y(), pose.q_WB.z(), pose.q_WB.w());
       }),
       [](const Corrections& c) {
         return c.quaternion == QuaternionForm::kScalarLast && frames_untouched(c) && sensors_untouched(c);
       }},
      {"pose ENU and FLU", each_pose([](PoseCapture& pose) {
         pose.p_WB = kEnu * pose.p_WB;
         pose.q_WB = Eigen::Quaterniond(Eigen::Matrix3d(kEnu * pose.q_WB.toRotationMatrix() * kFlip));
       }),
       [](const Corrections& c) {
         return c.position_axes.isApprox(kEnu) && c.attitude_world.isApprox(kEnu) && frames_untouched(c) &&
                sensors_untouched(c);
       }},
      {"heading frame turned by 90", each_pose([](PoseCapture& pose) {
         pose.q_WB = Eigen::Quaterniond(Eigen::AngleAxisd(90.0 * kDegree, Eigen::Vector3d::UnitZ())) * pose.q_WB;
       }),
       [](const Corrections& c) {
         return std::abs(std::remainder(c.heading + 90.0 * kDegree, 360.0 * kDegree)) < 0.1 && frames_untouched(c) &&
                c.position_axes.isIdentity() && sensors_untouched(c);
       }},
      {"velocity FLU",
       [](Recording& run) {
         for (Dvl& dvl : run.dvl) dvl.v_WB_B = kFlip * dvl.v_WB_B;
       },
       [](const Corrections& c) { return c.dvl.base.isApprox(kFlip) && pose_untouched(c) && frames_untouched(c); }},
      {"rates mirrored (left-handed)",
       [](Recording& run) {
         for (Ahrs& ahrs : run.ahrs) ahrs.w_WB_B = -ahrs.w_WB_B;
       },
       [](const Corrections& c) {
         return c.gyro.base.isApprox(-Eigen::Matrix3d::Identity()) && pose_untouched(c) && frames_untouched(c);
       }},
  };
}

/// A random motion of random size, and random noise.
SyntheticOptions any_run(unsigned seed) {
  std::mt19937 random(seed * 2654435761U + 7U);
  std::uniform_real_distribution<double> any(0.0, 1.0);
  SyntheticOptions options{.seed = seed, .duration = any(random) < 0.5 ? 60.0 : 120.0};
  options.pose_rate = options.gyro_rate = any(random) < 0.5 ? 10.0 : 20.0;
  options.dvl_rate = any(random) < 0.5 ? 5.0 : 10.0;
  for (double& activity : options.activity) activity = 0.2 + 0.8 * any(random);
  const double noise = std::pow(10.0, any(random) - 0.5);  // a third to three times the usual
  options.position_noise *= noise;
  options.angle_noise *= noise;
  options.velocity_noise *= noise;
  options.rate_noise *= noise;
  options.accelerometer = any(random) < 0.5;
  return options;
}

/// A row of docs/sensor_check.md: the share with its score interval (Wilson 1927).
void print_row(const char* name, unsigned part, unsigned whole) {
  constexpr double z = 1.959964;  // of 95 %
  const double n = whole, p = part / n, middle = p + z * z / (2.0 * n);
  const double half = z * std::sqrt(p * (1.0 - p) / n + z * z / (4.0 * n * n)), scale = 1.0 + z * z / n;
  std::printf("| %s | %u | %u | %.0f to %.0f %% |\n", name, part, whole, 100.0 * std::max(middle - half, 0.0) / scale,
              100.0 * std::min((middle + half) / scale, 1.0));
  std::fflush(stdout);
}

bool healthy(const estimation::Corrections& c) {
  return pose_untouched(c) && frames_untouched(c) && sensors_untouched(c) && c.position_scale == 1.0 &&
         c.position_late == 0.0;
}

}  // namespace

TEST_CASE("each named convention is found, and nothing else is altered, over a few random motions") {
  for (const Convention& one : conventions()) {
    CAPTURE(one.name);
    Recording run = test::synthetic_recording(any_run(5));
    one.spoil(run);
    const auto result = consistency::check_consistency(std::span(&run, 1));
    if (!one.right(result.corrections.front())) test::print(result.findings);
    CHECK(one.right(result.corrections.front()));
  }
}

TEST_CASE("table of detection rates of conventions" * doctest::skip()) {
  const char* wanted = std::getenv("FATHOM_SEEDS");
  const unsigned seeds = wanted != nullptr ? static_cast<unsigned>(std::atoi(wanted)) : 20;
  std::printf("| convention | found | of | 95 %% |\n|---|---|---|---|\n");
  for (const Convention& one : conventions()) {
    unsigned found = 0;
    for (unsigned seed = 1; seed <= seeds; ++seed) {
      Recording run = test::synthetic_recording(any_run(seed));
      one.spoil(run);
      const auto result = consistency::check_consistency(std::span(&run, 1));
      const bool right = one.right(result.corrections.front());
      found += right ? 1 : 0;
      if (!right) {
        std::fprintf(stderr, "%s, seed %u:\n", one.name, seed);
        test::print(result.findings);
      }
    }
    print_row(one.name, found, seeds);
    CHECK(found * 10 >= seeds * 9);
  }
  unsigned altered = 0, named = 0;
  const unsigned many = 10 * seeds;
  for (unsigned seed = 1001; seed <= 1000 + many; ++seed) {
    const Recording run = test::synthetic_recording(any_run(seed));
    const auto result = consistency::check_consistency(std::span(&run, 1));
    altered += healthy(result.corrections.front()) ? 0 : 1;
    named += result.findings.empty() ? 0 : 1;
    if (!result.findings.empty()) test::print(result.findings);
  }
  print_row("healthy: something altered", altered, many);
  print_row("healthy: something said", named, many);
  CHECK(altered == 0);
}

}  // namespace fathom
