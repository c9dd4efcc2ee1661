#include "common/planning/live_separation.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "common/planning/flights.hpp"

namespace fathom::planning {
namespace {

constexpr double kWindow = 10.0;  // s, as in a diagnosis
constexpr double kDoubt = 5.0;    // times the identifier's std: it knows of neither candidate, and one of them is there
constexpr double kNothing = 1e9;  // times the noise: of a stretch that says nothing

/// The vehicle with what was learnt of it in the place of what its file says.
model::Vehicle learnt(model::Vehicle vehicle, const ModelEstimate& known) {
  for (std::size_t i = 0; i < vehicle.parameters.size(); ++i) {
    const auto value = std::ranges::find(known.parameters, vehicle.parameters[i], &NamedValue::name);
    if (value == known.parameters.end() || !(value->std > 0.0)) continue;
    vehicle.priors[i] = {.mean = value->value, .sigma = std::min(vehicle.priors[i].sigma, kDoubt * value->std)};
  }
  return vehicle;
}

}  // namespace

LiveSeparation::LiveSeparation(const model::Vehicle& vehicle, const RehearsalSettings& settings)
    : vehicle_{vehicle}, settings_{settings} {}

std::optional<Answer> LiveSeparation::between(const model::ActiveEffect& first, const model::ActiveEffect& second,
                                              const ModelEstimate& known) const {
  const model::Vehicle vehicle = learnt(vehicle_, known);
  const bool by_wrench = !vehicle.has_thrusters();
  const model::Model model = model::nominal_model(vehicle, by_wrench);
  // What the trial has shown already is in the parameters; only what is still to be flown counts.
  const excitation::Segment rest{.name = "rest", .duration = kWindow};
  const View silent{vehicle,
                    {fly(vehicle, model, by_wrench, settings_, rest, rest.duration)},
                    model,
                    kNothing * settings_.noise,
                    kWindow};
  const View heard{vehicle, silent.trials().front(), kWindow};
  const Flights flights{vehicle, heard, settings_};
  std::vector<Suspect> pair(2);
  pair[0] = {.active = first, .change = silent.change(first), .imitated = {}};
  pair[1] = {.active = second, .change = silent.change(second), .imitated = {}};
  std::optional<Answer> answer = Energies{silent, flights.extras(), pair}.tells_apart(0, 1);
  if (!answer) return answer;
  const auto segment = std::ranges::find(flights.extras(), answer->segment, &Extra::name);
  answer->seconds = std::max(answer->seconds, segment->duration);
  return answer;
}

}  // namespace fathom::planning
