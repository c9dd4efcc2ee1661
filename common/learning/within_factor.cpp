#include "common/learning/within_factor.hpp"

#include <algorithm>
#include <cmath>

namespace fathom::learning {
namespace {

using model::Factor;
using model::Quantity;

constexpr double kPlaceStep = 0.25;                           // of the room: of a point or a length
constexpr double kReachStep = 0.25, kReachSigma = 1.0;        // of the reach of an edge
constexpr double kBearingStep = 0.2, kBearingSigma = 0.6;     // rad
constexpr double kSizeStep = 0.25, kSizeSigma = 1.0;          // of the size of a force
constexpr double kSettlingStep = 0.25, kSettlingSigma = 1.0;  // of a time constant
constexpr double kQuickest = 1.0 / 60,
                 kSlowest = 2.0;  // of the recordings: time constants; beyond it is a straight line
constexpr double kShortest = 1.0 / 60, kLongest = 0.5;  // of the width of where it was: reaches of edges
constexpr double kLeastWidth = 0.1;                     // m
constexpr double kLeastSize = 1e-3;                     // N
constexpr double kDifference = 0.08;                    // of a step

/// A thrust curve, at a size.
bool bends(const Factor& factor) {
  return factor.quantity == Quantity::kThrustHeld || factor.quantity == Quantity::kThrustBelow;
}

Eigen::Vector3d outward(const Factor& near) {
  if (near.index == 1) return Eigen::Vector3d::UnitZ();
  if (near.index == 2) return -Eigen::Vector3d::UnitZ();
  return {std::cos(near.c), std::sin(near.c), 0.0};
}

}  // namespace

bool has_inner(const Factor& factor) {
  return factor.quantity == Quantity::kStretch || factor.quantity == Quantity::kPlanStretch ||
         factor.quantity == Quantity::kNear || factor.quantity == Quantity::kPlanBump ||
         factor.quantity == Quantity::kSettling || bends(factor);
}

std::vector<WithinFactor> inner_of(const Factor& factor, const Room& room) {
  std::vector<WithinFactor> all;
  if (factor.quantity == Quantity::kStretch) {
    for (const std::size_t which : {0, 1, 2, 3}) all.push_back({which, kPlaceStep * room.reach(), room.reach()});
  } else if (factor.quantity == Quantity::kPlanStretch) {
    for (const std::size_t which : {0, 1, 3}) all.push_back({which, kPlaceStep * room.reach(), room.reach()});
  } else if (factor.quantity == Quantity::kNear) {
    all.push_back({1, kReachStep * factor.b, kReachSigma * factor.b});
    if (factor.index == 0) all.push_back({2, kBearingStep, kBearingSigma});
  } else if (factor.quantity == Quantity::kSettling) {
    all.push_back({1, kSettlingStep * factor.b, kSettlingSigma * factor.b});
  } else if (bends(factor)) {
    all.push_back({0, kSizeStep * factor.a, kSizeSigma * factor.a});
  } else if (factor.quantity == Quantity::kPlanBump) {
    for (const std::size_t which : {0, 1}) all.push_back({which, kPlaceStep * factor.c, factor.c});
    all.push_back({2, kReachStep * factor.c, kReachSigma * factor.c});
  }
  return all;
}

double& number_of(Factor& factor, std::size_t which) {
  return which == 0 ? factor.a : which == 1 ? factor.b : which == 2 ? factor.c : factor.d;
}

void settle(Factor& factor, const Room& room) {
  if (factor.quantity == Quantity::kStretch || factor.quantity == Quantity::kPlanStretch)
    factor.d = std::max(factor.d, 0.0);
  if (factor.quantity == Quantity::kPlanBump) {
    const double width = 2.0 * std::max({room.half[1], room.half[2], 0.5 * kLeastWidth});
    factor.c = std::clamp(factor.c, kShortest * width, width);
  }
  if (factor.quantity == Quantity::kSettling) {
    const double length = std::max(2.0 * room.half[0], 1.0);
    factor.b = std::clamp(factor.b, kQuickest * length, kSlowest * length);
  }
  if (bends(factor)) factor.a = std::max(factor.a, kLeastSize);
  if (factor.quantity != Quantity::kNear) return;
  const Room::Along along = room.along(outward(factor));
  factor.a = along.edge;
  factor.b = std::clamp(factor.b, kShortest * 2.0 * along.half, kLongest * 2.0 * along.half);
}

Beside beside(model::Feature feature, const WithinFactor& inner, const Room& room) {
  Factor& factor = *factor_with_inner(feature);
  const double off = kDifference * inner.step;
  number_of(factor, inner.which) += off;
  if (factor.quantity == Quantity::kNear) factor.a = room.along(outward(factor)).edge;
  return {std::move(feature), off};
}

}  // namespace fathom::learning
