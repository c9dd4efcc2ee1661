// A force of no particular form: any smooth curve over one measured quantity, on one axis. No cause has this form, but
// whatever depends on that quantity has; it is what a named effect must be better than.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "common/model/effect.hpp"

namespace fathom::diagnosis {

/// What a curve may run over. Heading is periodic.
enum class Quantity { kDepth, kNorth, kEast, kHeading, kTime, kSpeed, kThrust };

class FreeCurve final : public model::Effect {
 public:
  static constexpr std::size_t kKnots = 8;  ///< as many numbers: the force at each, linear between them

  /// Force along `axis` (0..5) over `quantity` from `low` to `high` [SI], held beyond; `ordinary` [N, N m] is the prior
  /// sigma of the force at a knot.
  FreeCurve(int axis, Quantity quantity, double low, double high, double ordinary, bool input_is_wrench);

  [[nodiscard]] int axis() const { return axis_; }
  [[nodiscard]] Quantity quantity() const { return quantity_; }

 private:
  int axis_;
  Quantity quantity_;
};

[[nodiscard]] const char* name_of(Quantity quantity);

/// Every curve that this data can show.
[[nodiscard]] std::vector<std::unique_ptr<const FreeCurve>> free_curves(const model::Scene& scene);

}  // namespace fathom::diagnosis
