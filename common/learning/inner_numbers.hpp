// Numbers inside a law as closely as a fit tells them: frequencies of what swings, wave numbers of what travels, the
// point and the length of a line that pulls.
#pragma once

#include "common/likelihood/fit.hpp"

namespace fathom::learning {

/// The fit with the inner numbers of its force where they are most likely, weights and numbers
/// fitted again. Swings that the recordings are too short to tell apart are one, if that is as likely. As it was where
/// nothing swings or no step gains.
[[nodiscard]] likelihood::Fit with_inner_numbers(const likelihood::Problem& problem, likelihood::Fit fit, int threads);

}  // namespace fathom::learning
