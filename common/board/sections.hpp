// What was heard as JSON, section by section of the page. Numbers that are not finite are null; texts and lists are
// cut, so that the whole stays small enough to be sent twice a second whatever anybody says on the bus.
#pragma once

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>

#include "common/board/chronicle.hpp"
#include "common/board/history.hpp"
#include "common/board/place.hpp"
#include "common/board/roll.hpp"
#include "common/board/thinned.hpp"
#include "common/samples/commands.hpp"
#include "common/samples/estimates.hpp"
#include "common/samples/vehicle_condition.hpp"

namespace fathom::board {

using Json = nlohmann::json;

constexpr std::size_t kMostText = 300, kMostItems = 100;

[[nodiscard]] Json number(double value);
[[nodiscard]] Json text(std::string_view value);
[[nodiscard]] Json numbers(std::span<const double> values);

/// Position in W seen from above, and how the estimate of every parameter went: value, low, high.
using TrackRow = std::array<double, 2>;
using ParameterRows = std::vector<std::array<double, 3>>;

[[nodiscard]] Json json_of(const Roll::Entry& entry);
[[nodiscard]] Json json_of(const Excitation& said);
[[nodiscard]] Json json_of(const StateEstimate& said);
[[nodiscard]] Json json_of(const ModelEstimate& said);
[[nodiscard]] Json json_of(const EffectRanking& said);
[[nodiscard]] Json json_of(const LearnedTold& said);
[[nodiscard]] Json json_of(const VehicleCondition& said);
[[nodiscard]] Json json_of(const Place& place);
/// The last two minutes: times before now, and a list for each component.
[[nodiscard]] Json json_of(const History<MotionRow>& kept, double now);
[[nodiscard]] Json json_of(const History<WrenchRow>& kept, double now);
[[nodiscard]] Json json_of(const Thinned<TrackRow>& track);
[[nodiscard]] Json json_of(const Thinned<ParameterRows>& converging, double now);
/// Newest first.
[[nodiscard]] Json json_of(const Chronicle& chronicle, double now);

}  // namespace fathom::board
