#include "common/excitation/needs.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace fathom::excitation {
namespace {

constexpr double kAway = 1.0;  // s between two looks at the clock: it was this process that stood still
constexpr char kStart[] = "start it, the sheriff's table tells why it does not run; then arm again";

/// HEALTH's detail begins with the reason; counts follow.
std::string reason_of(const Health& health) {
  const std::string reason = health.detail.substr(0, health.detail.find("; "));
  return reason.empty() ? "" : ": " + reason;
}

std::string seconds(double time) { return std::to_string(std::lround(time)) + " s"; }

bool ended(const Health& health) { return health.state == "stopped" || health.state == "fault"; }

}  // namespace

std::vector<std::string> alternatives(const std::string& need) {
  constexpr std::string_view kOr = " or ";
  std::vector<std::string> names;
  std::size_t from = 0;
  for (auto at = need.find(kOr); at != std::string::npos; at = need.find(kOr, from)) {
    names.push_back(need.substr(from, at - from));
    from = at + kOr.size();
  }
  names.push_back(need.substr(from));
  return names;
}

Needs::Needs(const std::vector<std::string>& needs, double silence) : silence_{silence} {
  for (const std::string& text : needs) needs_.push_back({.text = text, .names = alternatives(text)});
}

void Needs::hear(const Health& health) {
  const auto has = [&](const Need& need) {
    return std::find(need.names.begin(), need.names.end(), health.process) != need.names.end();
  };
  if (std::none_of(needs_.begin(), needs_.end(), has)) return;
  Word& word = words_[health.process];
  word.health = health;
  word.fresh = true;
}

void Needs::watch(double now) {
  if (!since_) since_ = now;
  const double away = now_ ? now - *now_ : 0.0;
  if (away > kAway) {  // nobody is silent because nobody listened
    *since_ += away;
    for (auto& [process, word] : words_) {
      if (word.at) *word.at += away;
    }
  }
  now_ = now;
  for (auto& [process, word] : words_) {
    if (word.fresh) word.at = now;
    word.fresh = false;
  }
}

const std::string* Needs::met_by(const Need& need) const {
  const auto spoke = std::find_if(need.names.begin(), need.names.end(),
                                  [&](const std::string& name) { return words_.contains(name); });
  return spoke == need.names.end() ? nullptr : &*spoke;
}

std::optional<Needs::Trouble> Needs::gone(const Need& need) const {
  const std::string* name = met_by(need);
  if (name == nullptr) {
    const double since = since_ ? *now_ - *since_ : 0.0;
    if (since <= silence_) return std::nullopt;  // it may be about to speak
    return Trouble{need.text, "has not been heard for " + seconds(since), kStart};
  }
  const Word& word = words_.at(*name);
  if (ended(word.health)) return Trouble{*name, "is " + word.health.state + reason_of(word.health), kStart};
  if (now_ && word.at && *now_ - *word.at > silence_)
    return Trouble{*name, "is silent: no HEALTH for " + seconds(*now_ - *word.at), kStart};
  return std::nullopt;
}

std::optional<Needs::Trouble> Needs::trouble() const {
  for (const Need& need : needs_) {
    if (auto found = gone(need)) return found;
  }
  for (const Need& need : needs_) {
    const auto word = words_.find(need.names.front());
    if (word == words_.end() || word->second.health.state == "running") continue;
    const Health& health = word->second.health;
    return Trouble{health.process, "is " + health.state + reason_of(health), "see to it, then arm again"};
  }
  return std::nullopt;
}

std::string Needs::behind() const {
  constexpr double kSilence = 3.0;  // s behind the others
  Utime newest = 0;
  for (const auto& [process, word] : words_) newest = std::max(newest, word.health.utime);
  for (const auto& [process, word] : words_) {
    if (seconds_between(word.health.utime, newest) > kSilence) return process;
  }
  return {};
}

}  // namespace fathom::excitation
