// What was found of an effect, in the words of whoever repairs it: the effect's own sentence with its numbers.
#pragma once

#include <string>

#include "common/samples/diagnosis_result.hpp"

namespace fathom::report {

/// "0.350 (0.340 to 0.360) s".
[[nodiscard]] std::string plain_value(const NamedValue& value);

/// "Thruster FL gives 29.0 (27.5 to 30.5) % less than the file says"; empty where the effect has no sentence
/// (model::Traits::finding), or lacks a number that it names. Of numbers of several places ("T6.gain_change"), one
/// after the other.
[[nodiscard]] std::string finding(const EffectFound& effect);

}  // namespace fathom::report
