// procman's messages to samples, and back. Include the message's own header to use a pair.
#pragma once

#include <optional>

#include "common/samples/launch.hpp"

namespace procman_lcm {
class orders_t;
class deputy_info_t;
class discovery_t;
class output_t;
}  // namespace procman_lcm

namespace fathom::wire {

inline constexpr char kLaunchOrders[] = "PM_ORDERS";
inline constexpr char kLaunchInfo[] = "PM_INFO";
inline constexpr char kLaunchDiscover[] = "PM_DISCOVER";
inline constexpr char kLaunchOutput[] = "PM_OUTPUT";

/// Nothing when a length is wrong or a number is not finite.
[[nodiscard]] std::optional<LaunchOrders> decode(const procman_lcm::orders_t& message);
[[nodiscard]] std::optional<DeputyInfo> decode(const procman_lcm::deputy_info_t& message);
[[nodiscard]] std::optional<LaunchDiscovery> decode(const procman_lcm::discovery_t& message);
[[nodiscard]] std::optional<LaunchOutput> decode(const procman_lcm::output_t& message);

[[nodiscard]] procman_lcm::orders_t encode(const LaunchOrders& sample);
[[nodiscard]] procman_lcm::deputy_info_t encode(const DeputyInfo& sample);
[[nodiscard]] procman_lcm::discovery_t encode(const LaunchDiscovery& sample);
/// At most 32767 texts.
[[nodiscard]] procman_lcm::output_t encode(const LaunchOutput& sample);

}  // namespace fathom::wire
