// Messages of minds, commands and processes to samples, and back. Include the message's own header to use a pair.
#pragma once

#include <optional>

#include "common/samples/commands.hpp"
#include "common/samples/estimates.hpp"
#include "common/samples/health.hpp"
#include "common/samples/truth.hpp"

namespace fathom_lcm {
class wrench_command_t;
class operator_t;
class answer_t;
class excitation_t;
class state_t;
class smoothed_t;
class model_t;
class residual_t;
class effects_t;
class learned_t;
class truth_t;
class health_t;
class process_info_t;
}  // namespace fathom_lcm

namespace fathom::wire {

/// Nothing when a length is wrong, a number is not finite, or a quaternion is not unit.
[[nodiscard]] std::optional<WrenchCommand> decode(const fathom_lcm::wrench_command_t& message);
[[nodiscard]] std::optional<Operator> decode(const fathom_lcm::operator_t& message);
[[nodiscard]] std::optional<Answer> decode(const fathom_lcm::answer_t& message);
[[nodiscard]] std::optional<Excitation> decode(const fathom_lcm::excitation_t& message);
[[nodiscard]] std::optional<StateEstimate> decode(const fathom_lcm::state_t& message);
[[nodiscard]] std::optional<SmoothedState> decode(const fathom_lcm::smoothed_t& message);
[[nodiscard]] std::optional<ModelEstimate> decode(const fathom_lcm::model_t& message);
[[nodiscard]] std::optional<Residual> decode(const fathom_lcm::residual_t& message);
[[nodiscard]] std::optional<EffectRanking> decode(const fathom_lcm::effects_t& message);
[[nodiscard]] std::optional<LearnedTold> decode(const fathom_lcm::learned_t& message);
[[nodiscard]] std::optional<Truth> decode(const fathom_lcm::truth_t& message);
[[nodiscard]] std::optional<Health> decode(const fathom_lcm::health_t& message);
[[nodiscard]] std::optional<ProcessInfo> decode(const fathom_lcm::process_info_t& message);

[[nodiscard]] fathom_lcm::wrench_command_t encode(const WrenchCommand& sample);
[[nodiscard]] fathom_lcm::operator_t encode(const Operator& sample);
[[nodiscard]] fathom_lcm::answer_t encode(const Answer& sample);
[[nodiscard]] fathom_lcm::excitation_t encode(const Excitation& sample);
[[nodiscard]] fathom_lcm::state_t encode(const StateEstimate& sample);
[[nodiscard]] fathom_lcm::smoothed_t encode(const SmoothedState& sample);
[[nodiscard]] fathom_lcm::model_t encode(const ModelEstimate& sample);
[[nodiscard]] fathom_lcm::residual_t encode(const Residual& sample);
[[nodiscard]] fathom_lcm::effects_t encode(const EffectRanking& sample);
[[nodiscard]] fathom_lcm::learned_t encode(const LearnedTold& sample);
[[nodiscard]] fathom_lcm::truth_t encode(const Truth& sample);
[[nodiscard]] fathom_lcm::health_t encode(const Health& sample);
[[nodiscard]] fathom_lcm::process_info_t encode(const ProcessInfo& sample);

}  // namespace fathom::wire
