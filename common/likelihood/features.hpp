// The free force of common/model as the likelihood calls it.
#pragma once

#include "common/model/learned/features.hpp"

namespace fathom::likelihood {

using model::Factor;
using model::Feature;
using model::FeatureGroup;
using model::FeatureState;
using model::FreeForce;
using model::kThrustMemories;
using model::kUseMemories;
using model::kVelocityMemories;
using model::kWorldAxis;
using model::Quantity;

}  // namespace fathom::likelihood
