// The message types: one per file, utime first, a unit or meaning behind every field, and each in docs/messages.md.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>

namespace {

std::string content(const std::filesystem::path& path) {
  std::ifstream file{path};
  return {std::istreambuf_iterator<char>{file}, {}};
}

}  // namespace

TEST_CASE("lcmtypes: every file holds the type it is named after, explained field by field and listed in the docs") {
  const std::filesystem::path root{FATHOM_SOURCE_DIR};
  const std::string docs = content(root / "docs" / "messages.md");
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator{root / "lcmtypes"}) {
    if (entry.path().extension() != ".lcm") continue;
    ++files;
    const std::string name = entry.path().stem().string();
    CAPTURE(name);
    const std::string text = content(entry.path());
    CHECK(text.starts_with("package fathom_lcm;\n"));
    CHECK(docs.find("`" + name + "`") != std::string::npos);
    const std::regex structs{"struct (\\w+) \\{"};
    CHECK(std::distance(std::sregex_iterator{text.begin(), text.end(), structs}, {}) == 1);
    CHECK(text.find("struct " + name + " {") != std::string::npos);
    const bool is_part = text.find("// Part of ") != std::string::npos;
    CHECK(is_part != (text.find(" {\n  int64_t utime; ") != std::string::npos));
    const std::regex bare{"  [a-z0-9_]+ \\w+(\\[\\w+\\])?; *\n"};
    CHECK_FALSE(std::regex_search(text, bare));
    const std::regex number_without_unit{"  double \\w+(\\[\\w+\\])?; *// [^\\[]"};
    CHECK_FALSE(std::regex_search(text, number_without_unit));
  }
  CHECK(files > 0);
}
