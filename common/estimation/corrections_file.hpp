// Corrections as configuration: what `fathom check --write FILE` writes and what live processes load.
#pragma once

#include <span>
#include <string>

#include "common/estimation/corrections.hpp"

namespace fathom {
class Config;
}

namespace fathom::estimation {

/// YAML text with one section "corrections"; SI units.
[[nodiscard]] std::string to_yaml(const Corrections& corrections);
/// Reads the section "corrections" (its content, not the file). A part that is left out corrects nothing.
[[nodiscard]] Corrections corrections_from(const Config& section);
/// Reads a file written by to_yaml.
[[nodiscard]] Corrections load_corrections(const std::string& path);
/// The corrections that most recordings share, and how many do: what a live process should use.
struct Shared {
  Corrections corrections;
  std::size_t count{};
};
[[nodiscard]] Shared most_shared(std::span<const Corrections> corrections);

}  // namespace fathom::estimation
