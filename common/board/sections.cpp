#include "common/board/sections.hpp"

#include <array>

#include "common/base/entanglement.hpp"

namespace fathom::board {
namespace {

constexpr std::size_t kMostCovariance = 32 * 32;  // twice what any vehicle learns

/// To so many digits: a chart of 300 pixels needs no more.
Json rough(double value) {
  constexpr double kStep = 1e-4;
  return number(std::round(value / kStep) * kStep);
}

template <class Range, class Make>
Json list(const Range& range, Make make) {
  Json array = Json::array();
  for (const auto& each : range) {
    if (array.size() >= kMostItems) break;
    array.push_back(make(each));
  }
  return array;
}

Json texts(const std::vector<std::string>& values) {
  return list(values, [](const std::string& each) { return text(each); });
}

Json named(const NamedValue& value) {
  const auto [low, high] = value.range95();
  return {{"name", text(value.name)}, {"value", number(value.value)}, {"std", number(value.std)},
          {"unit", text(value.unit)}, {"low", number(low)},           {"high", number(high)}};
}

}  // namespace

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json text(std::string_view value) { return std::string{value.substr(0, kMostText)}; }

Json numbers(std::span<const double> values) {
  Json array = Json::array();
  for (const double each : values.first(std::min(values.size(), kMostItems))) array.push_back(number(each));
  return array;
}

Json json_of(const Roll::Entry& entry) {
  const Health& health = entry.health;
  return {{"name", text(health.process)},
          {"host", text(health.host)},
          {"pid", health.pid},
          {"state", text(entry.state)},
          {"detail", text(entry.detail)},
          {"healthy", entry.healthy},
          {"second", entry.second},
          {"returns", entry.returns},
          {"age", number(entry.age)},
          {"cpu", number(health.cpu)},
          {"busy", number(health.busy)},
          {"memory", health.memory},
          {"received", health.received},
          {"published", health.published},
          {"dropped", health.dropped},
          {"rejected", health.rejected},
          {"channels", list(health.channels, [](const ChannelHealth& each) {
             return Json{{"channel", text(each.channel)}, {"rate", number(each.rate)}, {"age", number(each.age)}};
           })}};
}

// The supervisor names a mode as long as it is armed.
Json json_of(const Excitation& said) {
  return {{"phase", text(said.phase)},
          {"mode", text(said.mode)},
          {"armed", !said.mode.empty()},
          {"active", said.active},
          {"signal", text(said.signal)},
          {"reason", text(said.reason)},
          {"elapsed", number(said.elapsed)},
          {"duration", number(said.duration)},
          {"metric", said.metric >= 0.0 ? number(said.metric) : Json(nullptr)},
          {"threshold", number(said.threshold)},
          {"missing", text(said.missing)},
          {"bent", said.bent},
          {"frozen", texts(said.frozen)}};
}

Json json_of(const StateEstimate& said) {
  static constexpr std::array<const char*, kSources> kNames{"AHRS",        "POSE_CAPTURE", "TAG_POSE", "OPTICAL_FLOW",
                                                            "LASER_RANGE", "DVL",          "USBL",     "DEPTH"};
  Json sources = Json::array();
  for (std::size_t i = 0; i < kSources; ++i) {
    if (said.age[i] >= 0.0) sources.push_back({{"channel", kNames[i]}, {"age", number(said.age[i])}});
  }
  return {{"valid", said.valid},
          {"values", numbers(motion_row(said))},
          {"sigma", numbers({said.sigma.data(), 12})},
          {"sources", sources}};
}

Json json_of(const ModelEstimate& said) {
  Entanglement entangled;
  if (said.covariance.size() <= kMostCovariance) entangled = entanglement(said.covariance);
  std::size_t at = 0;
  static constexpr std::array<const char*, 6> kAxes{"X", "Y", "Z", "K", "M", "N"};
  Json failing = Json::array();
  for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
    if (said.residual_excess[static_cast<Eigen::Index>(axis)] > 0.0) failing.push_back(kAxes[axis]);
  }
  return {{"joint", said.joint},
          {"residual_fails_on", failing},
          {"residual_ratio", numbers({said.residual_ratio.data(), 6})},
          {"residual_mean", numbers({said.residual_mean.data(), 6})},
          {"updates", said.updates},
          {"parameters", list(said.parameters,
                              [&](const NamedValue& each) {
                                Json one = named(each);
                                one["frozen"] =
                                    std::find(said.frozen.begin(), said.frozen.end(), each.name) != said.frozen.end();
                                one["entangled"] =
                                    at < entangled.inflation.size() ? number(entangled.inflation[at]) : Json(nullptr);
                                ++at;
                                return one;
                              })},
          {"condition", entangled.inflation.empty() ? Json(nullptr) : number(entangled.condition)},
          {"effects", texts(said.effects)},
          {"effect_numbers", list(said.effect_numbers, named)}};
}

Json json_of(const EffectRanking& said) {
  return {{"verdict", text(said.verdict)},
          {"against", text(said.against)},
          {"segment", text(said.segment)},
          {"duration", number(said.duration)},
          {"candidates", list(said.candidates, [](const EffectEvidence& each) {
             return Json{{"name", text(each.name)},
                         {"variant", text(each.variant)},
                         {"log_odds", number(each.log_odds)},
                         {"error_reduction", number(each.error_reduction)}};
           })}};
}

Json json_of(const LearnedTold& said) {
  return {{"adopted", said.adopted},
          {"words", text(said.words)},
          {"equation", text(said.equation)},
          {"log_odds", number(said.log_odds)},
          {"held_out", number(said.held_out)}};
}

Json json_of(const VehicleCondition& said) {
  return {
      {"kind", text(said.kind)},
      {"heartbeat_age", said.heartbeat_age >= 0.0 ? number(said.heartbeat_age) : Json(nullptr)},
      {"armed", said.armed < 0 ? Json(nullptr) : Json(said.armed == 1)},
      {"mode", text(said.mode)},
      {"failsafe", said.failsafe},
      {"voltage", said.voltage > 0.0 ? number(said.voltage) : Json(nullptr)},
      {"voltage_floor", said.voltage_floor > 0.0 ? number(said.voltage_floor) : Json(nullptr)},
      {"lines",
       list(said.lines,
            [](const ConditionLine& each) {
              return Json{{"name", text(each.name)}, {"ok", each.ok}, {"grave", each.grave}, {"text", text(each.text)}};
            })},
      {"texts", list(said.texts, [](const VehicleText& each) {
         return Json{{"severity", each.severity}, {"text", text(each.text)}, {"age", number(each.age)}};
       })}};
}

Json json_of(const Place& place) {
  const auto bounds = [](const std::optional<Bounds>& one) {
    return one ? Json{{"low", numbers({one->low.data(), 2})}, {"high", numbers({one->high.data(), 2})}} : Json(nullptr);
  };
  const auto points = [](const std::vector<Eigen::Vector3d>& all) {
    return list(all, [](const Eigen::Vector3d& each) { return numbers({each.data(), 2}); });
  };
  const auto one = [](const std::optional<double>& value) { return value ? number(*value) : Json(nullptr); };
  return {{"vehicle", text(place.vehicle)},
          {"site", text(place.site)},
          {"thrusters", texts(place.thrusters)},
          {"hull", numbers({place.hull.data(), 3})},
          {"walls", bounds(place.walls)},
          {"fence", bounds(place.fence)},
          {"surface", one(place.surface)},
          {"floor", one(place.floor)},
          {"tags", points(place.tags)},
          {"transponders", points(place.transponders)},
          {"anchor", place.tether_anchor ? numbers({place.tether_anchor->data(), 3}) : Json(nullptr)}};
}

namespace {

template <class Row>
Json recent(const History<Row>& kept, double now) {
  Json t = Json::array(), rows = Json::array();
  for (std::size_t i = 0; i < Row{}.size(); ++i) rows.push_back(Json::array());
  for (const auto& point : kept.points()) {
    if (now - point.at > History<Row>::kLength) continue;
    t.push_back(rough(point.at - now));
    for (std::size_t i = 0; i < point.row.size(); ++i) rows[i].push_back(rough(point.row[i]));
  }
  return {{"t", t}, {"values", rows}};
}

/// To four digits.
Json short_number(double value) {
  if (!std::isfinite(value) || value == 0.0) return number(value);
  const double step = std::pow(10.0, std::floor(std::log10(std::abs(value))) - 3.0);
  return number(step > 0.0 ? std::round(value / step) * step : 0.0);
}

}  // namespace

Json json_of(const History<MotionRow>& kept, double now) { return recent(kept, now); }
Json json_of(const History<WrenchRow>& kept, double now) { return recent(kept, now); }

Json json_of(const Thinned<TrackRow>& track) {
  Json all = Json::array();
  for (const auto& point : track.points()) all.push_back({rough(point.value[0]), rough(point.value[1])});
  return all;
}

Json json_of(const Thinned<ParameterRows>& converging, double now) {
  Json t = Json::array(), all = Json::array();
  const std::size_t count = converging.points().empty() ? 0 : converging.points().back().value.size();
  for (std::size_t i = 0; i < std::min(count, kMostItems); ++i)
    all.push_back({{"value", Json::array()}, {"low", Json::array()}, {"high", Json::array()}});
  for (const auto& point : converging.points()) {
    t.push_back(rough(point.at - now));
    for (std::size_t i = 0; i < all.size(); ++i) {
      all[i]["value"].push_back(short_number(point.value[i][0]));
      all[i]["low"].push_back(short_number(point.value[i][1]));
      all[i]["high"].push_back(short_number(point.value[i][2]));
    }
  }
  return {{"t", t}, {"parameters", all}};
}

Json json_of(const Chronicle& chronicle, double now) {
  Json all = Json::array();
  for (auto line = chronicle.lines().rbegin(); line != chronicle.lines().rend(); ++line) {
    if (all.size() >= kMostItems) break;
    all.push_back({{"age", number(std::max(now - line->at, 0.0))}, {"kind", line->kind}, {"text", text(line->text)}});
  }
  return all;
}

}  // namespace fathom::board
