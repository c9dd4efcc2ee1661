// Single samples that leap away from their neighbours.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/estimation/timeline.hpp"

namespace fathom::estimation {

/// Per sample of places [m] or quaternions at times t [s]: 1 where it misses the cubic through its four neighbours by
/// twelve times what is usual and by `floor`. Nothing is said beside gaps.
[[nodiscard]] std::vector<std::uint8_t> spikes(const std::vector<double>& t, const std::vector<Eigen::Vector3d>& x,
                                               double floor);
[[nodiscard]] std::vector<std::uint8_t> spikes(const std::vector<double>& t, const std::vector<Eigen::Vector4d>& x,
                                               double floor);

/// The same of speeds, rates or specific forces, which may bend from one sample to the next where thrust sets in: only
/// what comes back within two samples is a spike.
[[nodiscard]] std::vector<std::uint8_t> speed_spikes(const Series& series, double floor);

}  // namespace fathom::estimation
