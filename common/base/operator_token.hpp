// The word with which an operator's orders are believed. The vehicle's processes and the operator's tool read the same
// small file.
#pragma once

#include <string>

namespace fathom {

/// `operator: {token: WORD}` of the file at `path`; InputError when it is missing or shorter than eight letters.
[[nodiscard]] std::string operator_token(const std::string& path);

}  // namespace fathom
