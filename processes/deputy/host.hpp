// What /proc tells of this host and of its processes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/samples/launch.hpp"

namespace fathom::deputy {

/// Since the host's start, of all cores.
struct Jiffies {
  std::int64_t busy{}, all{};  ///< without waiting for disks
};
[[nodiscard]] Jiffies jiffies();

/// Fills in memory and swap.
void read_memory(DeputyInfo& info);

struct ProcessFigures {
  std::int64_t jiffies{};                            ///< used since its start
  std::int64_t virtual_memory{}, resident_memory{};  ///< [B]
};
[[nodiscard]] std::optional<ProcessFigures> figures_of(std::int32_t pid);

/// The process, all its descendants, and whoever else is in its session, which is what remains of a program whose
/// parent has died.
[[nodiscard]] std::vector<std::int32_t> family_of(std::int32_t pid);

}  // namespace fathom::deputy
