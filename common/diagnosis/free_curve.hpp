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

  [[nodiscard]] std::string_view name() const override { return "free_curve"; }
  [[nodiscard]] std::string_view sentence() const override { return "Something depends on a measured quantity."; }
  [[nodiscard]] std::string_view revealed_by() const override { return "motion that covers the quantity evenly"; }
  [[nodiscard]] std::span<const model::EffectParameter> parameters() const override { return parameters_; }
  [[nodiscard]] bool knows_size() const override { return true; }
  [[nodiscard]] bool feels_place() const override { return true; }
  void load(const model::Motion& motion, model::EffectTheta theta, int variant, model::Load& load) const override;

 private:
  [[nodiscard]] double value(const model::Motion& motion) const;

  int axis_;
  Quantity quantity_;
  double low_, high_;
  bool input_is_wrench_;
  std::array<model::EffectParameter, kKnots> parameters_;
};

[[nodiscard]] const char* name_of(Quantity quantity);

/// Every curve that this data can show.
[[nodiscard]] std::vector<std::unique_ptr<const FreeCurve>> free_curves(const model::Scene& scene);

}  // namespace fathom::diagnosis
