#include "processes/deputy/host.hpp"

#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace fathom::deputy {
namespace {

/// Fields of /proc/PID/stat behind the name, which may hold anything: state is the first.
std::optional<std::istringstream> stat_of(std::int32_t pid) {
  std::ifstream file{"/proc/" + std::to_string(pid) + "/stat"};
  std::string line;
  if (!std::getline(file, line)) return {};
  const auto end = line.rfind(')');
  if (end == std::string::npos) return {};
  return std::istringstream{line.substr(end + 1)};
}

struct Kin {
  std::int32_t pid{}, parent{}, session{};
};

std::vector<Kin> everybody() {
  std::vector<Kin> all;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator{"/proc", ignored}) {
    const std::string name = entry.path().filename().string();
    Kin kin;
    if (std::from_chars(name.data(), name.data() + name.size(), kin.pid).ec != std::errc{}) continue;
    auto fields = stat_of(kin.pid);
    char state{};
    std::int32_t group{};
    if (fields && *fields >> state >> kin.parent >> group >> kin.session) all.push_back(kin);
  }
  return all;
}

}  // namespace

Jiffies jiffies() {
  std::ifstream file{"/proc/stat"};
  std::string word;
  std::int64_t user{}, nice{}, system{}, idle{};
  file >> word >> user >> nice >> system >> idle;
  return {user + nice + system, user + nice + system + idle};
}

void read_memory(DeputyInfo& info) {
  std::ifstream file{"/proc/meminfo"};
  constexpr std::int64_t kUnit = 1024;
  std::string line;
  while (std::getline(file, line)) {
    std::istringstream fields{line};
    std::string name;
    std::int64_t value{};
    fields >> name >> value;
    if (name == "MemTotal:") info.memory_total = value * kUnit;
    if (name == "MemFree:") info.memory_free = value * kUnit;
    if (name == "SwapTotal:") info.swap_total = value * kUnit;
    if (name == "SwapFree:") info.swap_free = value * kUnit;
  }
}

std::optional<ProcessFigures> figures_of(std::int32_t pid) {
  auto fields = stat_of(pid);
  if (!fields) return {};
  std::string skipped;
  for (int i = 0; i < 11; ++i) *fields >> skipped;  // state to cmajflt
  std::int64_t user{}, system{};
  *fields >> user >> system;
  for (int i = 0; i < 7; ++i) *fields >> skipped;  // cutime to starttime
  ProcessFigures figures;
  *fields >> figures.virtual_memory >> figures.resident_memory;
  figures.jiffies = user + system;
  figures.resident_memory *= sysconf(_SC_PAGESIZE);
  return figures;
}

std::vector<std::int32_t> family_of(std::int32_t pid) {
  const std::vector<Kin> all = everybody();
  std::vector<std::int32_t> family{pid};
  for (std::size_t i = 0; i < family.size(); ++i) {
    for (const Kin& each : all) {
      const bool kin = each.parent == family[i] || each.session == pid;
      if (kin && std::find(family.begin(), family.end(), each.pid) == family.end()) family.push_back(each.pid);
    }
  }
  return family;
}

}  // namespace fathom::deputy
