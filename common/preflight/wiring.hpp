// Whether the thrusters are other ones, or push the other way, than the vehicle's file says: the commonest fault of a
// new file, and no effect of the catalogue. Asked where a model follows its thrust badly.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/identification/trajectories/trajectory_fit.hpp"
#include "common/samples/diagnosis_result.hpp"

namespace fathom::preflight {

/// Which actuator of the vehicle's file each recorded input acts through, and with which sign.
struct Wiring {
  std::vector<std::size_t> actuator;
  std::vector<int> sign;  ///< 1 or -1
};

/// The arrangement under which acceleration follows thrust best, by a regression of measured accelerations on each
/// axis' thrust beside the terms of the base model; nothing where it is the file's own, or no certain one. More than
/// one where the data cannot tell them apart.
[[nodiscard]] std::vector<Wiring> likely_wirings(const model::Vehicle& vehicle, std::span<const Trial> trials);

/// The trials as they would be recorded if the file were right.
[[nodiscard]] std::vector<Trial> rewired(std::span<const Trial> trials, const Wiring& wiring);

/// "T1 and T2 exchanged", "T3 reversed"; with "Y reversed" where the inputs are the wrench.
[[nodiscard]] std::string words_for(const Wiring& wiring, const model::Vehicle& vehicle, bool wrench);

/// What the file seems to have wrong: believed when the base model, fitted anew, loses half of its error by it.
[[nodiscard]] std::optional<WiringFault> wiring_fault(const model::Vehicle& vehicle, std::span<const Trial> trials,
                                                      const identification::FitSettings& settings);

}  // namespace fathom::preflight
