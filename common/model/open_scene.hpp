// A scene without data: for a model that comes from somewhere else.
#pragma once

#include "common/model/effect.hpp"

namespace fathom::model {

/// Admits every form of an effect, whose place in the list of variants is then its number.
[[nodiscard]] Scene open_scene(const Vehicle& vehicle, bool wrench);

}  // namespace fathom::model
