// The chain of reasons behind a verdict, every step with its values and their thresholds; and two diagnoses compared.
#pragma once

#include <string>

#include "common/result/stored.hpp"

namespace fathom::result {

/// Plain text for a terminal, at most report::kTableColumns wide.
[[nodiscard]] std::string explained(const Stored& stored);

/// What changed from one to the other: verdict, effects, and the numbers that differ by more than both intervals allow.
[[nodiscard]] std::string difference(const Stored& first, const Stored& second);

}  // namespace fathom::result
