// A diagnosed model read back from result.json, to be flown or to predict with.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/model/learned/learned_force.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model {

struct LearnedModel {
  std::vector<std::pair<std::string, double>> parameters;  ///< base numbers by name, SI
  std::vector<std::string> effects;                        ///< as `--hide` of the simulator reads them
  std::shared_ptr<const LearnedForce> force;  ///< what lasts of it; empty where none is carried to other runs
};

/// InputError "file:line: what" where the file is no result of `fathom diagnose` or of another vehicle.
[[nodiscard]] LearnedModel read_learned(const std::string& path, const Vehicle& vehicle);

}  // namespace fathom::model
