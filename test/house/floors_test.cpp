// The floors: every #include of common/ and processes/ against the table of rooms. A file may use its own room and
// lower floors, never a neighbour; libraries that would bind the whole house to them have one room each.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace {

const std::map<std::string, int> kFloors{
    {"base", 0},        {"samples", 1},    {"model", 2},      {"devices", 2},    {"vision", 3},
    {"tables", 2},      {"launch", 2},     {"orders", 2},     {"link", 3},       {"estimation", 3},
    {"board", 4},       {"likelihood", 3}, {"excitation", 3}, {"simulation", 3}, {"identification", 3},
    {"inference", 4},   {"joint", 4},      {"pictures", 4},   {"report", 4},     {"planning", 6},
    {"verdict", 6},     {"runtime", 5},    {"wire", 5},       {"driver", 6},     {"recordings", 3},
    {"consistency", 4}, {"learning", 5},   {"result", 6},     {"exports", 7},    {"drafts", 1},
    {"residual", 3},    {"preflight", 4},  {"live", 7}};

// Rooms that see less than their floor allows.
const std::map<std::string, std::set<std::string>> kNarrow{{"wire", {"samples", "base"}}, {"runtime", {"base"}}};

// Who may include a library. "processes" stands for all of processes/.
const std::vector<std::pair<std::string, std::set<std::string>>> kLibraries{
    {"lcm/", {"wire", "runtime"}},
    {"fathom_lcm/", {"wire", "runtime", "driver", "processes"}},
    {"procman_lcm/", {"wire", "processes"}},
    {"opencv2/", {"vision", "pictures"}},
    {"apriltag/", {"vision"}},
    {"yaml-cpp/", {"base"}},
    {"sodium", {"base"}},
    {"spdlog/", {"runtime"}},
    {"httplib.h", {"processes"}},
    {"asio", {"link"}},
    {"lz4frame.h", {"recordings"}},
    {"zstd.h", {"recordings"}},
    {"bzlib.h", {"recordings"}},
    {"sqlite3.h", {"recordings"}},
    {"matio.h", {"recordings"}},
    {"zip.h", {"recordings"}},
    {"tinyxml2", {"drafts"}}};

std::string part(const std::string& path, std::size_t number) {
  std::size_t begin = 0;
  for (std::size_t i = 0; i < number; ++i) {
    begin = path.find('/', begin);
    if (begin == std::string::npos) return {};
    ++begin;
  }
  return path.substr(begin, path.find('/', begin) - begin);
}

// Why `file` (path from the top of the repository) must not include `target`; empty when it may.
std::string objection(const std::string& file, const std::string& target, bool quoted) {
  const std::string top = part(file, 0);
  const std::string room = top == "common" ? part(file, 1) : top;
  for (const auto& [library, rooms] : kLibraries) {
    if (target.starts_with(library) && !rooms.contains(room)) return "this library has other rooms";
  }
  if (!quoted) return {};
  const std::string their_top = part(target, 0);
  if (their_top == "processes")
    return part(target, 1) == part(file, 1) && top == "processes" ? "" : "belongs to a process";
  if (their_top != "common") return "the path must begin with common/ or processes/";
  const std::string their_room = part(target, 1);
  if (!kFloors.contains(their_room)) return "no such room in the table of this test";
  if (top == "processes" || their_room == room) return {};
  if (!kFloors.contains(room)) return "this room is not in the table of this test";
  if (kFloors.at(their_room) >= kFloors.at(room)) return "not on a lower floor";
  if (kNarrow.contains(room) && !kNarrow.at(room).contains(their_room)) return "this room sees less";
  return {};
}

std::vector<std::string> objections_in(const std::filesystem::path& root) {
  std::vector<std::string> found;
  for (const char* top : {"common", "processes"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator{root / top}) {
      if (entry.path().extension() != ".hpp" && entry.path().extension() != ".cpp") continue;
      const std::string file = std::filesystem::relative(entry.path(), root).string();
      std::ifstream text{entry.path()};
      std::string line;
      for (int number = 1; std::getline(text, line); ++number) {
        const auto begin = line.find_first_of("\"<");
        if (!line.starts_with("#include") || begin == std::string::npos) continue;
        const bool quoted = line[begin] == '"';
        const std::string target = line.substr(begin + 1, line.find(quoted ? '"' : '>', begin + 1) - begin - 1);
        const std::string why = target.ends_with(".def") ? "" : objection(file, target, quoted);
        if (!why.empty()) found.push_back(file + ":" + std::to_string(number) + ": " + target + ": " + why);
      }
    }
  }
  return found;
}

}  // namespace

TEST_CASE("floors: no file includes a neighbour, a higher floor, or a library of another room") {
  for (const std::string& each : objections_in(FATHOM_SOURCE_DIR)) FAIL_CHECK(each);
}

TEST_CASE("floors: the test itself sees what is forbidden and lets pass what is not") {
  CHECK(objection("common/model/a.cpp", "common/samples/b.hpp", true).empty());
  CHECK(objection("common/model/effects/a.cpp", "common/model/b.hpp", true).empty());
  CHECK(objection("common/preflight/a.cpp", "common/identification/b.hpp", true).empty());
  CHECK(objection("processes/estimator/main.cpp", "common/wire/b.hpp", true).empty());
  CHECK(objection("processes/estimator/main.cpp", "fathom_lcm/state_t.hpp", false).empty());
  CHECK(objection("common/wire/a.cpp", "lcm/lcm-cpp.hpp", false).empty());
  CHECK_FALSE(objection("common/estimation/a.cpp", "common/identification/b.hpp", true).empty());
  CHECK_FALSE(objection("common/base/a.cpp", "common/samples/b.hpp", true).empty());
  CHECK_FALSE(objection("common/wire/a.cpp", "common/runtime/b.hpp", true).empty());
  CHECK_FALSE(objection("common/wire/a.cpp", "common/model/b.hpp", true).empty());
  CHECK_FALSE(objection("common/runtime/a.cpp", "common/samples/b.hpp", true).empty());
  CHECK_FALSE(objection("common/model/a.cpp", "lcm/lcm-cpp.hpp", false).empty());
  CHECK_FALSE(objection("common/report/a.cpp", "fathom_lcm/state_t.hpp", false).empty());
  CHECK_FALSE(objection("processes/vision/main.cpp", "lcm/lcm-cpp.hpp", false).empty());
  CHECK_FALSE(objection("common/model/a.cpp", "processes/vision/b.hpp", true).empty());
  CHECK_FALSE(objection("processes/vision/main.cpp", "processes/estimator/b.hpp", true).empty());
  CHECK_FALSE(objection("common/model/a.cpp", "b.hpp", true).empty());
  CHECK_FALSE(objection("common/attic/a.cpp", "common/base/b.hpp", true).empty());
}

TEST_CASE("floors: every folder of common/ is a room of the table") {
  for (const auto& entry : std::filesystem::directory_iterator{std::string{FATHOM_SOURCE_DIR} + "/common"}) {
    if (entry.is_directory()) {
      CAPTURE(entry.path().string());
      CHECK(kFloors.contains(entry.path().filename().string()));
    }
  }
}

TEST_CASE("floors: docs/architecture.md tells every room with its floor") {
  std::ifstream text{std::string{FATHOM_SOURCE_DIR} + "/docs/architecture.md"};
  std::map<std::string, int> told;
  for (std::string line; std::getline(text, line);) {
    char room[32];
    int floor = -1;
    if (std::sscanf(line.c_str(), "| `%31[a-z]` | %d |", room, &floor) == 2) told[room] = floor;
  }
  CHECK(told == kFloors);
}

TEST_CASE("floors: no folder of common/, processes/ or test/ holds more sources than one can look over") {
  constexpr int kMost = 25;
  std::map<std::string, int> sources;
  for (const char* top : {"common", "processes", "test"}) {
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator{std::string{FATHOM_SOURCE_DIR} + "/" + top}) {
      if (entry.path().extension() == ".cpp") ++sources[entry.path().parent_path().string()];
    }
  }
  CHECK(sources.size() > 40);  // it did look
  for (const auto& [folder, count] : sources) {
    CAPTURE(folder);
    CHECK(count <= kMost);
  }
}
