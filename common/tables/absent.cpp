#include "common/tables/absent.hpp"

#include <algorithm>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/motions.hpp"

namespace fathom::tables {
namespace {

constexpr int kYaw = 5;

/// One component of a group, and the axes whose motion shows in it.
struct Component {
  std::string name;
  std::vector<int> axes;
};

std::string listed(const std::vector<std::string>& words, const std::string& quote) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + quote + word + quote;
  return text;
}

class Completion {
 public:
  Completion(const std::string& path, const std::optional<SimulatedAxes>& simulated)
      : path_(path), simulated_(simulated) {}

  void complete(std::vector<Column>& columns, const std::vector<Component>& components) {
    if (columns.size() < components.size()) spread(columns, components);
    std::vector<std::string> there, lacking, axes;
    for (std::size_t i = 0; i < components.size(); ++i) {
      if (!columns[i].absent) {
        there.push_back(columns[i].name);
        continue;
      }
      const auto needed = needing(components[i]);
      if (needed.empty()) {
        zero_.push_back(components[i].name);
        continue;
      }
      lacking.push_back(components[i].name);
      for (const std::string& axis : needed) {
        if (std::ranges::find(axes, axis) == axes.end()) axes.push_back(axis);
      }
    }
    if (lacking.empty()) return;
    std::string where;
    for (const Column& column : columns) where = where.empty() ? column.where : where;
    std::string text = (where.empty() ? path_ + ":1" : where) + ": columns " + listed(there, "'") + " stand without " +
                       listed(lacking, "'") + "; ";
    text += simulated_ ? "the vehicle simulates " + listed(axes, "") + ", where " + listed(lacking, "") +
                             " cannot be taken as zero: add what was measured, or leave " + listed(axes, "") +
                             " out of 'dof' in the vehicle file"
                       : "they go together";
    throw InputError(text);
  }

  [[nodiscard]] std::string note() const {
    if (zero_.empty()) return "";
    std::vector<std::string> axes;
    for (std::size_t i = 0; i < kMotionNames.size(); ++i) {
      if ((*simulated_)[i]) axes.emplace_back(kMotionNames[i]);
    }
    return "columns for " + listed(zero_, "") + " are missing and taken as zero: the vehicle simulates " +
           listed(axes, "") + " only";
  }

 private:
  [[nodiscard]] std::vector<std::string> needing(const Component& component) const {
    std::vector<std::string> axes;
    for (const int axis : component.axes) {
      const auto i = static_cast<std::size_t>(axis);
      if (!simulated_ || (*simulated_)[i]) axes.emplace_back(kMotionNames[i]);
    }
    return axes;
  }

  /// A list that does not say which components it leaves out: those that no simulated axis needs.
  void spread(std::vector<Column>& columns, const std::vector<Component>& components) const {
    std::vector<Column> full;
    std::vector<std::string> names;
    std::size_t next = 0;
    for (const Component& component : components) {
      const bool needed = !needing(component).empty();
      if (needed) names.push_back(component.name);
      full.push_back(needed && next < columns.size() ? columns[next++] : Column{"", columns.front().where, true});
    }
    if (names.size() != columns.size()) {
      const std::string count = std::to_string(columns.size());
      const std::string wanted = std::to_string(components.size());
      throw InputError(columns.front().where + ": 'columns' needs " + wanted + " columns, not " + count +
                       (simulated_
                            ? "; " + count + " of " + wanted + " would do where the vehicle simulates no more (" +
                                  listed(names, "") + " are needed), with 'none' in the place of the others"
                            : ""));
    }
    columns = std::move(full);
  }

  const std::string& path_;
  const std::optional<SimulatedAxes>& simulated_;
  std::vector<std::string> zero_;
};

std::vector<Component> one_each(const std::vector<std::string>& names, int first_axis) {
  std::vector<Component> components;
  components.reserve(names.size());
  for (const std::string& name : names) components.push_back({name, {first_axis++}});
  return components;
}

/// Components of a position in the order of the map's world. A vehicle that turns, or lies across, mixes x and y.
std::vector<Component> of_position(const Eigen::Matrix3d& to_house, bool turned) {
  const std::vector<Component> house{{"x", turned ? std::vector{0, 1} : std::vector{0}},
                                     {"y", turned ? std::vector{0, 1} : std::vector{1}},
                                     {"z", {2}}};
  std::vector<Component> components;
  for (int i = 0; i < 3; ++i) {
    Eigen::Index j{};
    to_house.col(i).cwiseAbs().maxCoeff(&j);
    components.push_back({std::string(1, "xyz"[i]), house[static_cast<std::size_t>(j)].axes});
  }
  return components;
}

}  // namespace

std::string complete_groups(ColumnMap& map, const std::string& path, const std::optional<SimulatedAxes>& simulated) {
  Completion completion{path, simulated};
  bool turned = !simulated || (*simulated)[kYaw];
  const auto attitude = [&](std::optional<AttitudeColumns>& columns) {
    if (!columns) return;
    if (columns->euler) completion.complete(columns->group.columns, one_each({"phi", "theta", "psi"}, 3));
    turned = turned || !columns->euler || !columns->group.columns[2].absent;
  };
  if (map.pose_capture) attitude(map.pose_capture->attitude);
  if (map.ahrs) attitude(map.ahrs->attitude);
  if (map.pose_capture && map.pose_capture->position) {
    ColumnGroup& position = *map.pose_capture->position;
    completion.complete(position.columns, of_position(position.to_house, turned));
  }
  if (map.dvl) completion.complete(map.dvl->velocity.columns, one_each({"u", "v", "w"}, 0));
  if (map.ahrs && map.ahrs->rates) completion.complete(map.ahrs->rates->columns, one_each({"p", "q", "r"}, 3));
  if (map.thrusters && map.thrusters->wrench_force) {
    std::vector<Column>& force = map.thrusters->wrench_force->columns;
    std::vector<Column>& moment = map.thrusters->wrench_moment->columns;
    std::vector<Column> all = force;
    all.insert(all.end(), moment.begin(), moment.end());
    completion.complete(all, one_each({"X", "Y", "Z", "K", "M", "N"}, 0));
    force.assign(all.begin(), all.begin() + 3);
    moment.assign(all.begin() + 3, all.end());
  }
  return completion.note();
}

}  // namespace fathom::tables
