// What learning is worth: errors on a recording that no fit has seen, with the true effect taken out of the list, with
// mechanisms that no list holds, and with nothing hidden.
#pragma once

#include <span>
#include <string>

#include "test/sealed/judging/judge.hpp"

namespace fathom::sealed {

/// How answers are kept apart: with the whole list, and without what is in the set.
constexpr const char* kTold = "told";
constexpr const char* kLeftOut = "left-out";

/// Markdown: medians with quartiles and Wilson's intervals, then every set.
[[nodiscard]] std::string to_learning_page(std::span<const Score> told, std::span<const Score> left_out,
                                           const std::string& how);

}  // namespace fathom::sealed
