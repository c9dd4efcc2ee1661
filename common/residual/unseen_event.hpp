// Something that begins in the runs that judge, and that no fit can have seen: a weight that is lost, a thruster that
// fails. It speaks against no effect that was found before.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/model/dynamics.hpp"
#include "common/samples/diagnosis_result.hpp"
#include "common/samples/trial.hpp"

namespace fathom::residual {

/// `fitted`, `unseen`: wrench residuals (force_residual.hpp) of one model. None unless what is left along some axis of
/// the unseen runs is far more than the fitted ones have left, which is noise there.
[[nodiscard]] std::optional<UnseenEvent> unseen_event(std::span<const Trial> fitted_runs,
                                                      std::span<const std::vector<Vector6d>> fitted,
                                                      std::span<const Trial> unseen_runs,
                                                      std::span<const std::vector<Vector6d>> unseen);
[[nodiscard]] std::optional<UnseenEvent> unseen_event(const model::Model& model, std::span<const Trial> fitted,
                                                      std::span<const Trial> unseen);

}  // namespace fathom::residual
