#include "common/tables/map_keys.hpp"

#include <algorithm>

#include "common/base/error.hpp"
#include "common/base/units.hpp"

namespace fathom::tables::map_keys {

double factor_to(const Config& config, const std::string& key, const std::string& unit) {
  try {
    return unit_factor(config.text(key), unit);
  } catch (const InputError& error) {
    const std::string message = error.what();
    if (message.rfind("unit '", 0) != 0 && message.rfind("the unit", 0) != 0) throw;
    config.fail(key, message);
  }
}

void need_count(const Config& config, const std::string& key, const std::vector<Column>& columns, std::size_t count) {
  if (columns.size() == count) return;
  config.fail(key, "'" + key + "' needs " + std::to_string(count) + " columns, not " + std::to_string(columns.size()));
}

std::vector<Column> columns_of(const Config& config, const std::string& key) {
  std::vector<Column> columns;
  for (const std::string& name : config.texts(key)) columns.push_back({name, config.where(key)});
  if (columns.empty()) config.fail(key, "'" + key + "' names no column");
  return columns;
}

std::vector<Column> components_of(const Config& config, const std::string& key, std::size_t count) {
  std::vector<Column> columns = columns_of(config, key);
  if (columns.size() > count) need_count(config, key, columns, count);
  for (Column& column : columns) {
    if (column.name == kNone) column = {"", column.where, true};
  }
  if (std::ranges::all_of(columns, &Column::absent)) config.fail(key, "'" + key + "' names no column");
  if (columns.size() < count && std::ranges::any_of(columns, &Column::absent)) need_count(config, key, columns, count);
  return columns;
}

Eigen::Matrix3d body_frame(const Config& config, const std::string& key) {
  const std::string name = config.text(key);
  if (name == "FRD") return Eigen::Matrix3d::Identity();
  if (name == "FLU") return Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
  config.fail(key, "'" + name + "' is no body frame: FRD (forward, right, down) or FLU (forward, left, up)");
}

std::optional<Eigen::Matrix3d> world_axes(const std::string& name) {
  if (name == "NED") return Eigen::Matrix3d::Identity();
  if (name == "NWU") return Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
  if (name == "ENU") return (Eigen::Matrix3d() << 0, 1, 0, 1, 0, 0, 0, 0, -1).finished();
  return std::nullopt;
}

Eigen::Matrix3d world_frame(const Config& config, const std::string& key) {
  const std::string name = config.text(key);
  if (const auto axes = world_axes(name)) return *axes;
  config.fail(key, "'" + name + "' is no world frame: NED, NWU (z up, y to the left of x) or ENU");
}

ColumnGroup group_of(const Config& config, const std::string& unit) {
  ColumnGroup group;
  group.columns = columns_of(config, "columns");
  group.factor = factor_to(config, "unit", unit);
  return group;
}

ColumnGroup vector_of(const Config& config, const std::string& unit) {
  return {components_of(config, "columns", 3), factor_to(config, "unit", unit)};
}

ColumnGroup whole_vector(const Config& config, const std::string& unit, std::size_t count) {
  ColumnGroup group = group_of(config, unit);
  need_count(config, "columns", group.columns, count);
  for (const Column& column : group.columns) {
    if (column.name == kNone) config.fail("columns", "'columns' cannot be 'none' here: each component is needed");
  }
  return group;
}

ColumnGroup body_vector(const Config& config, const std::string& unit) {
  ColumnGroup group = vector_of(config, unit);
  group.to_house = body_frame(config, "frame");
  return group;
}

ColumnGroup scalar(const Config& config, const std::string& unit) {
  ColumnGroup group;
  group.columns = {{config.text("column"), config.where("column")}};
  group.factor = factor_to(config, "unit", unit);
  return group;
}

std::vector<Column> invalid_of(const Config& config) {
  std::vector<Column> flags = config.has("invalid_where") ? columns_of(config, "invalid_where") : std::vector<Column>{};
  if (!config.has("valid_where")) return flags;
  for (Column& column : columns_of(config, "valid_where")) {
    column.negated = true;
    flags.push_back(std::move(column));
  }
  return flags;
}

ColumnOrNumber column_or_number(const Config& config, const std::string& key, const std::string& unit) {
  ColumnOrNumber value;
  if (!config.is_section(key)) {
    value.number = unit.empty() ? config.not_negative(key, unit) : config.positive(key, unit);
    return value;
  }
  const Config section = config.section(key);
  value.group = unit.empty() ? ColumnGroup{{{section.text("column"), section.where("column")}}} : scalar(section, unit);
  return value;
}

std::vector<Column> quaternion_columns(const Config& section) {
  std::vector<Column> columns = columns_of(section, "columns");
  need_count(section, "columns", columns, 4);
  const std::string order = section.text("order");
  if (order != "wxyz" && order != "xyzw") section.fail("order", "'order' must be wxyz or xyzw, not '" + order + "'");
  if (order == "xyzw") std::rotate(columns.begin(), columns.begin() + 3, columns.end());
  return columns;
}

}  // namespace fathom::tables::map_keys
