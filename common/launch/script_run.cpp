#include "common/launch/script_run.hpp"

#include <algorithm>
#include <utility>

#include "common/launch/ending.hpp"

namespace fathom::launch {
namespace {

std::string name(const Target& target) {
  if (target.kind == Target::Kind::kEverything) return "everything";
  return (target.kind == Target::Kind::kGroup ? "group " : "") + target.name;
}

}  // namespace

ScriptRun::ScriptRun(Sheriff& sheriff, const Script& script, Care care, Ready ready)
    : sheriff_{sheriff}, care_{care}, ready_{std::move(ready)} {
  add(script);
}

void ScriptRun::add(const Script& script) {
  for (const Action& action : script.actions) {
    if (action.verb == Action::Verb::kScript) {
      add(sheriff_.config().require_script(action.script));
    } else {
      actions_.push_back(action);
    }
  }
}

ScriptRun::Result ScriptRun::fail(const Action& action, const std::string& why) {
  const std::string place = action.line > 0 ? ":" + std::to_string(action.line) : "";
  const std::string line = sheriff_.config().path + place + ": " + why;
  failed_ += (failed_.empty() ? "" : "; ") + line;
  text_ = failed_;
  return Result::kFailed;
}

void ScriptRun::next(double now) {
  waiting_since_.reset();
  silent_since_.reset();
  not_before_ = now + kPause;
  ++at_;
}

bool ScriptRun::fulfilled(const Action& action, double now) {
  const auto rows = sheriff_.rows(action.target, now);
  return std::all_of(rows.begin(), rows.end(), [&](const Sheriff::Row& row) {
    const bool stopped = row.state == State::kStopped || row.state == State::kIdle;
    const bool ready = !ready_ || now - *waiting_since_ > kWord || row.state != State::kRunning || ready_(row);
    if (*action.awaited == Awaited::kRunning)
      return ready && (row.state == State::kRunning || row.state == State::kStopped);
    return stopped || row.state == State::kFailed;
  });
}

std::string ScriptRun::failure_elsewhere(const Action& action, double now) {
  for (const Sheriff::Row& row : sheriff_.rows(now)) {
    if (row.state != State::kFailed || !row.started || row.foreign || row.command.auto_respawn) continue;
    if (!covers(action.target, row.command)) {
      return row.command.id + " failed: " + describe_end(row.status.wait_status);
    }
  }
  return {};
}

ScriptRun::Result ScriptRun::step(double now) {
  if (!failed_.empty() && care_ == Care::kGiveUp) return Result::kFailed;
  while (at_ < actions_.size()) {
    if (now < not_before_) return Result::kGoing;
    const Action& action = actions_[at_];
    if (!waiting_since_) {
      text_.clear();
      if (action.verb == Action::Verb::kPause) not_before_ = now + 1e-3 * action.pause_ms;
      if (action.verb == Action::Verb::kStart) sheriff_.start(action.target);
      if (action.verb == Action::Verb::kStop) sheriff_.stop(action.target);
      if (action.verb == Action::Verb::kRestart) sheriff_.restart(action.target);
      if (!action.awaited) {
        ++at_;
        continue;
      }
      waiting_since_ = now;
    }
    if (fulfilled(action, now)) {
      next(now);
      continue;
    }
    const std::string elsewhere = care_ == Care::kGiveUp ? failure_elsewhere(action, now) : "";
    if (!elsewhere.empty()) return fail(action, elsewhere);
    bool silent = false;
    for (const Sheriff::Row& row : sheriff_.rows(action.target, now)) {
      const bool lost = row.state == State::kLost || row.state == State::kUnheard;
      silent = silent || lost;
      if (*action.awaited == Awaited::kRunning && row.state == State::kFailed && !row.command.auto_respawn) {
        return fail(action, row.command.id + " failed: " + describe_end(row.status.wait_status));
      }
      if (lost && now - silent_since_.value_or(now) > (care_ == Care::kGoOn ? kStopPatience : kPatience)) {
        const Result failed = fail(action, "deputy " + row.deputy + " is silent; is it running and the link up?");
        if (care_ == Care::kGiveUp) return failed;
        next(now);
        return Result::kGoing;
      }
    }
    if (!silent) silent_since_.reset();
    if (silent && !silent_since_) silent_since_ = now;
    const bool running = *action.awaited == Awaited::kRunning;
    text_ = "waits until " + name(action.target) + (running ? " runs" : " has stopped");
    if (running && now - *waiting_since_ > kPatience) return fail(action, text_ + ": not within 30 s");
    return Result::kGoing;
  }
  text_ = failed_;
  if (now < not_before_) return Result::kGoing;
  return failed_.empty() ? Result::kDone : Result::kFailed;
}

}  // namespace fathom::launch
