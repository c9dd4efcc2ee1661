// docs/tutorial.md does what it says: its files are written, its commands run in their order, and what it shows of
// their output is there.
#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "test/support/scratch.hpp"
#include "test/support/shell.hpp"

namespace fathom {
namespace {

struct Block {
  std::string kind, name, text;  ///< "yaml", "my.yaml"; "sh"; "text"
};

std::vector<Block> blocks_of(const std::string& path) {
  std::vector<Block> blocks;
  std::ifstream file{path};
  bool inside = false;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("```")) {
      inside = !inside;
      if (!inside) continue;
      std::istringstream words{line.substr(3)};
      Block block;
      words >> block.kind >> block.name;
      blocks.push_back(block);
    } else if (inside) {
      blocks.back().text += line + "\n";
    }
  }
  return blocks;
}

/// Lines broken for a terminal are one text; blanks count once.
std::string flat(const std::string& text) {
  std::string all;
  std::istringstream words{text};
  for (std::string word; words >> word;) all += word + " ";
  return all;
}

/// Whether `output` has the line, "…" standing for anything.
bool shows(const std::string& output, const std::string& line) {
  const std::string text = flat(output), mark = "…";
  std::size_t from = 0;
  for (std::size_t at = 0; at <= line.size();) {
    const std::size_t end = std::min(line.find(mark, at), line.size());
    std::string part = flat(line.substr(at, end - at));
    if (!part.empty()) part.pop_back();
    const std::size_t found = text.find(part, from);
    if (found == std::string::npos) return false;
    from = found + part.size();
    at = end + mark.size();
  }
  return true;
}

}  // namespace

TEST_CASE("the tutorial does what it says") {
  const test::Scratch scratch;
  const std::string bin = std::string{FATHOM_BINARY_DIR} + "/bin";
  const std::string begin =
      "set -e; export PATH='" + bin + "':\"$PATH\" FATHOM='" + FATHOM_SOURCE_DIR + "'; cd '" + scratch.path("") + "'\n";
  std::string output;
  int commands = 0, shown = 0;
  for (const Block& block : blocks_of(std::string{FATHOM_SOURCE_DIR} + "/docs/tutorial.md")) {
    CAPTURE(block.text);
    if (block.kind == "yaml") {
      REQUIRE_FALSE(block.name.empty());
      test::write_bytes(scratch.path(block.name), block.text);
    } else if (block.kind == "sh") {
      const test::Ran ran = test::shell("(" + begin + block.text + ")");
      REQUIRE_MESSAGE(ran.code == 0, ran.text);
      output = ran.text;
      ++commands;
    } else if (block.kind == "text") {
      std::istringstream lines{block.text};
      for (std::string line; std::getline(lines, line); ++shown) CHECK_MESSAGE(shows(output, line), line, output);
    } else {
      FAIL_CHECK("a block of kind '" << block.kind << "' is neither run nor checked");
    }
  }
  CHECK(commands == 6);
  CHECK(shown == 18);
  CHECK_FALSE(shows("a b", "b … a"));  // the test itself
}

}  // namespace fathom
