// What an excitation would tell, before it is flown: for every effect how much of it hides in the base parameters,
// which of them it would falsify, the smallest size that would be found, and the segment that would find it soonest.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/base/progress.hpp"
#include "common/inference/infer.hpp"
#include "common/planning/energies.hpp"
#include "common/samples/estimates.hpp"

namespace fathom::planning {

struct LookAlike {
  std::string name;
  std::optional<Answer> told_apart;
};

struct Foreseen {
  std::string name, form;
  int forms{}, forms_found{};     ///< that could act here; that would be found within their physical limits
  bool found{};                   ///< at some size within the physical limits
  std::vector<NamedValue> size;   ///< the smallest that would be found
  double hidden{};                ///< share of its mean square that base parameters imitate
  std::string corrupted;          ///< the base parameter that it would falsify most, relative to its value
  double corruption{};            ///< of the value, at that size
  std::optional<Answer> soonest;  ///< base parameters known from the excitation
  std::vector<LookAlike> like;    ///< effects that explain the same as well, whose odds would stay open
};

/// An effect is found where a diagnosis by `settings` would name it: it has the odds of a name, all tries paid for, and
/// the smallest practical size. Nothing is known beforehand of the water's own random force, and none is assumed.
[[nodiscard]] std::vector<Foreseen> foresee(const model::Vehicle& vehicle, const View& excitation,
                                            std::span<const Extra> extras, const inference::Settings& settings,
                                            const Progress& progress);

}  // namespace fathom::planning
