// What a camera that looks at a floor with tags would have said of a synthetic motion, with the faults that a test asks
// for, and a STATE that rests on it.
#pragma once

#include "common/model/mounts.hpp"
#include "common/model/site.hpp"
#include "test/support/synthetic_recording.hpp"

namespace fathom::test {

struct PictureOptions {
  unsigned seed{1};
  double duration{130.0};                                // s
  double rate{20.0};                                     // Hz
  Eigen::Vector2d flow_factor{Eigen::Vector2d::Ones()};  // of u and v: what the flow shows over what there is
  double flow_delay{};                                   // s
  Eigen::Vector3d flow_arm{Eigen::Vector3d::Zero()};     // m: turning that is left in the flow, as at this place
  double gyro_turn{};                                    // rad about x: rates that the flow's turning is taken out with
  Eigen::Vector3d state_offset{Eigen::Vector3d::Zero()};  // m: STATE's position is off, the tags' is not
};

struct Pictures {
  model::Mounts mounts;
  model::Site site;
  Recording recording;  // STATE, TAG_POSE, OPTICAL_FLOW

  explicit Pictures(const PictureOptions& o) {
    const model::Mount camera{.p_BS = {0.1, 0.02, 0.12}, .R_BS = rotation_from_euler({0.03, -0.02, 1.5})};
    mounts.cameras.push_back({.name = "down", .mount = camera, .width = 640, .height = 480, .focal = 500.0});
    site.floor = 2.0;
    for (int id = 0; id < 3; ++id) {
      site.tags.push_back({.id = id, .p_WT = {0.5 * id, -0.2 * id, site.floor}});
    }
    const SyntheticMotion motion{o.seed};
    std::mt19937 random{o.seed};
    std::normal_distribution<double> normal;
    const auto noise = [&](double sigma) {
      return Eigen::Vector3d{sigma * normal(random), sigma * normal(random), sigma * normal(random)};
    };
    const Eigen::Matrix3d shown = Eigen::Vector3d{o.flow_factor.x(), o.flow_factor.y(), 1.0}.asDiagonal();
    recording.name = "pictures";
    const int count = static_cast<int>(o.duration * o.rate);
    for (int k = 0; k < count; ++k) {
      const double t = k / o.rate;
      const Utime utime = utime_after(0, 2.0 + t);
      const Eigen::Vector3d p_WB = motion.p_WB(t), w_B = motion.w_B(t);
      const Eigen::Vector3d v_B = shown * motion.v_B(t - o.flow_delay) + w_B.cross(o.flow_arm);
      const Eigen::Matrix3d R_WB = motion.R_WB(t);
      StateEstimate state{.utime = utime,
                          .p_WB = p_WB + o.state_offset + noise(0.003),
                          .q_WB = Eigen::Quaterniond{R_WB} * quaternion_from_rotation_vector(noise(0.002)),
                          .valid = true};
      const Eigen::Vector3d w_seen = rotation_from_euler({o.gyro_turn, 0.0, 0.0}) * w_B;
      state.nu << v_B + noise(0.004), w_seen + noise(0.0035);
      recording.state.push_back(state);
      for (const model::Tag& tag : site.tags) {
        const Eigen::Vector3d p_BT = R_WB.transpose() * (tag.p_WT - p_WB);
        recording.tag_pose.push_back({.utime = utime,
                                      .camera = "down",
                                      .tag = tag.id,
                                      .p_CT = camera.R_BS.transpose() * (p_BT - camera.p_BS) + noise(0.006)});
      }
      const Eigen::Vector3d p_WC = p_WB + R_WB * camera.p_BS, axis_W = R_WB * camera.R_BS.col(2);
      const double distance = (site.floor - p_WC.z()) / axis_W.z();
      // Turning moves the floor's picture as a velocity does; vision takes it out with the rates that it knows.
      const Eigen::Vector3d left = (w_B - w_seen).cross(distance * camera.R_BS.col(2));
      const Eigen::Vector3d v_C = camera.R_BS.transpose() * (v_B + w_B.cross(camera.p_BS) + left);
      recording.optical_flow.push_back(
          {.utime = utime,
           .camera = "down",
           .interval = 1.0 / o.rate,
           .flow_C = -v_C / distance + Eigen::Vector3d(noise(0.005).cwiseProduct(Eigen::Vector3d{1, 1, 0})),
           .covariance = OpticalFlow::only_across(0.005),
           .n_tracks = 80});
    }
  }
};

}  // namespace fathom::test
