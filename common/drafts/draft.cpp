#include "common/drafts/draft.hpp"

#include <cmath>
#include <cstdio>

namespace fathom::drafts {
namespace {

std::string text_of(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", std::abs(value) < 1e-9 ? 0.0 : value);
  return text;
}

std::string text_of(const Eigen::Vector3d& v) { return text_of(v.x()) + " " + text_of(v.y()) + " " + text_of(v.z()); }

bool is_control(char c) {
  const auto code = static_cast<unsigned char>(c);  // char is unsigned on arm64
  return code < ' ' || code == 0x7F;
}

// A plain word, or in quotes what YAML would read as something else.
std::string quoted(const std::string& name) {
  const bool plain =
      !name.empty() && std::isalpha(static_cast<unsigned char>(name[0])) != 0 &&
      name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-/.") == std::string::npos;
  if (plain) return name;
  std::string text = "'";
  for (const char c : name) {
    if (is_control(c)) continue;
    text += c;
    if (c == '\'') text += c;
  }
  return text + "'";
}

// Nothing of a remark may leave its line.
std::string comment(const std::string& remark) {
  std::string text = "# ";
  for (const char c : remark) text += is_control(c) ? ' ' : c;
  return text + "\n";
}

}  // namespace

std::string vehicle_file(const Draft& draft) {
  std::string text;
  for (const std::string& remark : draft.remarks) text += comment(remark);
  text += "name: " + quoted(draft.name) + "\n";
  text +=
      "dof: [surge, sway, heave, roll, pitch, yaw]  # those that are free; leave out what the water's surface or fins "
      "hold\n\n";
  text += draft.mass ? "mass: " + text_of(*draft.mass) + " kg\n" : "mass: MEASURE kg  # weigh it as it dives\n";
  if (draft.inertia) text += "inertia: " + text_of(*draft.inertia) + " kg m^2\n";
  text += draft.water_density ? "water_density: " + text_of(*draft.water_density) + " kg/m^3\n"
                              : std::string{"water_density: 1000 kg/m^3  # fresh water; the sea: 1025\n"};
  if (draft.largest_thrust) text += "largest_thrust: " + text_of(*draft.largest_thrust) + " N\n";
  if (!draft.thrusters.empty()) text += "\nthrusters:  # positive force pushes along the axis\n";
  for (const DraftThruster& each : draft.thrusters) {
    text += "  - {name: " + quoted(each.name) + ", position: " + (each.p_BJ ? text_of(*each.p_BJ) : "MEASURE") +
            " m, axis: " + text_of(each.axis_B) + "}";
    if (!each.note.empty()) text += "  " + comment(each.note).substr(0, 2 + each.note.size());
    text += "\n";
  }
  return text + draft.tail;
}

}  // namespace fathom::drafts
