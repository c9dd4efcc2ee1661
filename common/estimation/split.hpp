// Holds out the end of a run where no separate validation run exists.
#pragma once

#include <utility>

#include "common/samples/trial.hpp"

namespace fathom::estimation {

/// The first part and the last `held_out` share (0..1) of a run, named so. InputError when either would be empty.
[[nodiscard]] std::pair<Trial, Trial> split(const Trial& trial, double held_out);

}  // namespace fathom::estimation
