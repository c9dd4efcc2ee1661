// The column map that says what the sensor check found out: conventions, a heading, a unit.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/estimation/corrections.hpp"
#include "common/tables/column_map.hpp"

namespace fathom::tool {

/// Puts what the corrections say into the map; returns what a map cannot say. InputError where recordings need maps of
/// their own.
[[nodiscard]] std::vector<std::string> mend(tables::ColumnMap& map,
                                            std::span<const estimation::Corrections> corrections);
/// Reads the map (or makes one of the canonical columns of the first table), mends it and writes it to `path`; notes of
/// what it cannot say.
[[nodiscard]] std::vector<std::string> write_mended_map(const std::string& path, const std::string& map,
                                                        const std::vector<std::string>& runs,
                                                        std::span<const estimation::Corrections> corrections);

}  // namespace fathom::tool
