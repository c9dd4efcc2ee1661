// What a program's end says about it.
#pragma once

#include <cstdint>
#include <string>

namespace fathom::launch {

/// By a signal that stops programs (SIGINT, SIGTERM, SIGKILL), as after an order.
[[nodiscard]] bool stopped_by_signal(std::int32_t wait_status);
/// "exit 3", "killed", "Segmentation fault"; empty after exit 0.
[[nodiscard]] std::string describe_end(std::int32_t wait_status);

}  // namespace fathom::launch
