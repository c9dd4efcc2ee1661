// Where the vehicle has been, in a few hundred places however long the trial: enough to rule out a boundary there.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/model/effect.hpp"

namespace fathom::diagnosis {

/// Share of the time that a vehicle may seem to spend where it cannot be: a boundary is known to some centimetres.
inline constexpr double kInside = 0.05;

class Places {
 public:
  void add(const Eigen::Vector3d& p_WB);
  void clear();
  /// True when the vehicle cannot have been there, were these numbers true.
  [[nodiscard]] bool rule_out(const model::Effect& effect, model::EffectTheta theta, int variant) const;
  [[nodiscard]] std::size_t size() const { return places_.size(); }

 private:
  std::vector<Eigen::Vector3d> places_;
  std::int64_t heard_{};
  std::int64_t stride_{1};  // every so many are kept
};

}  // namespace fathom::diagnosis
