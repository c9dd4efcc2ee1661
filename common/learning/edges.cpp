#include "common/learning/edges.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace fathom::learning {
namespace {

constexpr double kSmallestWidth = 0.2;  // m: less than a vehicle's own size shows no wall
constexpr std::array kBearings{"north", "north-east", "east", "south-east",
                               "south", "south-west", "west", "north-west"};

std::string words_of(const std::string& side) { return "the " + side + " edge of where it was"; }

}  // namespace

std::vector<Edge> edges_of(const model::Scene& scene) {
  std::vector<Edge> edges;
  if (!scene.position) return edges;
  const Eigen::Vector3d middle = 0.5 * (scene.p_low + scene.p_high), half = 0.5 * (scene.p_high - scene.p_low);
  const auto take = [&](const std::string& side, int index, const Eigen::Vector3d& outward, double bearing) {
    const double width = 2.0 * outward.cwiseAbs().dot(half);
    if (width < kSmallestWidth) return;
    edges.push_back(
        {words_of(side),
         {.quantity = model::Quantity::kNear, .index = index, .a = outward.dot(middle) + 0.5 * width, .c = bearing},
         width});
  };
  for (std::size_t k = 0; k < kBearings.size(); ++k) {
    // No bearing is 0: files keep widths in the same place.
    const double bearing = 2.0 * std::numbers::pi * (k == 0 ? 1.0 : static_cast<double>(k) / kBearings.size());
    take(kBearings[k], 0, {std::cos(bearing), std::sin(bearing), 0.0}, bearing);
  }
  take("lower", 1, Eigen::Vector3d::UnitZ(), 1.0);
  take("upper", 2, -Eigen::Vector3d::UnitZ(), 1.0);
  return edges;
}

model::Factor near(const Edge& edge, double reach) {
  model::Factor factor = edge.along;
  factor.b = reach;
  return factor;
}

}  // namespace fathom::learning
