#include "common/planning/flights.hpp"

#include "common/excitation/segments.hpp"

namespace fathom::planning {

Flights::Flights(const model::Vehicle& vehicle, const View& data, const RehearsalSettings& settings,
                 const std::function<void(const std::string& segment)>& tell) {
  const bool by_wrench = data.trials().front().input_is_wrench;
  for (const excitation::Segment& segment : excitation::segments(vehicle, settings.supervisor.largest)) {
    tell(segment.name);
    std::vector<Trial> flown{fly(vehicle, data.model(), by_wrench, settings, segment, segment.duration)};
    views_.push_back(std::make_unique<View>(vehicle, std::move(flown), data.model(), data.sigma(), data.window()));
    extras_.push_back({segment.name, segment.duration, views_.back().get()});
  }
}

}  // namespace fathom::planning
