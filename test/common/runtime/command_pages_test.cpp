// Manual pages and completion say what the command line takes, and nothing else.
#include "common/runtime/command_pages.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/version.hpp"
#include "common/runtime/command_line.hpp"
#include "test/support/scratch.hpp"

namespace fathom::runtime {
namespace {

struct Example {
  CommandLine app{"Weighs fish. More is in docs/fish.md; it's \\ and -1.", "fish"};
  CommandLine* weigh{app.add_subcommand("weigh", "the weight of one")};
  CommandLine* elsewhere{app.add_subcommand("paint", "run by another program")};
  std::string scale, file;
  std::vector<std::string> nets;
  double limit{};
  bool quiet{};

  Example() {
    weigh->add_option("-s,--scale", scale, "which scale")->one_of({"old", "new"});
    weigh->add_option("--net", nets, "where from")->required();
    weigh->add_option("--limit", limit, "kg");
    weigh->add_flag("--quiet", quiet, ".silent");
    weigh->add_option("fish", file, "the fish")->required();
    elsewhere->hand_on([](const std::vector<std::string>&) {});
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
  const std::string page = manual_page(example.weigh->cli(), "fish");
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
  const std::string page = manual_page(example.app.cli(), "fathom-fish");
  CHECK(has(page, "fathom\\-fish \\- Weighs fish\n"));
  CHECK(has(page, "it's \\e and \\-1."));
  CHECK(has(page, "\\fBfish\\-weigh\\fR(1)\nthe weight of one\n"));
  CHECK(has(page, "\\fBfish\\-paint\\fR(1)\n"));
}

TEST_CASE("completion: words that may follow, and which options take a value") {
  const Example example;
  CHECK(completion_table(example.app.cli(), "fathom-fish") == "_fathom_words['fathom-fish']='weigh paint -h --help'\n");
  CHECK(completion_table(example.weigh->cli(), "fish") ==
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
  CHECK_FALSE(example.app.parse(4, words.data()));
  CHECK(files_in(folder) == std::vector<std::string>{"fathom-fish.1", "fathom-fish.completion", "fish-weigh.1"});
  CHECK_THROWS_AS(write_pages(example.app.cli(), "fish", "/proc/no/such/folder"), InputError);
}

TEST_CASE("command line: numbers are finite, --version names program and build") {
  Example example;
  const std::vector<const char*> words{"fish", "weigh", "--net", "a", "--limit", "nan", "cod"};
  CHECK_THROWS_AS((void)example.app.parse(static_cast<int>(words.size()), words.data()), UsageError);
  CHECK(example.app.parse_or_tell(static_cast<int>(words.size()), words.data()) == 2);
  Example other;
  const std::vector<const char*> asked{"fish", "--version"};
  std::ostringstream answer;
  CHECK_FALSE(other.app.parse(2, asked.data(), answer));
  CHECK(answer.str() == "fish " + std::string{version()} + "\n");
}

TEST_CASE("command line: what a subcommand throws is bad input, what the words lack is a bad command line") {
  Example example;
  example.weigh->callback([] { throw InputError("no fish"); });
  const std::vector<const char*> good{"fish", "weigh", "--net", "a", "cod"}, bad{"fish", "weigh", "cod"},
      none{"fish", "wiegh"};
  CHECK(example.app.run(static_cast<int>(good.size()), good.data()) == 1);
  CHECK(Example{}.app.run(static_cast<int>(bad.size()), bad.data()) == 2);
  CHECK(Example{}.app.run(static_cast<int>(none.size()), none.data()) == 2);
}

TEST_CASE("command line: what is wrong with the words of a subcommand points to its own help") {
  Example example;
  const std::vector<const char*> words{"fish", "weigh", "cod"};
  CHECK(test::complaint_of<UsageError>([&] { (void)example.app.parse(3, words.data()); }) ==
        "--net is required; see fish weigh --help");
}

TEST_CASE("command line: words behind a command of another program go on unread") {
  Example example;
  std::vector<std::string> rest;
  example.elsewhere->hand_on([&](const std::vector<std::string>& words) { rest = words; });
  const std::vector<const char*> words{"fish", "paint", "--help", "-x", "red"};
  CHECK(example.app.run(static_cast<int>(words.size()), words.data()) == 0);
  CHECK(rest == std::vector<std::string>{"--help", "-x", "red"});
}

}  // namespace fathom::runtime
