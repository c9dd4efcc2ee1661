// The numbers of a sample by name, for tables that show them beside the instrument's own.
#pragma once

#include "common/devices/protocols.hpp"

namespace fathom::devices {

/// Adds the same columns for every sample of a kind; all empty when the frame says nothing.
void describe_sample(const Sample& sample, Kind kind, const Settings& settings, Fields& fields);

/// A velocity or a fix that the instrument itself does not trust.
[[nodiscard]] bool marked_invalid(const Sample& sample);

}  // namespace fathom::devices
