// Keys that the streams of a map share: columns, their units and frames, flags. Within the room alone.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "common/base/config.hpp"
#include "common/tables/column_map.hpp"

namespace fathom::tables::map_keys {

inline constexpr const char* kNone = "none";  ///< in a list of columns: this component was not measured

/// Of the unit under `key` to `unit`; InputError at the key.
[[nodiscard]] double factor_to(const Config& config, const std::string& key, const std::string& unit);
void need_count(const Config& config, const std::string& key, const std::vector<Column>& columns, std::size_t count);
[[nodiscard]] std::vector<Column> columns_of(const Config& config, const std::string& key);
/// Components of a group, one column each, 'none' where there is none; fewer when the vehicle file tells which.
[[nodiscard]] std::vector<Column> components_of(const Config& config, const std::string& key, std::size_t count);

[[nodiscard]] Eigen::Matrix3d body_frame(const Config& config, const std::string& key);
/// NED, NWU, ENU; nothing for another word.
[[nodiscard]] std::optional<Eigen::Matrix3d> world_axes(const std::string& name);
[[nodiscard]] Eigen::Matrix3d world_frame(const Config& config, const std::string& key);

/// `columns` and `unit`, as many columns as there are.
[[nodiscard]] ColumnGroup group_of(const Config& config, const std::string& unit);
/// Three components at most, to be completed by the vehicle file.
[[nodiscard]] ColumnGroup vector_of(const Config& config, const std::string& unit);
/// `count` components, none of them left out.
[[nodiscard]] ColumnGroup whole_vector(const Config& config, const std::string& unit, std::size_t count = 3);
[[nodiscard]] ColumnGroup body_vector(const Config& config, const std::string& unit);
/// `column` and `unit`.
[[nodiscard]] ColumnGroup scalar(const Config& config, const std::string& unit);
/// A column, or one number for all rows.
[[nodiscard]] ColumnOrNumber column_or_number(const Config& config, const std::string& key, const std::string& unit);
/// Columns of a quaternion, sorted w x y z.
[[nodiscard]] std::vector<Column> quaternion_columns(const Config& section);
/// `invalid_where`, and `valid_where` as negated flags.
[[nodiscard]] std::vector<Column> invalid_of(const Config& config);

}  // namespace fathom::tables::map_keys
