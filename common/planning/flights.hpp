// Every segment that a plan chooses from, flown by the model that views the data.
#pragma once

#include <memory>
#include <vector>

#include "common/base/progress.hpp"
#include "common/planning/energies.hpp"
#include "common/planning/rehearsal.hpp"

namespace fathom::planning {

class Flights {
 public:
  /// `data` lends its model, its noise and its windows.
  Flights(const model::Vehicle& vehicle, const View& data, const RehearsalSettings& settings,
          const Progress& progress = {});

  [[nodiscard]] std::span<const Extra> extras() const { return extras_; }

 private:
  std::vector<std::unique_ptr<View>> views_;
  std::vector<Extra> extras_;
};

}  // namespace fathom::planning
