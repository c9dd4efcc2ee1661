// Four-beam (Janus) Doppler geometry and Teledyne's frames, down to the body's axes.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>

namespace fathom::devices {

enum class DvlFrame : std::uint8_t { kBeam, kInstrument, kShip, kEarth };
[[nodiscard]] const char* name(DvlFrame frame);

struct Janus {
  double beam_angle{};  ///< rad from the instrument's axis; 0: not known
  bool convex{true};
};

/// How the instrument hangs and how it says velocities, while it measured.
struct DvlPose {
  DvlFrame frame{};
  bool level{};        ///< "ship": roll and pitch are taken out already
  double alignment{};  ///< rad, of beam 3 clockwise from ahead; not 0: ship and earth frames and the tilts know of it
  std::optional<double> roll, pitch, heading;         ///< rad
  Eigen::Matrix3d R_BS{Eigen::Matrix3d::Identity()};  ///< as if the alignment were 0
};

/// Velocity X (starboard), Y (forward), Z (up) of the instrument from four velocities along the beams, or from three
/// with the error velocity set to zero. Nothing with fewer.
[[nodiscard]] std::optional<Eigen::Vector3d> from_beams(const std::array<std::optional<double>, 4>& beams,
                                                        const Janus& janus);

/// Teledyne's velocity (starboard, forward, up; or east, north, up) to forward, right, down of the body. Nothing when
/// attitude is needed and not known.
[[nodiscard]] std::optional<Eigen::Vector3d> to_body(const Eigen::Vector3d& velocity, const DvlPose& pose);

/// Distance to a flat bottom from what the beams say along the instrument's axis [m]; nothing without a valid
/// beam.
[[nodiscard]] std::optional<double> altitude(const std::array<std::optional<double>, 4>& ranges, const Janus& janus,
                                             const DvlPose& pose);

}  // namespace fathom::devices
