#include "common/planning/flights.hpp"

#include "common/excitation/segments.hpp"

namespace fathom::planning {

Flights::Flights(const model::Vehicle& vehicle, const View& data, const RehearsalSettings& settings,
                 const Progress& progress) {
  constexpr const char* kFlights = "flights";
  const bool by_wrench = data.trials().front().input_is_wrench;
  const auto segments = excitation::segments(vehicle, settings.supervisor.largest);
  progress.expect(kFlights, static_cast<double>(segments.size()));
  for (const excitation::Segment& segment : segments) {
    progress.begin(kFlights, "flying " + segment.name);
    std::vector<Trial> flown{fly(vehicle, data.model(), by_wrench, settings, segment, segment.duration)};
    views_.push_back(std::make_unique<View>(vehicle, std::move(flown), data.model(), data.sigma(), data.window()));
    extras_.push_back({segment.name, segment.duration, views_.back().get()});
    progress.done(kFlights);
  }
}

}  // namespace fathom::planning
