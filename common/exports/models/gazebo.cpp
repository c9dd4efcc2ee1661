// SDF for Gazebo (gz-sim 8 and later). Its system Hydrodynamics (gazebosim/gz-sim, src/systems/hydrodynamics) wants the
// stability derivatives as SNAME has them, negative where they dissipate, under the names xU .. nR and xUabsU .. nRabsR
// (older releases read xUU, which later ones take for another term: the quadratic drag is lost without a word). Added
// mass belongs into <fluid_added_mass> of the link, positive; DART alone simulates it, with its Coriolis and Munk
// terms. World: east-north-up or any z up; body: forward-left-up. Diagonal terms are the same there as
// forward-right-down.
#include "common/exports/models/formats.hpp"

namespace fathom::exports {
namespace {

std::string tag(const std::string& name, double value, int indent) {
  return std::string(static_cast<std::size_t>(indent), ' ') + "<" + name + ">" + exact(value) + "</" + name + ">\n";
}

}  // namespace

ModelFile to_gazebo(const Craft& craft) {
  ModelFile file{.extension = "sdf", .text = {}, .unsaid = craft.notes};
  file.unsaid.emplace_back(
      "water that moves: DART's added mass feels the motion over ground, not that through the water");
  if (!craft.thrusters.empty())
    file.unsaid.emplace_back(
        "thrusters: a joint and a system gz::sim::systems::Thruster for each belong into this model");
  const Eigen::Vector3d centre = flipped(craft.p_BB);
  const double side = std::cbrt(craft.volume());
  const std::string box = exact(side) + " " + exact(side) + " " + exact(side);
  std::string& text = file.text;
  text = "<?xml version=\"1.0\"?>\n<!--\n" + in_comment(craft.name) +
         ", identified by fathom. Body forward-left-up; SI. Physics engine: DART (added mass).\n"
         "The world needs gz-sim-buoyancy-system with <uniform_fluid_density>" +
         exact(craft.density) + "</uniform_fluid_density>, and gravity 0 0 -" + exact(Craft::kGravity) + ".\n" +
         "Not said here:\n" + comment(file, "- ") + "-->\n<sdf version=\"1.10\">\n  <model name=\"" +
         identifier(craft.name) + "\">\n    <link name=\"base_link\">\n      <inertial>\n" +
         tag("mass", craft.mass, 8) + "        <inertia>\n" + tag("ixx", craft.inertia.x(), 10) +
         tag("iyy", craft.inertia.y(), 10) + tag("izz", craft.inertia.z(), 10) +
         "        </inertia>\n        <fluid_added_mass>\n";
  constexpr const char* kAxes[6] = {"x", "y", "z", "p", "q", "r"};
  for (Eigen::Index i = 0; i < 6; ++i) text += tag(std::string(kAxes[i]) + kAxes[i], craft.added[i], 10);
  text +=
      "        </fluid_added_mass>\n      </inertial>\n"
      "      <!-- Its volume is what floats: the buoyancy system takes it from here. -->\n"
      "      <collision name=\"displaced_volume\">\n        <pose>" +
      exact(centre.x()) + " " + exact(centre.y()) + " " + exact(centre.z()) +
      " 0 0 0</pose>\n        <geometry><box><size>" + box +
      "</size></box></geometry>\n      </collision>\n      <visual name=\"visual\">\n        <geometry><box><size>" +
      box +
      "</size></box></geometry>\n      </visual>\n    </link>\n"
      "    <plugin filename=\"gz-sim-hydrodynamics-system\" name=\"gz::sim::systems::Hydrodynamics\">\n"
      "      <link_name>base_link</link_name>\n" +
      tag("water_density", craft.density, 6) +
      "      <disable_added_mass>true</disable_added_mass>\n      <disable_coriolis>true</disable_coriolis>\n";
  constexpr const char* kForce[6] = {"x", "y", "z", "k", "m", "n"};
  constexpr const char* kSpeed[6] = {"U", "V", "W", "P", "Q", "R"};
  for (Eigen::Index i = 0; i < 6; ++i) {
    const std::string linear = std::string(kForce[i]) + kSpeed[i];
    text += tag(linear, craft.linear[i], 6) + tag(linear + "abs" + kSpeed[i], craft.quadratic[i], 6);
  }
  text += "    </plugin>\n  </model>\n</sdf>\n";
  return file;
}

}  // namespace fathom::exports
