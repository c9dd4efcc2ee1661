// The greedy search for effects: screen all, refit the best, accept or stop, then test each accepted one again in the
// company of the others.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/diagnosis/diagnoser.hpp"
#include "common/diagnosis/screening.hpp"

namespace fathom::diagnosis {

/// A candidate with the numbers that decided about it.
struct Judged {
  const model::Effect* effect{};
  int variant{};
  std::string variant_name;
  double log_odds{};
  double error_reduction{};
  double held_out_blocks{};
  double held_out_runs{};
  double beside_memory{};  ///< log odds beside a random force that its own past foretells; 0 until asked
  double change{1.0};      ///< of the predicted velocity, share of the measured one; 1 until a fit has told
  bool in_the_way{false};  ///< numbers that have the vehicle where it cannot be
  bool lasting{false};     ///< an onset at the edge of the data
  bool too_quick{false};   ///< a time after the command that how commands are held makes too
  std::vector<std::string> aliased_with{};  ///< other effects whose predictions look alike
  std::vector<Alternative> alternatives{};  ///< of those, the ones that the odds cannot rule out
  std::string corrupts{};                   ///< the base parameter that it moves most where it is left out
  double corruption{};                      ///< by so much of its value
  std::vector<std::string> other_forms{};   ///< of the same effect, that would explain as much
  std::string reason{};                     ///< why it was refused; empty when accepted
};

/// What a force of no particular form would still explain.
struct FreeForm {
  std::string axis;                ///< "X" .. "N"
  std::string with;                ///< the quantity that it runs over
  double share{};                  ///< of the error (RMS) that it would remove
  bool in_place_of_effect{false};  ///< an accepted effect imitated it
};

struct SearchResult {
  identification::FitResult before;
  identification::FitResult after;
  std::vector<Judged> accepted;  ///< in the order of acceptance
  std::vector<Judged> refused;   ///< best form of every other effect, from the last round
  std::optional<FreeForm> free_form{};
  double window{};                  ///< s, of the final fits
  double explained{1.0};            ///< by the accepted effects, of the lasting error on runs that no fit has seen
  double explained_of_structure{};  ///< the same without what is left as a random force (random_rest.hpp)
  /// Best log odds, on the training runs, of what was accepted there and did not help the validation run.
  std::optional<double> taken_back{};
};

[[nodiscard]] SearchResult search(const model::Vehicle& vehicle, std::span<const Trial> train, const Settings& settings,
                                  const Progress& progress);

}  // namespace fathom::diagnosis
