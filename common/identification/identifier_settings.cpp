// The identifier's section of a pipeline file.
#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/identification/identifier.hpp"

namespace fathom::identification {

IdentifierSettings IdentifierSettings::from(const Config& config) {
  IdentifierSettings s;
  s.window = config.quantity("window", "s");
  s.stride = config.quantity("stride", "s");
  s.max_gap = config.quantity("max_gap", "s");
  s.memory = config.quantity("memory", "s");
  s.noise_force = config.quantity("noise_force", "N");
  s.noise_moment = config.quantity("noise_moment", "N m");
  const std::string input = config.text("input");
  if (input != "linear" && input != "hold") {
    throw InputError(config.where("input") + ": input is '" + input + "'; write linear or hold");
  }
  s.interpolate_input = input == "linear";
  s.max_input_gap = config.quantity("max_input_gap", "s");
  s.max_skew = config.quantity("max_skew", "s");
  s.buoyant = config.flag("buoyant");
  if (s.memory < 0.0) throw InputError(config.where("memory") + ": memory must not be negative; 0 s keeps everything");
  if (!(s.max_input_gap > 0.0)) throw InputError(config.where("max_input_gap") + ": max_input_gap must be positive");
  if (s.max_skew < 0.0) throw InputError(config.where("max_skew") + ": max_skew must not be negative");
  return s;
}

}  // namespace fathom::identification
