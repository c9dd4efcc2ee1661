#include "common/model/priors/bounded.hpp"

#include "common/model/priors/physical_bounds.hpp"

namespace fathom::model::bounded {
namespace {

void check(const Config& config, const std::string& key, const std::string& unit, double value) {
  if (const std::string why = beyond_physics(key, unit, value); !why.empty()) config.fail(key, why);
}

double checked(const Config& config, const std::string& key, const std::string& unit, double value) {
  check(config, key, unit, value);
  return value;
}

}  // namespace

std::vector<double> quantities(const Config& config, const std::string& key, const std::string& unit) {
  std::vector<double> values = config.quantities(key, unit);
  for (const double each : values) check(config, key, unit, each);
  return values;
}

double quantity(const Config& config, const std::string& key, const std::string& unit) {
  return checked(config, key, unit, config.quantity(key, unit));
}
double positive(const Config& config, const std::string& key, const std::string& unit) {
  return checked(config, key, unit, config.positive(key, unit));
}
double not_negative(const Config& config, const std::string& key, const std::string& unit) {
  return checked(config, key, unit, config.not_negative(key, unit));
}

Eigen::Vector3d vector3(const Config& config, const std::string& key, const std::string& unit) {
  const Eigen::Vector3d values = config.vector3(key, unit);
  for (const double each : values) check(config, key, unit, each);
  return values;
}

}  // namespace fathom::model::bounded
