#include "common/model/hull_in_flow.hpp"

namespace fathom::model {

bool lives_by_flow(const Vehicle& vehicle) {
  const bool carried =
      vehicle.dof[1] && !vehicle.dof[2] && vehicle.has_thrusters() && vehicle.allocation.row(1).isZero(1e-6);
  return vehicle.flow_matters || vehicle.weight_moves || vehicle.windage > 0.0 || carried;
}

double assumed_windage(const Vehicle& vehicle) {
  constexpr double kAbove = 0.5;  // of the hull's height
  const auto& [surge, sway, heave, roll, pitch, yaw] = vehicle.dof;
  const bool level = surge && sway && yaw && !heave && !roll && !pitch;
  return level && lives_by_flow(vehicle) ? kAbove * vehicle.hull.x() * vehicle.hull.z() : 0.0;
}

}  // namespace fathom::model
