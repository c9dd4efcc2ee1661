// The underwater object plugin of UUV simulator (Gazebo classic; uuvsimulator/uuv_simulator, HydrodynamicModel.cc,
// BuoyantObject.cc), model "fossen": added_mass, the 36 numbers of a matrix, positive; linear_damping and
// quadratic_damping negative where they dissipate; volume and centre of buoyancy; its fluid is told too,
// since its default (1028 kg/m^3) is not Fathom's. Body forward-left-up, world z up.
#include "common/exports/models/formats.hpp"

namespace fathom::exports {

ModelFile to_uuv_simulator(const Craft& craft) {
  ModelFile file{.extension = "uuv.sdf", .text = {}, .unsaid = craft.notes};
  file.unsaid.emplace_back(
      "the plugin filters the acceleration that added mass acts on (factor 0.3 per step): steps of 1 ms or less");
  if (!craft.thrusters.empty())
    file.unsaid.emplace_back("thrusters: a thruster plugin for each belongs into this model");
  const Eigen::Vector3d centre = flipped(craft.p_BB);
  std::string matrix;
  for (Eigen::Index row = 0; row < 6; ++row) {
    matrix += "\n            ";
    for (Eigen::Index column = 0; column < 6; ++column)
      matrix += (column == 0 ? "" : " ") + exact(row == column ? craft.added[row] : 0.0);
  }
  file.text =
      "<?xml version=\"1.0\"?>\n<!--\n" + in_comment(craft.name) +
      ", identified by fathom. Body forward-left-up; SI.\nNot said here:\n" + comment(file, "- ") +
      "-->\n<sdf version=\"1.6\">\n  <model name=\"" + identifier(craft.name) +
      "\">\n    <link name=\"base_link\">\n      <inertial>\n        <mass>" + exact(craft.mass) +
      "</mass>\n        <inertia>\n          <ixx>" + exact(craft.inertia.x()) + "</ixx>\n          <iyy>" +
      exact(craft.inertia.y()) + "</iyy>\n          <izz>" + exact(craft.inertia.z()) +
      "</izz>\n        </inertia>\n      </inertial>\n    </link>\n"
      "    <plugin name=\"uuv_plugin\" filename=\"libuuv_underwater_object_ros_plugin.so\">\n      <fluid_density>" +
      exact(craft.density) +
      "</fluid_density>\n      <flow_velocity_topic>hydrodynamics/current_velocity</flow_velocity_topic>\n"
      "      <link name=\"base_link\">\n        <neutrally_buoyant>0</neutrally_buoyant>\n        <volume>" +
      exact(craft.volume()) + "</volume>\n        <center_of_buoyancy>" + exact(centre.x()) + " " + exact(centre.y()) +
      " " + exact(centre.z()) +
      "</center_of_buoyancy>\n        <hydrodynamic_model>\n          <type>fossen</type>\n"
      "          <added_mass>" +
      matrix + "\n          </added_mass>\n          <linear_damping>" + exact(craft.linear, " ") +
      "</linear_damping>\n          <quadratic_damping>" + exact(craft.quadratic, " ") +
      "</quadratic_damping>\n        </hydrodynamic_model>\n      </link>\n    </plugin>\n  </model>\n</sdf>\n";
  return file;
}

}  // namespace fathom::exports
