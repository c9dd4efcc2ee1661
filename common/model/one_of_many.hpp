// Forms of which a vehicle may have fewer than there are: one per thruster, one per set of components. Those behind the
// last that it has are left out of the list of an effect's forms.
#pragma once

#include "common/model/form.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model {

class OneOfMany : public Form {
 public:
  using Form::Form;
  /// Whether the vehicle has what the form is about; by default, whether the form can act.
  [[nodiscard]] virtual bool exists(const Scene& scene) const { return name(scene).has_value(); }
};

class OfThruster : public OneOfMany {
 public:
  explicit OfThruster(Eigen::Index thruster, FormTraits traits = {}) : OneOfMany{traits}, thruster_{thruster} {}
  [[nodiscard]] bool exists(const Scene& scene) const final { return place() < scene.vehicle->thrusters.size(); }

 protected:
  [[nodiscard]] std::size_t place() const { return static_cast<std::size_t>(thruster_); }
  Eigen::Index thruster_;
};

}  // namespace fathom::model
