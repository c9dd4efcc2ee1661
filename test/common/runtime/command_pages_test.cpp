// Manual pages and completion say what the command line takes, and nothing else.
#include "common/runtime/command_pages.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/version.hpp"
#include "common/runtime/command_line.hpp"
#include "test/support/scratch.hpp"

namespace fathom::runtime {
namespace {

struct Example {
  CLI::App app{"Weighs fish. More is in docs/fish.md; it's \\ and -1.", "fish"};
  CLI::App* weigh{app.add_subcommand("weigh", "the weight of one")};
  CLI::App* elsewhere{app.add_subcommand("paint", "run by another program")};
  std::string scale, file;
  std::vector<std::string> nets;
  double limit{};
  bool quiet{};

  Example() {
    weigh->add_option("-s,--scale", scale, "which scale")->check(CLI::IsMember({"old", "new"}));
    weigh->add_option("--net", nets, "where from")->required();
    weigh->add_option("--limit", limit, "kg");
    weigh->add_flag("--quiet", quiet, ".silent");
    weigh->add_option("fish", file, "the fish")->required();
    elsewhere->prefix_command();
  }
};

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::vector<std::string> files_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator{folder})
    names.push_back(entry.path().filename().string());
  std::ranges::sort(names);
  return names;
}

}  // namespace

TEST_CASE("manual page: of a subcommand, with what must be there, what may, values and choices") {
  const Example example;
  const std::string page = manual_page(*example.weigh, "fish");
  CHECK(has(page, ".TH \"FISH-WEIGH\" 1 \"\" \"Fathom " + std::string{version()}));
  CHECK(has(page, ".SH NAME\nfish\\-weigh \\- the weight of one\n"));
  CHECK(has(page, "\\fBfish weigh\\fR \\fB\\-\\-net\\fR \\fITEXT...\\fR [\\fIOPTION\\fR]... \\fIfish\\fR\n"));
  CHECK(has(page, ".TP\n\\fB\\-s\\fR, \\fB\\-\\-scale\\fR \\fIold|new\\fR\nwhich scale\n"));
  CHECK(has(page, ".TP\n\\fB\\-\\-limit\\fR \\fIFLOAT\\fR\nkg\n"));
  CHECK(has(page, ".TP\n\\fB\\-\\-quiet\\fR\n\\&.silent\n"));  // no value; a dot that begins a line is no macro
  CHECK(has(page, "where from; required\n"));
}

TEST_CASE("manual page: of a program, with its commands; signs of troff stand for themselves") {
  const Example example;
  const std::string page = manual_page(example.app, "fathom-fish");
  CHECK(has(page, "fathom\\-fish \\- Weighs fish\n"));
  CHECK(has(page, "it's \\e and \\-1."));
  CHECK(has(page, "\\fBfish\\-weigh\\fR(1)\nthe weight of one\n"));
  CHECK(has(page, "\\fBfish\\-paint\\fR(1)\n"));
}

TEST_CASE("completion: words that may follow, and which options take a value") {
  const Example example;
  CHECK(completion_table(example.app, "fathom-fish") == "_fathom_words['fathom-fish']='weigh paint -h --help'\n");
  CHECK(completion_table(*example.weigh, "fish") ==
        "_fathom_words['fish weigh']='-h --help -s --scale --net --limit --quiet'\n"
        "_fathom_values['fish weigh -s']='old new'\n"
        "_fathom_values['fish weigh --scale']='old new'\n"
        "_fathom_values['fish weigh --net']=''\n"
        "_fathom_values['fish weigh --limit']=''\n");
}

TEST_CASE("pages: written by the command line itself, except those of another program's subcommands") {
  Example example;
  const test::Scratch scratch;
  const std::string folder = scratch.path("pages");
  const std::vector<const char*> words{"fish", "--pages", folder.c_str(), "fathom-fish"};
  CHECK_THROWS_AS(parse(example.app, 4, words.data()), CLI::Success);
  CHECK(files_in(folder) == std::vector<std::string>{"fathom-fish.1", "fathom-fish.completion", "fish-weigh.1"});
  CHECK_THROWS_AS(write_pages(example.app, "fish", "/proc/no/such/folder"), InputError);
}

TEST_CASE("command line: numbers are finite, --version names program and build") {
  Example example;
  const std::vector<const char*> words{"fish", "weigh", "--net", "a", "--limit", "nan", "cod"};
  CHECK_THROWS_AS(parse(example.app, static_cast<int>(words.size()), words.data()), CLI::ValidationError);
  Example other;
  const std::vector<const char*> asked{"fish", "--version"};
  try {
    parse(other.app, 2, asked.data());
    FAIL("went on");
  } catch (const CLI::CallForVersion& answer) {
    CHECK(answer.what() == "fish " + std::string{version()});
  }
}

}  // namespace fathom::runtime
