#include "common/board/board.hpp"

#include <algorithm>
#include <utility>

#include "common/board/sections.hpp"
#include "common/board/standing.hpp"

namespace fathom::board {
namespace {

/// With its age; null when it was never heard.
template <class Sample, class Make>
Json section(const std::optional<Board::Heard<Sample>>& heard, double now, Make make) {
  if (!heard) return nullptr;
  Json object = make(heard->sample);
  object["age"] = number(std::max(now - heard->at, 0.0));
  return object;
}

constexpr std::size_t kMostConfig = 200'000, kMostTellers = 30;  // bytes of files; processes that tell of theirs

constexpr auto kAsItIs = [](const auto& said) { return json_of(said); };

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

void Board::hear(const Excitation& sample, double now) {
  // Another trial begins: what was flown and learnt before it is another picture.
  if (excitation_ && excitation_->sample.mode.empty() && !sample.mode.empty()) {
    track_.clear();
    converging_.clear();
    learned_.reset();
  }
  take(excitation_, sample, now);
  chronicle_.hear(sample, now);
}

void Board::hear(const StateEstimate& sample, double now) {
  take(state_, sample, now);
  history_.add(motion_row(sample), now);
  if (sample.valid) track_.add(now, {sample.p_WB.x(), sample.p_WB.y()});
}

void Board::hear(const ModelEstimate& sample, double now) {
  std::vector<std::string> names;
  ParameterRows rows;
  for (const NamedValue& each : sample.parameters) {
    if (rows.size() >= kMostItems) break;
    const auto [low, high] = each.range95();
    names.push_back(each.name);
    rows.push_back({each.value, low, high});
  }
  if (names != names_) converging_.clear();
  names_ = std::move(names);
  converging_.add(now, rows);
  chronicle_.hear(sample, now);
  take(model_, sample, now);
}

void Board::hear(const EffectRanking& sample, double now) {
  chronicle_.hear(sample, now);
  take(ranking_, sample, now);
}

void Board::hear(const LearnedTold& sample, double now) {
  chronicle_.hear(sample, now);
  take(learned_, sample, now);
}

void Board::hear(const Residual& sample, double now) {
  WrenchRow row{};
  for (std::size_t i = 0; i < row.size(); ++i) row[i] = sample.wrench[static_cast<Eigen::Index>(i)];
  residuals_.add(row, now);
  take(residual_, sample, now);
}

void Board::hear(const VehicleCondition& sample, double now) {
  chronicle_.hear(sample, now);
  take(vehicle_, sample, now);
}

void Board::hear(const ProcessInfo& sample, double /*now*/) {
  if (sample.config.size() > kMostConfig || (told_.size() >= kMostTellers && !told_.contains(sample.process))) return;
  if (std::string& before = told_[sample.process]; before != sample.config) place_.take_told(before = sample.config);
}

void Board::watch(double now) { chronicle_.look(roll_.entries(now), now); }

void Board::tell_abort(const std::string& state, const std::string& words, double now) {
  if (state != "asked" || !abort_ || abort_->sample.state != "asked")
    chronicle_.note(now,
                    state == "confirmed" ? "good"
                    : state == "asked"   ? "warn"
                                         : "bad",
                    state == "asked" ? "ABORT was pressed on a page" : words);
  abort_ = Heard<Abort>{{state, words}, now};
}

std::string Board::json(double now, std::int64_t number_of_text) const {
  Json all;
  all["number"] = number_of_text;
  all["bus"] = text(self_.bus);
  all["replay"] = replay_
                      ? Json{{"at", number(replay_->at)}, {"length", number(replay_->length)}, {"over", replay_->over}}
                      : Json(nullptr);
  all["silence"] = Roll::kSilence;
  all["heard"] = heard_ ? number(std::max(now - *heard_, 0.0)) : Json(nullptr);
  const std::vector<Roll::Entry> entries = roll_.entries(now);
  Json& processes = all["processes"] = Json::array();
  for (const Roll::Entry& each : entries) processes.push_back(json_of(each));
  const Standing stands = standing({.trial = excitation_ ? &excitation_->sample : nullptr,
                                    .trial_age = excitation_ ? now - excitation_->at : 0.0,
                                    .heard = heard_ ? std::optional{std::max(now - *heard_, 0.0)} : std::nullopt,
                                    .processes = entries});
  const auto badge = [](const Badge& said) { return Json{{"text", text(said.text)}, {"kind", said.kind}}; };
  all["standing"] = {{"phase", badge(stands.phase)},  {"armed", badge(stands.armed)}, {"alarm", text(stands.alarm)},
                     {"remark", text(stands.remark)}, {"over", stands.over},          {"calm", stands.calm}};
  all["place"] = json_of(place_);
  all["trial"] = section(excitation_, now, kAsItIs);
  all["thrusters"] = section(thrusters_, now, [](const Thrusters& said) {
    return Json{{"force", numbers(said.force)}, {"tau", said.has_tau ? numbers(said.tau) : Json(nullptr)}};
  });
  all["asked"] = section(command_, now, [](const WrenchCommand& said) {
    return Json{{"tau", numbers({said.tau.data(), 6})}, {"commander", text(said.commander)}};
  });
  all["battery"] = section(battery_, now, [](const Battery& said) { return Json{{"voltage", number(said.voltage)}}; });
  all["vehicle"] = section(vehicle_, now, kAsItIs);
  all["state"] = section(state_, now, kAsItIs);
  all["history"] = json_of(history_, now);
  all["track"] = json_of(track_);
  all["model"] = section(model_, now, kAsItIs);
  all["converging"] = json_of(converging_, now);
  all["residual"] = section(residual_, now, [](const Residual& said) {
    return Json{{"wrench", numbers({said.wrench.data(), 6})}};
  });
  all["residuals"] = json_of(residuals_, now);
  all["effects"] = section(ranking_, now, kAsItIs);
  all["learned"] = section(learned_, now, kAsItIs);
  all["events"] = json_of(chronicle_, now);
  all["abort"] = section(abort_, now, [](const Abort& said) {
    return Json{{"state", said.state}, {"text", text(said.text)}};
  });
  return all.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace fathom::board
