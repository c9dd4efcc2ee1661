#include "common/board/board.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>

#include "common/base/entanglement.hpp"
#include "common/board/standing.hpp"

namespace fathom::board {
namespace {

using Json = nlohmann::json;

// Whatever anybody says, the text stays small enough to be sent twice a second.
constexpr std::size_t kMostText = 300, kMostItems = 100;
constexpr std::size_t kMostCovariance = 32 * 32;  // twice what any vehicle learns

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

/// To so many digits: a chart of 300 pixels needs no more.
Json rough(double value) {
  constexpr double kStep = 1e-4;
  return number(std::round(value / kStep) * kStep);
}

Json text(std::string_view value) { return std::string{value.substr(0, kMostText)}; }

Json numbers(std::span<const double> values) {
  Json array = Json::array();
  for (const double each : values.first(std::min(values.size(), kMostItems))) array.push_back(number(each));
  return array;
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

/// With its age; null when it was never heard.
template <class Sample, class Make>
Json section(const std::optional<Board::Heard<Sample>>& heard, double now, Make make) {
  if (!heard) return nullptr;
  Json object = make(heard->sample);
  object["age"] = number(std::max(now - heard->at, 0.0));
  return object;
}

Json process(const Roll::Entry& entry) {
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
Json trial(const Excitation& said) {
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

Json state(const StateEstimate& said) {
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

Json named(const NamedValue& value) {
  const auto [low, high] = value.range95();
  return {{"name", text(value.name)}, {"value", number(value.value)}, {"std", number(value.std)},
          {"unit", text(value.unit)}, {"low", number(low)},           {"high", number(high)}};
}

Json model(const ModelEstimate& said) {
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

Json ranking(const EffectRanking& said) {
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

Json history(const History& kept, double now) {
  Json t = Json::array(), rows = Json::array();
  for (std::size_t i = 0; i < MotionRow{}.size(); ++i) rows.push_back(Json::array());
  for (const History::Point& point : kept.points()) {
    if (now - point.at > History::kLength) continue;
    t.push_back(rough(point.at - now));
    for (std::size_t i = 0; i < point.row.size(); ++i) rows[i].push_back(rough(point.row[i]));
  }
  return {{"t", t}, {"values", rows}};
}

}  // namespace

void Board::hear(const Health& sample, double now) {
  Health kept = sample;
  for (std::string* each : {&kept.process, &kept.host, &kept.state, &kept.detail}) {
    if (each->size() > kMostText) each->resize(kMostText);
  }
  if (kept.channels.size() > kMostItems) kept.channels.resize(kMostItems);
  for (ChannelHealth& each : kept.channels) {
    if (each.channel.size() > kMostText) each.channel.resize(kMostText);
  }
  roll_.hear(kept, now);
  if (sample.pid != self_.pid || sample.host != self_.host) heard_ = now;
}

void Board::hear(const StateEstimate& sample, double now) {
  take(state_, sample, now);
  history_.add(sample, now);
}

std::string Board::json(double now, std::int64_t number_of_text) const {
  Json all;
  all["number"] = number_of_text;
  all["bus"] = text(self_.bus);
  all["silence"] = Roll::kSilence;
  all["heard"] = heard_ ? number(std::max(now - *heard_, 0.0)) : Json(nullptr);
  const std::vector<Roll::Entry> entries = roll_.entries(now);
  all["processes"] = list(entries, process);
  const Standing stands = standing({.trial = excitation_ ? &excitation_->sample : nullptr,
                                    .trial_age = excitation_ ? now - excitation_->at : 0.0,
                                    .heard = heard_ ? std::optional{std::max(now - *heard_, 0.0)} : std::nullopt,
                                    .processes = entries});
  const auto badge = [](const Badge& said) { return Json{{"text", text(said.text)}, {"kind", said.kind}}; };
  all["standing"] = {{"phase", badge(stands.phase)},
                     {"armed", badge(stands.armed)},
                     {"alarm", text(stands.alarm)},
                     {"remark", text(stands.remark)},
                     {"over", stands.over}};
  all["trial"] = section(excitation_, now, trial);
  all["thrusters"] = section(thrusters_, now, [](const Thrusters& said) {
    return Json{{"force", numbers(said.force)}, {"tau", said.has_tau ? numbers(said.tau) : Json(nullptr)}};
  });
  all["asked"] = section(command_, now, [](const WrenchCommand& said) {
    return Json{{"tau", numbers({said.tau.data(), 6})}, {"commander", text(said.commander)}};
  });
  all["battery"] = section(battery_, now, [](const Battery& said) { return Json{{"voltage", number(said.voltage)}}; });
  all["state"] = section(state_, now, state);
  all["history"] = history(history_, now);
  all["model"] = section(model_, now, model);
  all["effects"] = section(ranking_, now, ranking);
  return all.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace fathom::board
