// The causes that a result may state: what their value measures, and the sentence for people. docs/schema lists the
// same.
#pragma once

#include <span>
#include <string_view>

namespace fathom::result {

struct CauseWords {
  std::string_view cause;     ///< as result.json has it
  std::string_view quantity;  ///< of value and threshold
  std::string_view sentence;  ///< without a full stop
  bool at_least{true};        ///< the threshold is a floor that value must reach to speak for it; else a ceiling
};

/// All of them, of both cores.
[[nodiscard]] std::span<const CauseWords> cause_words();
/// Null for a cause that this version does not know.
[[nodiscard]] const CauseWords* words_of(std::string_view cause);

}  // namespace fathom::result
