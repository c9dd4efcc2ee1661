#include "common/board/chronicle.hpp"

#include <utility>

namespace fathom::board {
namespace {

constexpr std::size_t kMostWords = 300;
constexpr std::size_t kMostNames = 200;  // that a hostile publisher may make up

std::string kind_of_phase(const std::string& phase) {
  if (phase == "excite" || phase == "approach" || phase == "manual") return "go";
  return phase == "aborted" || phase == "lost" ? "bad" : "";
}

/// Whether `now` is another than before; it is kept.
bool changed(std::optional<std::string>& before, const std::string& now) {
  if (before && *before == now) return false;
  before = now;
  return true;
}

}  // namespace

void Chronicle::note(double now, const std::string& kind, const std::string& text) {
  lines_.push_back({now, kind, text.substr(0, kMostWords)});
  if (lines_.size() > kMost) lines_.pop_front();
}

void Chronicle::hear(const Excitation& said, double now) {
  // Reasons hold numbers that change all the time: while a trial goes on, mode and phase are what happens.
  const bool over = said.phase == "aborted" || said.phase == "lost" || said.phase == "done";
  const std::string key = said.phase + "\n" + said.mode + "\n" + (over ? said.reason : "");
  if (!changed(phase_, key)) return;
  note(now, kind_of_phase(said.phase),
       said.phase + (said.mode.empty() ? "" : ", mode " + said.mode) + (said.reason.empty() ? "" : ": " + said.reason));
}

void Chronicle::hear(const EffectRanking& said, double now) {
  const bool named = said.verdict == "effect" || said.verdict == "ambiguous";  // elsewhere no name is a claim
  const std::string best =
      !named || said.candidates.empty()
          ? ""
          : ", first " + said.candidates.front().name +
                (said.candidates.front().variant.empty() ? "" : " " + said.candidates.front().variant);
  if (changed(verdict_, said.verdict + best)) note(now, "", "verdict: " + said.verdict + best);
}

void Chronicle::hear(const LearnedTold& said, double now) {
  note(now, "", said.adopted ? "learned: " + said.words : "a force that no list holds is not learned: " + said.words);
}

void Chronicle::hear(const ModelEstimate& said, double now) {
  std::string all;
  for (const std::string& each : said.effects) all += (all.empty() ? "" : ", ") + each;
  const bool first = !adopted_;
  if (changed(adopted_, all) && !(first && all.empty()))
    note(now, "", all.empty() ? "the model has no effect any more" : "the model adopts " + all);
}

void Chronicle::hear(const VehicleCondition& said, double now) {
  std::string all;
  bool grave = false;
  for (const ConditionLine& each : said.lines) {
    if (each.ok) continue;
    all += (all.empty() ? "" : ", ") + each.name;
    grave = grave || each.grave;
  }
  const bool first = !condition_;
  if (changed(condition_, all) && !(first && all.empty()))
    note(now,
         all.empty() ? "good"
         : grave     ? "bad"
                     : "warn",
         all.empty() ? "vehicle: all conditions hold" : "vehicle: NOT OK: " + all);
}

void Chronicle::hear(const Answer& said, double now) {
  if (said.sequence == 0) return;
  const std::string key = said.process + " " + std::to_string(said.sequence) + " " + said.text;
  if (std::exchange(answered_, key) == key) return;
  note(now, said.done ? "" : "warn", "order to " + said.process + ": " + said.text);
}

void Chronicle::look(std::span<const Roll::Entry> processes, double now) {
  for (const Roll::Entry& each : processes) {
    const std::string name = each.health.process + " on " + each.health.host;
    const std::string state = each.second ? "there twice" : each.state;
    if (states_.size() >= kMostNames && !states_.contains(name)) continue;
    std::string& before = states_[name];
    if (before == state) continue;
    const bool well = state == "running";
    const char* well_now = before.empty() ? " is there" : before == "unhealthy" ? " is well again" : " is back";
    before = state;
    note(now,
         well                 ? ""
         : state == "stopped" ? ""
                              : "bad",
         each.health.process + (well ? well_now : " " + state) +
             (well || state == "stopped" || each.detail.empty() ? "" : ": " + each.detail));
  }
}

}  // namespace fathom::board
