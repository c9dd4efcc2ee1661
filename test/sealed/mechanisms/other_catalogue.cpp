// Which listed and foreign things happen to craft that are no ROVs, and those that happen to none else: wind on what
// stands above the water, gusts of it, a steady pull.
#include <algorithm>
#include <stdexcept>

#include "test/sealed/mechanisms/mechanism_tools.hpp"

namespace fathom::sealed {
namespace {

using Eigen::Vector3d;
using Numbers = std::map<std::string, double>;

constexpr double kAir = 1.23;                     // kg/m^3
constexpr double kBowOn = 0.6, kBroadside = 0.9;  // drag coefficients of small craft (Blendermann 1994)

/// Force of the wind past the craft, less what still air does, which is part of the hull's drag.
Vector6 push_of_wind(const Craft& craft, const Instant& at, const Vector3d& wind, double arm) {
  const Vector3d blown = at.turn.transpose() * wind;
  const Eigen::Vector2d own = at.nu.head<2>(), past = blown.head<2>() - own;
  const Eigen::Vector2d push = 0.5 * kAir * craft.windage * (past.norm() * past + own.norm() * own);
  Vector6 wrench = Vector6::Zero();
  wrench[0] = kBowOn * push.x();
  wrench[1] = kBroadside * push.y();
  wrench[5] = arm * wrench[1];
  return wrench;
}

class Wind : public Sized {
 public:
  Wind(const std::string& name, const Craft& craft, const Site&, Random& random)
      : Sized(name, 4.0, 16.0),
        craft_(craft),
        heading_(random.uniform(-std::numbers::pi, std::numbers::pi)),
        arm_(random.uniform(-0.1, 0.15) * craft.extent.x()) {}
  void body(const Instant& at, std::span<const double>, std::span<double>, Terms& terms) const override {
    if (size() > 0.0) terms.wrench += push_of_wind(craft_, at, velocity(), arm_);
  }
  [[nodiscard]] Numbers parameters() const override {
    return {{"W_N", velocity().x()}, {"W_E", velocity().y()}, {"arm", arm_}};
  }

 protected:
  [[nodiscard]] const Craft& craft() const { return craft_; }
  [[nodiscard]] double arm() const { return arm_; }
  [[nodiscard]] Vector3d velocity() const { return size() * Vector3d(std::cos(heading_), std::sin(heading_), 0.0); }

 private:
  Craft craft_;
  double heading_, arm_;
};

/// No mean worth the name: the wind comes and goes.
class Gusts : public Wind {
 public:
  using Wind::Wind;
  void begin_file(double from, double to, Random& random) override { blows_.draw(from, to, 14.0, 4.0, 15.0, random); }
  void body(const Instant& at, std::span<const double>, std::span<double>, Terms& terms) const override {
    if (size() > 0.0 && blows_.at(at.t)) terms.wrench += push_of_wind(craft(), at, velocity(), arm());
  }

 private:
  Episodes blows_;
};

/// A long taut line: the same pull wherever the craft is.
class SteadyPull : public Sized {
 public:
  SteadyPull(const std::string& name, const Craft& craft, const Site&, Random& random)
      : Sized(name, 0.1 * usual_drag(craft)[0], 3.0 * usual_drag(craft)[0]),
        heading_(random.uniform(-std::numbers::pi, std::numbers::pi)) {}
  void body(const Instant& at, std::span<const double>, std::span<double>, Terms& terms) const override {
    terms.wrench.head<3>() += at.turn.transpose() * (size() * Vector3d(std::cos(heading_), std::sin(heading_), 0.0));
  }
  [[nodiscard]] Numbers parameters() const override {
    return {{"F_N", size() * std::cos(heading_)}, {"F_E", size() * std::sin(heading_)}};
  }

 private:
  double heading_;
};

using Names = std::vector<std::string>;

std::vector<const Entry*> entries(const Names& names) {
  std::vector<const Entry*> list;
  for (const std::string& name : names) {
    list.push_back(find_entry(name));
    if (list.back() == nullptr) throw std::logic_error(name + " is in no list");
  }
  return list;
}

std::vector<const Entry*> all_of(const std::vector<Entry>& list) {
  std::vector<const Entry*> all;
  for (const Entry& entry : list) all.push_back(&entry);
  return all;
}

}  // namespace

const std::vector<Entry>& surface_entries() {
  static const std::vector<Entry> list{{"wind", {.windage = true}, make<Wind>}, {"steady_force", {}, make<SteadyPull>}};
  return list;
}

const std::vector<Entry>& surface_foreign() {
  static const std::vector<Entry> list{{"gusts", {.windage = true}, make<Gusts>}};
  return list;
}

std::vector<const Entry*> catalogue_of(CraftClass craft_class) {
  switch (craft_class) {
    case CraftClass::kRov:
      return all_of(catalogue());
    case CraftClass::kTorpedo:
      return entries({"current", "thruster_lag", "cubic_drag", "thruster_gain", "thruster_delay", "payload_change",
                      "wave", "thruster_failure", "fluid_memory", "compressibility", "thruster_misalignment",
                      "sensor_scale", "lever_arm", "sensor_latency"});
    case CraftClass::kBoat:
      return entries({"current", "thruster_lag", "wind", "thruster_deadband", "thruster_gain", "asymmetric_drag",
                      "thrust_asymmetry", "thruster_delay", "payload_change", "steady_force", "thruster_failure",
                      "cubic_drag", "battery_sag", "fluid_memory", "wave", "thruster_misalignment", "sensor_scale",
                      "lever_arm", "sensor_latency"});
    case CraftClass::kShip:
      return entries({"current", "thruster_lag", "wind", "thruster_gain", "cubic_drag", "steady_force",
                      "thruster_delay", "thruster_failure", "wave", "fluid_memory", "sensor_scale", "lever_arm",
                      "sensor_latency"});
    case CraftClass::kGlider:
      return entries({"thruster_lag", "thruster_gain", "compressibility", "thruster_delay", "payload_change",
                      "thruster_failure", "cubic_drag", "sensor_scale", "sensor_latency"});
  }
  return {};
}

std::vector<const Entry*> foreign_of(CraftClass craft_class) {
  switch (craft_class) {
    case CraftClass::kRov:
      return all_of(foreign());
    case CraftClass::kTorpedo:
      return entries({"air_bursts", "upwelling", "fouling", "sensor_stick", "thrust_hysteresis"});
    case CraftClass::kBoat:
    case CraftClass::kShip:
      return entries({"gusts", "air_bursts", "fouling", "sensor_stick", "thrust_hysteresis"});
    case CraftClass::kGlider:
      return entries({"upwelling", "fouling", "sensor_stick"});
  }
  return {};
}

}  // namespace fathom::sealed
