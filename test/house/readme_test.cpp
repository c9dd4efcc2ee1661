// README tells the truth: its first two lines, and the effects that it lists.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace fathom {
namespace {

std::string content(const std::string& path) {
  std::ifstream file{std::string{FATHOM_SOURCE_DIR} + "/" + path};
  return {std::istreambuf_iterator<char>{file}, {}};
}

/// Of the effect, from the folder of its family.
std::string source_of(const std::string& effect) {
  const std::string folder = std::string{FATHOM_SOURCE_DIR} + "/common/model/effects";
  for (const auto& family : std::filesystem::directory_iterator{folder}) {
    const std::string path = family.path().filename().string() + "/" + effect + ".cpp";
    if (std::filesystem::exists(folder + "/" + path)) return content("common/model/effects/" + path);
  }
  return "";
}

}  // namespace

TEST_CASE("README: begins with the two commands") {
  const std::string readme = content("README.md");
  CHECK(readme.starts_with("`./trial`"));
  CHECK(readme.substr(readme.find('\n') + 1).starts_with("`./check`"));
}

TEST_CASE("README: lists every registered effect with its own sentence, in order, and no other") {
  const std::string registry = content("common/model/effects/effects.def"), readme = content("README.md");
  std::string expected = "<!-- effects: checked against common/model/effects/effects.def -->\n";
  const std::string opening = "\nEFFECT(";
  for (auto at = registry.find(opening); at != std::string::npos; at = registry.find(opening, at + 1)) {
    const auto begin = at + opening.size();
    const std::string name = registry.substr(begin, registry.find(')', begin) - begin);
    const std::string source = source_of(name);
    const auto quote = source.find('"', source.find(".sentence = "));
    expected += "- `" + name + "`: " + source.substr(quote + 1, source.find('"', quote + 1) - quote - 1) + "\n";
  }
  CHECK(readme.find(expected + "<!-- end of effects -->") != std::string::npos);
}

}  // namespace fathom
