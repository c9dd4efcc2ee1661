// A simulated dive in virtual time: seeded excitation of a vehicle of config/vehicles, hidden effects if wished, and a
// trial as the estimator would hand it over, noise included.
#pragma once

#include <string>
#include <vector>

#include "common/model/dynamics.hpp"
#include "common/samples/trial.hpp"

namespace fathom::test {

struct DiveSettings {
  double duration{120.0};  ///< s
  double dt{0.1};          ///< s between samples
  double step{0.01};       ///< s of the integration: a tenth of what the code under test uses, mostly
  unsigned seed{1};
  double velocity_noise{0.005};  ///< m/s, std
  double rate_noise{0.005};      ///< rad/s
  double noise_memory{0.0};      ///< s, time constant; the standard deviations stay
  double turn{0.0};              ///< s that each free axis is driven alone, one after the other; 0: all together
  double spread{0.1};            ///< of the true base parameters around the vehicle file's means
  bool wrench{false};            ///< inputs are the wrench, not single thrusters
  /// 0: inputs run straight from sample to sample; 1/2: each is held until the next; -1/2: it held since the last.
  double input_hold{0.0};
  std::vector<model::ActiveEffect> effects{};
};

struct VirtualDive {
  Trial trial;
  model::Model truth;
};

/// The vehicle must outlive the dive.
[[nodiscard]] VirtualDive make_dive(const model::Vehicle& vehicle, const DiveSettings& settings);
/// config/vehicles/NAME.yaml
[[nodiscard]] model::Vehicle vehicle_from_repository(const std::string& name);
/// The vehicle whose file does not free the base parameters that begin so.
[[nodiscard]] model::Vehicle without_parameters(model::Vehicle vehicle, const std::string& beginning);
/// An effect with numbers, by name.
[[nodiscard]] model::ActiveEffect active(const std::string& name, std::vector<double> theta, int variant = 0);

}  // namespace fathom::test
