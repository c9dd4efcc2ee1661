#include "common/board/standing.hpp"

#include <algorithm>
#include <cstdio>
#include <set>
#include <vector>

namespace fathom::board {
namespace {

constexpr double kOld = 3.0;  // s: EXCITATION comes with every STATE

std::string ago(double age) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f s", age < 10.0 ? 1 : 0, age);
  return text;
}

const Roll::Entry* find(std::span<const Roll::Entry> all, const std::string& name) {
  const auto found = std::ranges::find_if(all, [&](const Roll::Entry& each) { return each.health.process == name; });
  return found == all.end() ? nullptr : &*found;
}

std::string kind_of(const std::string& phase) {
  if (phase == "excite" || phase == "approach") return "go";
  if (phase == "done") return "good";
  return phase == "aborted" || phase == "lost" ? "bad" : "";
}

bool is_self(const Roll::Entry& entry) { return entry.health.process.starts_with("board@"); }

/// Who is not well, each with the reason that HEALTH begins with.
std::string sick(const StandingInput& input, bool fresh) {
  std::vector<std::string> all;
  if (input.trial != nullptr && fresh && input.trial->phase == "aborted")
    all.push_back("aborted: " + input.trial->reason);
  for (const Roll::Entry& each : input.processes) {
    if (each.healthy || each.state == "stopped") continue;
    const std::string reason = each.detail.substr(0, each.detail.find("; "));
    if (each.second) {
      all.push_back(each.health.process + " is there twice");
    } else if (each.state == "silent" || reason.empty()) {
      all.push_back(each.health.process + " " + each.state);
    } else {
      all.push_back(each.health.process + " " + each.state + ": " + reason);
    }
  }
  std::set<std::string> told;
  std::string text;
  for (const std::string& each : all) {
    if (told.insert(each).second) text += (text.empty() ? "" : "; ") + each;
  }
  return text;
}

}  // namespace

Standing standing(const StandingInput& input) {
  Standing said;
  const bool fresh = input.trial != nullptr && input.trial_age < kOld;
  const Roll::Entry* supervisor = find(input.processes, "supervisor");
  const bool ended = supervisor != nullptr && supervisor->state == "stopped";
  const bool there = supervisor != nullptr && (supervisor->state == "running" || supervisor->state == "unhealthy");
  if (input.trial == nullptr) {
    said.phase = {"no EXCITATION", ""};
  } else {
    const std::string& phase = input.trial->phase;
    const bool armed = !input.trial->mode.empty();  // the supervisor names a mode as long as it is armed
    const bool over = !armed && (phase == "done" || phase == "disarmed");
    said.calm = over && (ended || there);
    if (fresh || said.calm) {
      said.phase = {phase, kind_of(phase)};
    } else {
      said.phase = {"was " + phase, "bad"};
    }
    if (fresh) {
      said.armed = {armed ? "armed" : "not armed", armed ? "warn" : ""};
    } else if (ended || (over && there)) {
      said.armed = {"not armed", ""};  // commands of a supervisor that has stopped live for half a second
    } else {
      said.armed = {"armed? not known", "bad"};
    }
  }
  const bool silent = !input.heard || *input.heard > Roll::kSilence;
  const bool in_order = supervisor != nullptr && std::ranges::all_of(input.processes, [](const Roll::Entry& each) {
                          return is_self(each) || each.state == "stopped";
                        });
  if (!input.heard) {
    said.alarm = "nothing heard on this bus yet: do processes run, and on the same LCM_DEFAULT_URL?";
  } else if (silent && in_order) {
    said.remark = "every process has stopped in order, " + ago(*input.heard) + " ago: all below is of then";
    said.over = true;
  } else if (silent) {
    said.alarm = "nothing heard for " + ago(*input.heard) + ": all below is of then";
  } else {
    said.alarm = sick(input, fresh);
  }
  return said;
}

}  // namespace fathom::board
