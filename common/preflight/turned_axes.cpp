#include "common/preflight/turned_axes.hpp"

#include <algorithm>

namespace fathom::preflight {
namespace {

const std::array<TurnedAxes, 3> kHalfTurns{
    TurnedAxes{{1, -1, -1, 1, -1, -1},
               "motion told along left and up in place of right and down (FLU in place of FRD)"},
    TurnedAxes{{-1, -1, 1, -1, -1, 1}, "motion told along aft and left in place of forward and right"},
    TurnedAxes{{-1, 1, -1, -1, 1, -1}, "motion told along aft and up in place of forward and down"}};

}  // namespace

Eigen::Matrix<double, 6, Eigen::Dynamic> turned(const Eigen::Matrix<double, 6, Eigen::Dynamic>& allocation,
                                                const TurnedAxes& axes) {
  Eigen::Matrix<double, 6, Eigen::Dynamic> all = allocation;
  for (Eigen::Index axis = 0; axis < 6; ++axis) all.row(axis) *= axes.sign[static_cast<std::size_t>(axis)];
  return all;
}

TurnedAxes likeliest_turn(const ThrustEvidence& evidence, const Eigen::Matrix<double, 6, Eigen::Dynamic>& allocation) {
  std::array<TurnedAxes, 3> turns = kHalfTurns;
  for (TurnedAxes& turn : turns) turn.cost = evidence.cost(turned(allocation, turn));
  return *std::ranges::min_element(turns, {}, &TurnedAxes::cost);
}

}  // namespace fathom::preflight
