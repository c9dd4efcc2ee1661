// All decoders under one name, as something that can be handed over: process.on<fathom_lcm::state_t>(channel,
// wire::kDecode, handler).
#pragma once

#include "common/wire/minds.hpp"
#include "common/wire/sensors.hpp"

namespace fathom::wire {

inline constexpr auto kDecode = [](const auto& message) { return decode(message); };

}  // namespace fathom::wire
