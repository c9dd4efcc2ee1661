#include "common/runtime/self.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <fathom_lcm/health_t.hpp>
#include <fstream>
#include <utility>

namespace fathom::runtime {
namespace {

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

}  // namespace

Usage::Figures Usage::measure() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const double used = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  const auto now = std::chrono::steady_clock::now();
  const double elapsed = std::chrono::duration<double>(now - std::exchange(last_, now)).count();
  Figures figures;
  if (elapsed > 0.0) figures.cpu = (used - used_) / elapsed;
  used_ = used;
  std::int64_t pages{};
  std::ifstream statm{"/proc/self/statm"};
  if (statm >> pages >> pages) figures.memory = pages * sysconf(_SC_PAGESIZE);
  return figures;
}

std::string host_name() {
  std::array<char, 256> name{};
  if (gethostname(name.data(), name.size() - 1) != 0 || name[0] == '\0') return "unnamed";
  return name.data();
}

Twins::Twins(std::string name, std::string host, std::int32_t pid)
    : name_{std::move(name)}, host_{std::move(host)}, pid_{pid} {}

void Twins::hear(std::span<const std::uint8_t> bytes, Clock::time_point now) {
  fathom_lcm::health_t health{};
  const int length = static_cast<int>(bytes.size());
  if (health.decode(bytes.data(), 0, length) != length || health.process != name_) return;
  if (health.pid == pid_ && health.host == host_) return;
  if (health.state == "stopped" || health.state == "fault") return;  // it is leaving
  other_ = "process " + std::to_string(health.pid) + " on host " + health.host;
  heard_ = now;
}

std::string Twins::complaint(Clock::time_point now) const {
  if (other_.empty() || now - heard_ > kRemembered) return {};
  return "another " + name_ + " speaks on this bus (" + other_ + "); stop one of them";
}

}  // namespace fathom::runtime
