// Numbers inside a factor that no weight can stand for, sought by what the force does when they change: the point and
// the length of a line that pulls, the bearing and the reach of an edge, a place in the plan and how wide it is, the
// size at which a thrust curve bends, the time constant of what settles.
#pragma once

#include <vector>

#include "common/learning/room.hpp"
#include "common/model/learned/features.hpp"

namespace fathom::learning {

/// One of them: a, b, c or d of a factor, by its number.
struct WithinFactor {
  std::size_t which{};
  double step{};   ///< by which it may move at once
  double sigma{};  ///< how far it may be from where it is
};

[[nodiscard]] bool has_inner(const model::Factor& factor);
/// Of a factor that has some.
[[nodiscard]] std::vector<WithinFactor> inner_of(const model::Factor& factor, const Room& room);
[[nodiscard]] double& number_of(model::Factor& factor, std::size_t which);
/// Where its numbers are possible, after some have moved. What else follows from them is set anew.
void settle(model::Factor& factor, const Room& room);

/// The first of a feature's factors that has some; none: null.
template <typename Of>
[[nodiscard]] auto factor_with_inner(Of& feature) -> decltype(feature.factors.data()) {
  for (int i = 0; i < feature.count; ++i) {
    auto& factor = feature.factors[static_cast<std::size_t>(i)];
    if (has_inner(factor)) return &factor;
  }
  return nullptr;
}

/// The same feature with that number a little larger, and by how much: the difference of the two is a derivative.
struct Beside {
  model::Feature feature;
  double off{};
};
[[nodiscard]] Beside beside(model::Feature feature, const WithinFactor& inner, const Room& room);

}  // namespace fathom::learning
