#include "common/devices/velocity/janus.hpp"

#include <cmath>

#include "common/base/spatial.hpp"

namespace fathom::devices {
namespace {

// Starboard, forward, up to forward, right, down. The same step takes east, north, up to north, east, down.
Eigen::Vector3d frd(const Eigen::Vector3d& v) { return {v.y(), v.x(), -v.z()}; }

// An instrument that knows its alignment says ship and earth velocities of the ship, not of itself.
Eigen::Matrix3d own_mounting(const DvlPose& pose) {
  return pose.alignment != 0.0 ? Eigen::Matrix3d::Identity() : pose.R_BS;
}

}  // namespace

const char* name(DvlFrame frame) {
  constexpr std::array kNames{"beam", "instrument", "ship", "earth"};
  return kNames[static_cast<std::size_t>(frame)];
}

std::optional<Eigen::Vector3d> from_beams(const std::array<std::optional<double>, 4>& beams, const Janus& janus) {
  if (janus.beam_angle <= 0.0) return {};
  std::array<double, 4> b{};
  int missing = -1;
  for (int i = 0; i < 4; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (beams[k]) {
      b[k] = *beams[k];
    } else if (missing >= 0) {
      return {};
    } else {
      missing = i;
    }
  }
  // Error velocity ~ b1 + b2 - b3 - b4 = 0 gives the one that is missing.
  if (missing == 0) b[0] = b[2] + b[3] - b[1];
  if (missing == 1) b[1] = b[2] + b[3] - b[0];
  if (missing == 2) b[2] = b[0] + b[1] - b[3];
  if (missing == 3) b[3] = b[0] + b[1] - b[2];
  const double across = (janus.convex ? 1.0 : -1.0) / (2.0 * std::sin(janus.beam_angle));
  const double along = 1.0 / (4.0 * std::cos(janus.beam_angle));
  return Eigen::Vector3d{across * (b[0] - b[1]), across * (b[3] - b[2]), along * (b[0] + b[1] + b[2] + b[3])};
}

std::optional<Eigen::Vector3d> to_body(const Eigen::Vector3d& velocity, const DvlPose& pose) {
  const Eigen::Vector3d v = frd(velocity);
  switch (pose.frame) {
    case DvlFrame::kBeam:
    case DvlFrame::kInstrument:
      return pose.R_BS * v;
    case DvlFrame::kShip: {
      const Eigen::Matrix3d R_BS = own_mounting(pose);
      if (!pose.level) return R_BS * v;
      if (!pose.roll || !pose.pitch) return {};
      return R_BS * rotation_from_euler({*pose.roll, *pose.pitch, 0.0}).transpose() * v;
    }
    case DvlFrame::kEarth: {
      if (!pose.roll || !pose.pitch || !pose.heading) return {};
      return own_mounting(pose) * rotation_from_euler({*pose.roll, *pose.pitch, *pose.heading}).transpose() * v;
    }
  }
  return {};
}

std::optional<double> altitude(const std::array<std::optional<double>, 4>& ranges, const Janus& janus,
                               const DvlPose& pose) {
  const bool tilts = pose.roll && pose.pitch && janus.beam_angle > 0.0;
  const Eigen::Matrix3d R_LS = tilts ? Eigen::Matrix3d{rotation_from_euler({*pose.roll, *pose.pitch, 0.0}) *
                                                       rotation_from_euler({0.0, 0.0, pose.alignment})}
                                     : Eigen::Matrix3d::Identity();
  const double out = std::tan(janus.beam_angle) * (janus.convex ? 1.0 : -1.0);
  // Where the beams point: 1 to port, 2 to starboard, 3 forward, 4 aft (convex).
  const std::array<Eigen::Vector3d, 4> beams{Eigen::Vector3d{0.0, -out, 1.0}, Eigen::Vector3d{0.0, out, 1.0},
                                             Eigen::Vector3d{out, 0.0, 1.0}, Eigen::Vector3d{-out, 0.0, 1.0}};
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < beams.size(); ++i) {
    if (!ranges[i]) continue;
    sum += *ranges[i] * (tilts ? (R_LS * beams[i]).z() : 1.0);
    ++count;
  }
  if (count == 0 || sum <= 0.0) return {};
  return sum / count;
}

}  // namespace fathom::devices
