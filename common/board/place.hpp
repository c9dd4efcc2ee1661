// Where the trial takes place and with what: walls, fence, tags, tether, names of thrusters. As files say it, or as the
// processes of a trial tell of their files when they start.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "common/base/config.hpp"

namespace fathom::board {

/// A rectangle seen from above, axes north and east of W. Infinite where it is open.
struct Bounds {
  Eigen::Vector2d low, high;  ///< m
};

struct Place {
  std::string vehicle, site;
  std::vector<std::string> thrusters;             ///< order of THRUSTERS
  Eigen::Vector3d hull{Eigen::Vector3d::Zero()};  ///< m, length, width, height; 0: unknown
  std::optional<Bounds> walls, fence;
  std::optional<double> surface, floor;          ///< m, z in W
  std::vector<Eigen::Vector3d> tags;             ///< m in W
  std::vector<Eigen::Vector3d> transponders;     ///< m in W
  std::optional<Eigen::Vector3d> tether_anchor;  ///< m in W

  /// Takes what a file knows, whichever file it is: vehicle, site, pipeline. The fence needs all three. InputError as
  /// the file's own readers throw it.
  void take(const Config& file);
  /// The same of all files in PROCESS_INFO's `config`, each after a line "# file NAME"; what cannot be read is left
  /// out, since another version may have written it. False when none of them told anything new.
  bool take_told(const std::string& config);

 private:
  void find_fence();
  std::optional<Config> vehicle_file_, site_file_, supervisor_;
};

}  // namespace fathom::board
