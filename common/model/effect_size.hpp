// How large an effect's numbers ordinarily are on a vehicle of another size. Effects state them for a craft of 30 kg,
// as most that are tested in tanks; a larger one of like shape, at speeds like its own, has them by Froude's
// similarity: lengths grow with the cube root of the mass, times with the root of lengths, forces with the mass (Fossen
// 2011, sec. 7.2.5, bis system).
#pragma once

#include <string_view>
#include <vector>

#include "common/model/effect.hpp"

namespace fathom::model {

/// Power of the mass with which a quantity of that unit grows: "N" 1, "m" 1/3, "s" 1/6, "N/(m/s)^2" 2/3.
[[nodiscard]] double growth_of(std::string_view unit);

/// What a quantity of that unit is to be multiplied with on this vehicle; 1 for small craft and unknown masses.
[[nodiscard]] double size_factor(const Vehicle& vehicle, std::string_view unit);

/// A number of the effect, its sigma and its limits as they are on this vehicle. Moments within a run, and what sensors
/// do, know no size.
[[nodiscard]] EffectParameter parameter_of(const Effect& effect, int variant, std::size_t number,
                                           const Vehicle& vehicle);

[[nodiscard]] std::vector<EffectParameter> parameters_of(const Effect& effect, int variant, const Vehicle& vehicle);

/// Whether one of the numbers `theta` that take part in this form lies on a limit, or beyond it: a search that ended
/// there was stopped and has found nothing. A limit of zero is no such end, unless every amplitude is zero: then there
/// is no effect; nor is one below which it is blurred.
[[nodiscard]] bool stopped_at_limit(const Effect& effect, int variant, EffectTheta theta, const Vehicle& vehicle);

}  // namespace fathom::model
