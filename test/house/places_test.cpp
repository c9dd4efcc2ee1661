// The repository stands alone: no file names a place on the machine where it was written or a folder beside it.
#include <doctest/doctest.h>

#include <cctype>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace {

// Each is cut in two, so that this file passes its own test.
const std::vector<std::string> kPlaces{std::string{"/wo"} + "rk/",   std::string{"/ho"} + "me/",
                                       std::string{"/ro"} + "ot/",   std::string{"/Us"} + "ers/",
                                       std::string{".lib"} + "rary", std::string{"shar"} + "ed/"};

// No sources: git's own, what .gitignore names, recorded data. Build folders are known by their cache.
const std::set<std::string> kSkipped{".git", "build", "out", ".cache", "test/data"};

// The place that `line` names; empty when it names none. Within a longer word it is none.
std::string_view place_in(std::string_view line) {
  for (const std::string& place : kPlaces) {
    for (auto at = line.find(place); at != std::string_view::npos; at = line.find(place, at + 1)) {
      const char before = at == 0 ? ' ' : line[at - 1];
      const bool inside_a_word = std::isalnum(static_cast<unsigned char>(before)) != 0 || before == '_';
      if (!inside_a_word) return place;
    }
  }
  return {};
}

}  // namespace

TEST_CASE("places: no file names this or that machine's folders") {
  const std::filesystem::path root{FATHOM_SOURCE_DIR};
  int files = 0;
  for (auto entry = std::filesystem::recursive_directory_iterator{root}; entry != end(entry); ++entry) {
    const std::string path = std::filesystem::relative(entry->path(), root).string();
    if (kSkipped.contains(path) || exists(entry->path() / "CMakeCache.txt")) {
      entry.disable_recursion_pending();
      continue;
    }
    if (!entry->is_regular_file() || entry->path().extension() == ".png") continue;
    ++files;
    std::ifstream text{entry->path()};
    std::string line;
    for (int number = 1; std::getline(text, line); ++number) {
      const std::string_view place = place_in(line);
      if (!place.empty()) FAIL_CHECK(path << ":" << number << ": names " << place << ": " << line);
    }
  }
  CHECK(files > 100);  // it did look
}

TEST_CASE("places: the test itself sees what is forbidden and lets pass what is not") {
  for (const std::string& place : kPlaces) CHECK(place_in("see " + place + "notes.md") == place);
  CHECK(place_in("../" + kPlaces.back() + "data") == kPlaces.back());
  CHECK(place_in("net" + kPlaces.back() + "data").empty());
  CHECK(place_in("frame" + kPlaces.front()).empty());
  CHECK(place_in("std::shared_ptr, /var/lib, a library, test/data").empty());
}
