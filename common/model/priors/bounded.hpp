// How a vehicle file's numbers are read: as Config does, and refused where no vehicle has such a one
// (physical_bounds.hpp).
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/base/config.hpp"

namespace fathom::model::bounded {

[[nodiscard]] std::vector<double> quantities(const Config& config, const std::string& key, const std::string& unit);
[[nodiscard]] double quantity(const Config& config, const std::string& key, const std::string& unit);
/// Greater than zero.
[[nodiscard]] double positive(const Config& config, const std::string& key, const std::string& unit);
/// Zero or greater.
[[nodiscard]] double not_negative(const Config& config, const std::string& key, const std::string& unit);
[[nodiscard]] Eigen::Vector3d vector3(const Config& config, const std::string& key, const std::string& unit);

}  // namespace fathom::model::bounded
