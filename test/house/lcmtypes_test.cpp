// The message types: one per file, utime first, a unit or meaning behind every field, and each in docs/messages.md.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
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
    CHECK(text.find("struct " + name + " {") != std::string::npos);
    CHECK(text.find("struct ") == text.rfind("struct "));
    const bool is_part = text.find("// Part of ") != std::string::npos;
    CHECK(is_part != (text.find(" {\n  int64_t utime; ") != std::string::npos));
    std::istringstream lines{text};
    for (std::string line; std::getline(lines, line);) {
      if (!line.starts_with("  ")) continue;  // fields are indented
      CAPTURE(line);
      const auto comment = line.find("// ");
      CHECK(comment != std::string::npos);
      if (line.starts_with("  double ")) CHECK(line.substr(comment).starts_with("// ["));  // its unit
    }
  }
  CHECK(files > 0);
}
