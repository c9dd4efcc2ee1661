// The identifier's section of a pipeline file.
#include "common/base/config.hpp"
#include "common/identification/identifier.hpp"

namespace fathom::identification {

IdentifierSettings IdentifierSettings::from(const Config& config) {
  IdentifierSettings s;
  s.window = config.quantity("window", "s");
  s.stride = config.quantity("stride", "s");
  s.max_gap = config.quantity("max_gap", "s");
  s.memory = config.not_negative("memory", "s");  // 0 keeps everything
  s.noise_force = config.quantity("noise_force", "N");
  s.noise_moment = config.quantity("noise_moment", "N m");
  s.interpolate_input = config.either("input", "linear", "hold");
  s.max_input_gap = config.positive("max_input_gap", "s");
  s.max_skew = config.not_negative("max_skew", "s");
  s.buoyant = config.flag("buoyant");
  if (config.has("prior")) {
    s.from_zero = config.either("prior", "zero", "vehicle");
    if (s.from_zero) s.zero_sigma = config.positive("prior_sigma", "");
  }
  if (config.has("residual_memory")) s.residual_memory = config.positive("residual_memory", "s");
  if (config.has("velocity_scale")) s.velocity_scale = config.not_negative("velocity_scale", "");
  if (config.has("velocity_offset")) s.velocity_offset = config.not_negative("velocity_offset", "m/s");
  if (config.has("attitude_offset")) s.attitude_offset = config.not_negative("attitude_offset", "rad");
  if (config.has("rate_offset")) s.rate_offset = config.not_negative("rate_offset", "rad/s");
  if (config.has("noise_acceleration")) s.noise_acceleration = config.not_negative("noise_acceleration", "m/s^2");
  if (config.has("noise_velocity")) s.noise_velocity = config.not_negative("noise_velocity", "m/s");
  if (config.has("freeze_delay")) s.freeze_delay = config.not_negative("freeze_delay", "s");
  if (config.has("adopt_after")) {
    s.adopt_after = config.integer("adopt_after");
    if (s.adopt_after < 1)
      config.fail("adopt_after", "'adopt_after' must be 1 at least; without the key none is adopted");
    if (config.has("adopt_delay")) s.adopt_delay = config.not_negative("adopt_delay", "s");
    if (config.has("keep")) s.keep = config.positive("keep", "s");
  }
  if (config.has("estimate")) s.joint = config.either("estimate", "joint", "recursive");
  return s;
}

}  // namespace fathom::identification
