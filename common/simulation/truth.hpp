// What the section `simulator` says of the truth: times, limits, parameters, battery, start, who is carried where.
#pragma once

#include "common/model/dynamics.hpp"
#include "common/model/site.hpp"
#include "common/simulation/body.hpp"

namespace fathom {
class Config;
}

namespace fathom::simulation {

/// A time in multiples of 0.1 ms [us].
[[nodiscard]] Utime microseconds(const Config& config, const std::string& key);
/// Control interval, a multiple of the step [us].
[[nodiscard]] Utime interval_of(const Config& config);
/// Largest force of one thruster [N].
[[nodiscard]] double limit_of(const Config& config, const model::Vehicle& vehicle);
/// Base parameters of the truth: those stated, else the vehicle file's means. `whole` has all six degrees of freedom.
[[nodiscard]] model::Model truth_of(const Config& config, const model::Vehicle& vehicle, const model::Vehicle& whole);
/// What the section `derivatives` says, where it stands in the place of `truth`.
[[nodiscard]] std::optional<DerivativeTruth> derivatives_of(const Config& config, const model::Vehicle& vehicle,
                                                            const model::Site& site, std::uint64_t seed);
/// The base parameters nearest to the vehicle's derivatives.
[[nodiscard]] model::Model derivative_model(const model::Vehicle& vehicle, const model::Vehicle& whole);
[[nodiscard]] BatteryTruth battery_of(const Config& config);
[[nodiscard]] StartPose start_of(const Config& config, const model::Site& site, const Eigen::Vector3d& hull);
[[nodiscard]] bool carried_at(const Config& sensor, const model::Site& site);

}  // namespace fathom::simulation
