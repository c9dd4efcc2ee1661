#include "common/launch/table.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/launch/ending.hpp"

namespace fathom::launch {

void HealthBoard::hear(const Health& health, double now) {
  constexpr std::size_t kMost = 500;  // of names that a hostile publisher may make up
  const auto found = std::find_if(seen_.begin(), seen_.end(), [&](const Seen& each) {
    return each.health.pid == health.pid && each.health.host == health.host && each.health.process == health.process;
  });
  if (found != seen_.end()) {
    *found = {health, now};
  } else {
    if (seen_.size() >= kMost) seen_.erase(seen_.begin());
    seen_.push_back({health, now});
  }
}

namespace {

// "AHRS 100/s, DEPTH 20/s"
std::string heard(const Health& health) {
  std::string text;
  char part[96];
  for (const ChannelHealth& each : health.channels) {
    if (each.rate < 0.5) continue;  // orders, and what is said once
    std::snprintf(part, sizeof part, "%.60s %.0f/s", each.channel.c_str(), each.rate);
    text += (text.empty() ? "" : ", ") + std::string{part};
  }
  return text;
}

}  // namespace

HealthBoard::Word HealthBoard::of(const Sheriff::Row& row, double now) const {
  const Seen* best = nullptr;
  for (const Seen& each : seen_) {
    if (row.status.pid <= 0 || each.health.pid != row.status.pid) continue;
    if (best == nullptr || each.health.process == row.command.id) best = &each;
  }
  if (best == nullptr) return {};
  if (now - best->at > kSilence)
    return {"silent", "no HEALTH for " + std::to_string(std::lround(now - best->at)) + " s"};
  return {best->health.state, best->health.detail, heard(best->health)};
}

namespace {

std::string remark(const Sheriff::Row& row, const HealthBoard::Word& health) {
  if (row.differs) return "runs with another command line than configured";
  if (row.state == State::kStopped) return {};
  if (row.failures >= 2)
    return "failed " + std::to_string(row.failures) + " times in 10 s: " + describe_end(row.last_end);
  if (row.status.pid == 0) return describe_end(row.status.wait_status);
  return health.detail.empty() ? health.heard : health.detail;
}

}  // namespace

std::string table(const std::vector<Sheriff::Row>& rows, const HealthBoard& health, double now, std::size_t width) {
  std::size_t longest = 7, host = 6;
  for (const Sheriff::Row& row : rows) {
    longest = std::max(longest, row.command.id.size());
    host = std::max(host, row.deputy.size());
  }
  std::string text;
  char line[1024];
  const auto add = [&](const char* id, const char* deputy, const char* state, const char* cpu, const char* memory,
                       const char* word, const std::string& more) {
    const int length =
        std::snprintf(line, sizeof line, "%-*s  %-*s  %-11s  %5s  %8s  %-9s  %s", static_cast<int>(longest), id,
                      static_cast<int>(host), deputy, state, cpu, memory, word, more.c_str());
    std::size_t end = std::min({static_cast<std::size_t>(std::max(length, 0)), sizeof line - 1, width});
    while (end > 0 && line[end - 1] == ' ') --end;
    // What a message says shall not command the operator's terminal.
    std::replace_if(
        line, line + end, [](unsigned char c) { return c < 32 || c == 127; }, '?');
    text.append(line, end);
    text += '\n';
  };
  add("process", "host", "state", "CPU", "memory", "health", "");
  for (const Sheriff::Row& row : rows) {
    const HealthBoard::Word word_of = health.of(row, now);
    char cpu[16] = "", memory[16] = "";
    if (row.status.pid > 0) {
      std::snprintf(cpu, sizeof cpu, "%.0f %%", 100.0 * static_cast<double>(row.status.cpu));
      std::snprintf(memory, sizeof memory, "%.0f MB", 1e-6 * static_cast<double>(row.status.resident_memory));
    }
    add(row.command.id.c_str(), row.deputy.c_str(), word(row.state), cpu, memory, word_of.state.c_str(),
        remark(row, word_of));
  }
  return text;
}

std::string gist(const std::vector<Sheriff::Row>& rows, const HealthBoard& health, double now) {
  std::string text;
  for (const Sheriff::Row& row : rows) {
    text += row.command.id + "@" + row.deputy + " " + word(row.state) + " " + std::to_string(row.status.pid) + " " +
            health.of(row, now).state + "\n";
  }
  return text;
}

}  // namespace fathom::launch
