// The draft of a map: what the usual topics of a recording are, as a map that runs as it is.
#pragma once

#include <string>
#include <vector>

#include "common/recordings/import.hpp"

namespace fathom::recordings {

/// YAML, with what a person must check in comments; empty when no usual topic is there. `content` was read with
/// Collector::Take::kEverything.
[[nodiscard]] std::string draft_map(const Content& content);

/// What it holds, every line a comment of YAML: topics with type, rate, gaps and fields.
[[nodiscard]] std::string description(const Content& content);

}  // namespace fathom::recordings
