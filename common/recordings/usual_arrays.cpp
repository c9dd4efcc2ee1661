// Arrays that are called as Fathom's canonical columns are, or as Fossen writes them: u v w, nu, eta, phi theta psi.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>
#include <string_view>

#include "common/recordings/usual_topics.hpp"
#include "common/tables/map_writer.hpp"

namespace fathom::recordings {
namespace {

using Names = std::vector<std::string>;

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// Fields by their names without holders and capitals: "nav.Nu[0]" is "nu[0]". Of two that are the same none is taken.
class Fields {
 public:
  explicit Fields(const TopicAccount& topic) : topic_{topic} {}

  [[nodiscard]] const std::string* find(const std::string& name) const {
    const std::string* found = nullptr;
    for (std::size_t i = 0; i < topic_.topic.fields.size(); ++i) {
      const std::string& whole = topic_.topic.fields[i].name;
      const auto dot = whole.find_last_of('.');
      if (lower(dot == std::string::npos ? whole : whole.substr(dot + 1)) != name || topic_.fields[i].finite == 0)
        continue;
      if (found != nullptr) return nullptr;
      found = &whole;
    }
    return found;
  }
  /// The columns of the first of `choices` whose names are all there.
  [[nodiscard]] Names first_of(const std::vector<Names>& choices) const {
    for (const Names& names : choices) {
      Names there;
      for (const std::string& name : names) {
        if (const std::string* field = find(name)) there.push_back(*field);
      }
      if (there.size() == names.size()) return there;
    }
    return {};
  }
  /// name[0] to name[n-1], of exactly n, from `begin` on; names that are never there where it has another length.
  [[nodiscard]] Names part(const std::string& name, std::size_t n, std::size_t begin, std::size_t count) const {
    Names names;
    const auto element = [&](std::size_t i) { return name + "[" + std::to_string(i) + "]"; };
    if (find(element(n - 1)) == nullptr || find(element(n)) != nullptr) return {"-"};
    for (std::size_t i = begin; i < begin + count; ++i) names.push_back(element(i));
    return names;
  }
  [[nodiscard]] Names all(const std::string& name) const {
    Names names;
    for (std::size_t i = 0;; ++i) {
      const std::string* field = find(name + "[" + std::to_string(i) + "]");
      if (field == nullptr) return names;
      names.push_back(*field);
    }
  }
  [[nodiscard]] std::string list(const Names& names) const {
    std::string text = "[";
    for (const std::string& name : names) text += (text.size() > 1 ? ", " : "") + written(name);
    return text + "]";
  }
  [[nodiscard]] std::string written(const std::string& name) const {
    return tables::written_name(topic_.topic.name + "." + name);
  }
  [[nodiscard]] double largest(const Names& names) const {
    double largest = 0.0;
    for (std::size_t i = 0; i < topic_.topic.fields.size(); ++i) {
      if (std::ranges::find(names, topic_.topic.fields[i].name) != names.end())
        largest = std::max({largest, std::abs(topic_.fields[i].least), std::abs(topic_.fields[i].greatest)});
    }
    return largest;
  }

 private:
  const TopicAccount& topic_;
};

}  // namespace

void named_arrays(const TopicAccount& topic, std::vector<Entry>& out) {
  const Fields fields{topic};
  const std::string remark =
      "read by their names as SI, north-east-down and forward-right-down, as canonical columns are: check units and "
      "axes";
  const auto add = [&](Quantity quantity, Names lines) {
    out.push_back({quantity, 2, topic.topic.name, std::move(lines), remark, true});
  };
  const auto vector = [&](const char* key, const Names& names, const char* unit, const char* frame) {
    return std::string{key} + ": {columns: " + fields.list(names) + ", unit: " + unit + ", frame: " + frame + "}";
  };
  const Names position = fields.first_of({{"x", "y", "z"}, {"north", "east", "down"}, fields.part("eta", 6, 0, 3)});
  const Names angles = fields.first_of(
      {{"phi", "theta", "psi"}, {"roll", "pitch", "yaw"}, {"roll", "pitch", "heading"}, fields.part("eta", 6, 3, 3)});
  const Names wxyz =
      fields.first_of({fields.part("quat_wxyz", 4, 0, 4), fields.part("q_wxyz", 4, 0, 4), {"qw", "qx", "qy", "qz"}});
  const Names rates =
      fields.first_of({{"p", "q", "r"}, fields.part("nu", 6, 3, 3), fields.part("rates", 3, 0, 3), {"wx", "wy", "wz"}});
  const Names velocity = fields.first_of(
      {{"u", "v", "w"}, fields.part("nu", 6, 0, 3), rates.empty() ? Names{"-"} : fields.part("nu", 3, 0, 3)});
  const Names force = fields.first_of({{"ax", "ay", "az"}});

  Names attitude;
  if (!wxyz.empty()) {
    attitude = {"quaternion: {columns: " + fields.list(wxyz) + ", order: wxyz, world: NED, body: FRD}"};
  } else if (!angles.empty()) {
    const bool degrees = fields.largest(angles) > 2.0 * std::numbers::pi;
    attitude = {"euler: {columns: " + fields.list(angles) + ", unit: " + (degrees ? "deg" : "rad") +
                ", world: NED, body: FRD}"};
  }
  if (!position.empty()) {
    Names lines{vector("position", position, "m", "NED")};
    lines.insert(lines.end(), attitude.begin(), attitude.end());
    add(Quantity::kPose, lines);
    attitude.clear();
  }
  Names inertial;
  if (!rates.empty()) inertial.push_back(vector("rates", rates, "rad/s", "FRD"));
  if (!force.empty()) inertial.push_back(vector("specific_force", force, "m/s^2", "FRD"));
  inertial.insert(inertial.end(), attitude.begin(), attitude.end());
  if (!inertial.empty()) add(Quantity::kInertial, inertial);
  if (!velocity.empty()) add(Quantity::kVelocity, {vector("velocity", velocity, "m/s", "FRD")});
  if (const std::string* depth = fields.find("depth"))
    add(Quantity::kDepth, {"column: " + fields.written(*depth), "unit: m", "direction: down"});
  const Names pulses = fields.all("pwm"), wrench = fields.first_of({fields.part("tau", 6, 0, 6)});
  Names thrust;
  if (pulses.size() > 1 && fields.largest(pulses) > 800.0)
    thrust.push_back("pwm: {columns: " + fields.list(pulses) + ", unit: us}");
  if (!wrench.empty())
    thrust.push_back("wrench: {columns: " + fields.list(wrench) + ", force_unit: N, moment_unit: N m, frame: FRD}");
  if (!thrust.empty()) add(Quantity::kThrust, thrust);
  for (const char* name : {"voltage", "volts", "v"}) {
    const std::string* voltage = fields.find(name);
    const bool of_a_battery = std::string_view{name} != "v" || lower(topic.topic.name).find("bat") != std::string::npos;
    if (voltage == nullptr || !of_a_battery) continue;
    add(Quantity::kBattery, {"column: " + fields.written(*voltage), "unit: V"});
    break;
  }
}

}  // namespace fathom::recordings
