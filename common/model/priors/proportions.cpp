#include "common/model/priors/proportions.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/brief_number.hpp"

namespace fathom::model {
namespace {

// kg/m^3 of the box about the hull: a box that holds nothing but air weighs 1.2 with the air, a block of tungsten
// 19300.
constexpr double kLightest = 2.0;
constexpr double kHeaviest = 2e4;
// m/s^2 of all thrust on the dry mass: small ROVs of many thrusters reach 60, torpedoes driven by rockets 25.
constexpr double kFastest = 300.0;
constexpr double kWithWater = 6.0;  // times the rigid body, as LeavingSettings::heaviest_share

}  // namespace

double largest_push(const Vehicle& vehicle) {
  double each = vehicle.largest_thrust;
  for (const double force : vehicle.curve.force) each = std::max(each, std::abs(force));
  return each * static_cast<double>(vehicle.thrusters.size());
}

void check_proportions(const Config& config, const Vehicle& vehicle) {
  if (vehicle.mass <= 0.0) return;
  const std::string mass = "'mass' of " + brief_number(vehicle.mass) + " kg is ";
  if (vehicle.hull.minCoeff() > 0.0) {
    const double box = vehicle.hull.prod();
    if (vehicle.mass < kLightest * box)
      config.fail("mass", mass + "no more than the air in this 'hull' weighs: at least " +
                              brief_number(kLightest * box) + " kg; are the units of both right?");
    if (vehicle.mass > kHeaviest * box)
      config.fail("mass", mass + "more than this 'hull' would weigh if it were all tungsten: at most " +
                              brief_number(kHeaviest * box) + " kg; are the units of both right?");
  }
  const double push = largest_push(vehicle);
  if (push > kFastest * vehicle.mass)
    config.fail("mass", mass + "too little for " + brief_number(push) + " N of thrust, which would move it off with " +
                            brief_number(push / vehicle.mass / 9.81) + " times gravity: at least " +
                            brief_number(push / kFastest) + " kg; are the units of both right?");
  for (int axis = 0; axis < 3; ++axis) check_moment(config, "inertia", "inertia", axis, vehicle.inertia[axis], vehicle);
}

// All mass in the hull's corners is the most that a rigid body can have; some more for the water that turns with it.
void check_moment(const Config& section, const std::string& line, const std::string& key, int axis, double moment,
                  const Vehicle& vehicle) {
  if (vehicle.mass <= 0.0 || vehicle.hull.minCoeff() <= 0.0) return;
  Eigen::Vector3d corner = 0.5 * vehicle.hull;
  corner[axis] = 0.0;
  const double largest = kWithWater * vehicle.mass * corner.squaredNorm();
  if (moment <= largest) return;
  section.fail(line, "'" + key + "' of " + brief_number(moment) +
                         " kg m^2 is impossible: with this 'mass' and 'hull', " + "water included, it is at most " +
                         brief_number(largest) + " kg m^2; correct one of the three");
}

}  // namespace fathom::model
