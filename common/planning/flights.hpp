// Every segment that a plan chooses from, flown by the model that views the data.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "common/planning/energies.hpp"
#include "common/planning/rehearsal.hpp"

namespace fathom::planning {

class Flights {
 public:
  /// `data` lends its model, its noise and its windows. `tell` hears the name of each segment before it is flown.
  Flights(
      const model::Vehicle& vehicle, const View& data, const RehearsalSettings& settings,
      const std::function<void(const std::string& segment)>& tell = [](const std::string&) {});

  [[nodiscard]] std::span<const Extra> extras() const { return extras_; }

 private:
  std::vector<std::unique_ptr<View>> views_;
  std::vector<Extra> extras_;
};

}  // namespace fathom::planning
