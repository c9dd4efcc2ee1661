// What each aid of a trial says by itself, turned into the body's motion: for pictures and comparisons, not for a
// filter. Attitude, and what an aid cannot see, are taken from STATE.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/model/mounts.hpp"
#include "common/model/site.hpp"
#include "common/samples/recording.hpp"

namespace fathom::estimation {

/// Values over time; NaN in components that the aid does not see.
struct Seen {
  std::vector<double> t;  ///< s after the origin
  std::vector<Eigen::Vector3d> x;
};

struct AidsSeen {
  Seen tags;   ///< m, p_WB: mean over the tags of one picture
  Seen usbl;   ///< m, p_WB
  Seen laser;  ///< m, z alone
  Seen depth;  ///< m, z alone
  Seen flow;   ///< m/s, u and v
  Seen dvl;    ///< m/s, u v w
};

/// Aids without a place in `mounts`, or before the first state, are left out.
[[nodiscard]] AidsSeen aids_seen(const Recording& recording, const model::Mounts& mounts, const model::Site& site,
                                 Utime origin);

}  // namespace fathom::estimation
