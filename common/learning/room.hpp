// When and where recordings were: time, north, east and depth, about their middles.
#pragma once

#include <array>

#include "common/likelihood/filter.hpp"

namespace fathom::learning {

struct Room {
  explicit Room(const likelihood::Problem& problem);
  /// Reads time, north, east or depth, by its number, from -1 to 1.
  [[nodiscard]] model::Factor factor(std::size_t i) const;
  /// Half of the diagonal, m; not nothing.
  [[nodiscard]] double reach() const;
  /// How far the box goes along a direction of W, m, and half of its width there.
  struct Along {
    double edge{}, half{};
  };
  [[nodiscard]] Along along(const Eigen::Vector3d& n_W) const;

  std::array<double, 4> middle{}, half{};  ///< s, m
};

}  // namespace fathom::learning
