#include "common/runtime/speakers.hpp"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <fathom_lcm/health_t.hpp>
#include <fstream>
#include <iterator>
#include <sstream>

namespace fathom::runtime {

std::optional<std::int64_t> process_start(std::int32_t pid) {
  constexpr std::int64_t kMicroseconds = 1'000'000;
  constexpr int kBehindName = 19;  // words of /proc/PID/stat between the name, which may be anything, and the start
  if (pid <= 0) return {};
  std::ifstream file{"/proc/" + std::to_string(pid) + "/stat"};
  const std::string line{std::istreambuf_iterator<char>{file}, {}};
  const auto name_end = line.rfind(')');
  if (name_end == std::string::npos) {
    if (kill(pid, 0) == 0 || errno == EPERM) return 0;
    return {};
  }
  std::istringstream words{line.substr(name_end + 1)};
  std::string word;
  words >> word;
  if (word == "Z" || word == "X") return {};  // ended, and not yet waited for
  for (int i = 1; i < kBehindName; ++i) words >> word;
  std::int64_t ticks{};
  if (!(words >> ticks)) return {};
  return ticks * (kMicroseconds / sysconf(_SC_CLK_TCK));
}

bool Speakers::lives(const fathom_lcm::health_t& health) const {
  if (health.state == "stopped" || health.state == "fault") return true;
  const auto start = process_start(health.pid);
  return start && (*start == 0 || *start == health.start);
}

bool Speakers::believes(const fathom_lcm::health_t& health) {
  const bool here = !host_.empty() && health.host == host_;
  if (!here && own_.contains(health.process)) return false;
  Identity identity{health.process, health.host, health.pid, health.start};
  const auto known = last_.find(identity);
  if (known != last_.end() && health.sequence <= known->second.sequence) return false;
  if (here && !lives(health)) return false;
  if (known == last_.end() && last_.size() >= kMost)
    last_.erase(std::ranges::min_element(last_, {}, [](const auto& each) { return each.second.heard; }));
  last_[std::move(identity)] = {.sequence = health.sequence, .heard = ++words_};
  if (here && home_ == Home::kFirst && own_.size() < kMost) own_.insert(health.process);
  return true;
}

}  // namespace fathom::runtime
