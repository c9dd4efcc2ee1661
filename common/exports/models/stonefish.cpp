// A body for Stonefish (patrykcieslak/stonefish, docs/bodies.rst): frames north-east-down and forward-right-down, as
// here. It computes drag and added mass from the geometry; mass, inertia and centre of mass can be told, so can a shape
// that displaces the identified volume about the identified centre of buoyancy. The rest stands in the comment.
#include <algorithm>

#include "common/exports/models/formats.hpp"

namespace fathom::exports {

ModelFile to_stonefish(const Craft& craft) {
  ModelFile file{.extension = "scn", .text = {}, .unsaid = craft.notes};
  const auto list = [](const Vector6d& values) { return exact(values, " "); };
  file.unsaid.push_back("added mass and inertia, X Y Z K M N (computed from the shape instead): " + list(craft.added));
  file.unsaid.push_back("linear drag, X_u .. N_r (computed from the shape instead): " + list(craft.linear));
  file.unsaid.push_back("quadratic drag, X_u|u| .. N_r|r| (computed from the shape instead): " + list(craft.quadratic));
  if (!craft.thrusters.empty()) file.unsaid.emplace_back("thrusters: an actuator for each belongs into the robot");
  const double side = std::cbrt(craft.volume());
  const std::string centre = exact(craft.p_BB.x()) + " " + exact(craft.p_BB.y()) + " " + exact(craft.p_BB.z());
  file.text =
      "<?xml version=\"1.0\"?>\n<!--\n" + in_comment(craft.name) +
      ", identified by fathom. Body forward-right-down; SI. The box displaces the identified volume; put the "
      "vehicle's own mesh in its place.\nNot said here:\n" +
      comment(file, "- ") +
      "-->\n<scenario>\n  <environment>\n    <ned latitude=\"0\" longitude=\"0\"/>\n"
      "    <ocean>\n      <water density=\"" +
      exact(craft.density) +
      "\" jerlov=\"0.2\"/>\n    </ocean>\n  </environment>\n  <materials>\n    <material name=\"Hull\" density=\"" +
      exact(craft.mass / craft.volume()) +
      "\" restitution=\"0.5\"/>\n  </materials>\n"
      "  <looks>\n    <look name=\"Hull\" gray=\"0.5\" roughness=\"0.5\"/>\n  </looks>\n  <dynamic name=\"" +
      identifier(craft.name) + "\" type=\"box\" physics=\"submerged\" buoyant=\"true\">\n    <dimensions xyz=\"" +
      exact(side) + " " + exact(side) + " " + exact(side) + "\"/>\n    <origin xyz=\"" + centre +
      "\" rpy=\"0 0 0\"/>\n    <mass value=\"" + exact(craft.mass) + "\"/>\n    <inertia xyz=\"" +
      exact(craft.inertia.x()) + " " + exact(craft.inertia.y()) + " " + exact(craft.inertia.z()) +
      "\"/>\n    <cg xyz=\"0 0 0\" rpy=\"0 0 0\"/>\n    <material name=\"Hull\"/>\n    <look name=\"Hull\"/>\n"
      "    <world_transform xyz=\"0 0 2\" rpy=\"0 0 0\"/>\n  </dynamic>\n</scenario>\n";
  return file;
}

}  // namespace fathom::exports
