#include "common/diagnosis/random_rest.hpp"

#include <algorithm>
#include <cmath>

#include "common/model/vehicle.hpp"

namespace fathom::diagnosis {
namespace {

constexpr double kMuch = 0.05;    // of the applied wrench, RMS: three times what an association must be of it
constexpr double kEnough = 20.0;  // memories in the data: fewer look like anything

}  // namespace

std::array<bool, 6> random_rest(std::span<const AxisWhiteness> residual, std::span<const Association> left,
                                double length) {
  std::array<bool, 6> random{};
  for (std::size_t axis = 0; axis < 6; ++axis) {
    const char* name = model::kAxisNames[axis];
    const auto row = std::ranges::find(residual, name, &AxisWhiteness::axis);
    if (row == residual.end() || std::ranges::find(left, name, &Association::axis) != left.end()) continue;
    random[axis] = row->p_value < kNotRandom && row->autocorrelation_time_s >= kNoMemory &&
                   row->autocorrelation_time_s * kEnough <= length && 1.0 - row->explained >= kMuch * kMuch;
  }
  return random;
}

}  // namespace fathom::diagnosis
