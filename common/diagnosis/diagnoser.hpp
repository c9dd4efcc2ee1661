// Closes the loop: fits the base model, asks every registered effect "could you be this?", adds what the evidence
// supports, fits again, and reports the error before and after on runs that no fit has seen.
#pragma once

#include <functional>
#include <span>
#include <string>

#include "common/identification/trajectory_fit.hpp"
#include "common/samples/diagnosis_result.hpp"

namespace fathom::diagnosis {

struct Settings {
  identification::FitSettings fit;
  double accept_log_odds{5.0};       ///< 150 to 1, all tries paid for: noise with a memory may cross 20 to 1
  double subtle{0.05};               ///< of the error (RMS): less may be noise with a memory, answered by a pilot
  double subtle_log_odds{8.0};       ///< 3000 to 1, needed of what saves less than `subtle`
  double doubtful_log_odds{2.0};     ///< from here on what saves `convincing` on blocks left out is accepted too
  double convincing{0.1};            ///< of the error (RMS): chance saves nothing on data that had no part in the fit
  double smallest_reduction{0.005};  ///< of the training error (RMS): less changes no prediction worth the name
  double smallest_change{0.005};     ///< of the predicted velocity, share of the measured one: nobody would notice less
  double alias_correlation{0.9};     ///< of two effects' predictions, what the base parameters can imitate taken out
  double held_out{0.0};              ///< share of every run that is kept to judge by; 0: runs of their own do that
  int most_effects{8};
  int threads{2};
};

/// Called with what is being done and the share of the work that is done, 0..1.
using Progress = std::function<void(const std::string&, double)>;

/// Diagnosis of `train`, judged on `validate`. Consistency findings are the caller's to add. `fitted`: takes the fit
/// with the accepted effects.
[[nodiscard]] DiagnosisReport diagnose(const model::Vehicle& vehicle, std::span<const Trial> train,
                                       std::span<const Trial> validate, const Settings& settings,
                                       const Progress& progress, identification::FitResult* fitted = nullptr);

}  // namespace fathom::diagnosis
