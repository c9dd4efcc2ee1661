// Fits from afar, for effects whose small sizes tell nothing about their large ones.
#pragma once

#include <span>

#include "common/diagnosis/questions.hpp"

namespace fathom::diagnosis {

/// Begins at every far start of every candidate that whole windows have been asked about, on few windows. What is found
/// waits for another full fit. `progress` hears of it at `share`.
void look_afar(Answers& answers, const identification::TrajectoryFit& problem, std::span<const Trial> train,
               const Settings& settings, const identification::FitResult& fit, const model::Scene& scene,
               const Progress& progress, double share);

}  // namespace fathom::diagnosis
