// Edges of where a recording has been: behind one of them a wall, the floor or the surface may be, wherever it is.
#pragma once

#include <string>
#include <vector>

#include "common/model/learned/features.hpp"
#include "common/model/scene.hpp"

namespace fathom::learning {

struct Edge {
  std::string words;    ///< "the north-east edge of where it was"
  model::Factor along;  ///< nearness to it, its reach left open
  double width{};       ///< m, of where it was, across
};

/// Upright ones every 45 degrees, one below and one above; none across which it has not moved, or without positions.
[[nodiscard]] std::vector<Edge> edges_of(const model::Scene& scene);

/// Nearness that falls by e within `reach` m.
[[nodiscard]] model::Factor near(const Edge& edge, double reach);

}  // namespace fathom::learning
