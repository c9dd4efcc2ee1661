// main() of every test executable: doctest's own, and two options for ctest, which has an entry for every case.
//   --list-for-ctest FILE   writes a line `fathom_case(NAME SUITE FILE)` per case, read by cmake/ctest_case.cmake
//   --exactly NAME          runs this one case; in a filter of doctest commas and stars have a meaning of their own
// A run in which no case took part, or with --exactly not one alone, has failed: it would have shown nothing. A case
// that says "skipped: ..." and asserts nothing ends with the code that ctest counts as skipped.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <cstdio>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>

#include "test/support/ctest_names.hpp"

namespace {

constexpr int kSkipped = 77;  // SKIP_RETURN_CODE of cmake/ctest_case.cmake

unsigned cases_run = 0;
bool skipped = false;
const char* list_file = nullptr;
bool listed = false;

/// Notes how many cases are run, and whether what was run said that it cannot be.
struct Counter : doctest::IReporter {
  explicit Counter(const doctest::ContextOptions& /*options*/) {}
  void report_query(const doctest::QueryData& /*query*/) override {}
  void test_run_start() override {}
  void test_run_end(const doctest::TestRunStats& stats) override { skipped = said_so_ && stats.numAsserts == 0; }
  void test_case_start(const doctest::TestCaseData& /*one*/) override { ++cases_run; }
  void test_case_reenter(const doctest::TestCaseData& /*one*/) override {}
  void test_case_end(const doctest::CurrentTestCaseStats& /*stats*/) override {}
  void test_case_exception(const doctest::TestCaseException& /*exception*/) override {}
  void subcase_start(const doctest::SubcaseSignature& /*subcase*/) override {}
  void subcase_end() override {}
  void log_assert(const doctest::AssertData& /*data*/) override {}
  void log_message(const doctest::MessageData& message) override {
    said_so_ = said_so_ || std::string_view{message.m_string.c_str()}.starts_with("skipped: ");
  }
  void test_case_skipped(const doctest::TestCaseData& /*one*/) override {}

 private:
  bool said_so_{false};
};

/// Writes the list for ctest. Cases that are skipped without --no-skip are not in it.
struct ListForCtest : Counter {
  using Counter::Counter;
  void report_query(const doctest::QueryData& query) override {
    using fathom::test::cmake_literal;
    std::set<std::string> seen;
    std::string text;
    for (unsigned i = 0; i < query.num_data; ++i) {
      const doctest::TestCaseData& one = *query.data[i];
      if (!fathom::test::can_be_an_entry(one.m_name)) return complain(one, "its name must be one line of text");
      if (!seen.insert(one.m_name).second) return complain(one, "another case has the same name; rename one of them");
      const std::string file = std::filesystem::path{one.m_file.c_str()}.stem().string();
      text += "fathom_case(" + cmake_literal(one.m_name) + " " + cmake_literal(one.m_test_suite) + " " +
              cmake_literal(file) + ")\n";
    }
    std::FILE* file = std::fopen(list_file, "w");
    listed = file != nullptr && std::fputs(text.c_str(), file) >= 0;
    listed = file != nullptr && std::fclose(file) == 0 && listed;
    if (!listed) std::fprintf(stderr, "%s: cannot be written\n", list_file);
  }
  static void complain(const doctest::TestCaseData& one, const char* what) {
    std::fprintf(stderr, "%s:%u: test case \"%s\": %s\n", one.m_file.c_str(), one.m_line, one.m_name, what);
  }
};

REGISTER_LISTENER("counter", 1, Counter);
REGISTER_REPORTER("list_for_ctest", 1, ListForCtest);

}  // namespace

int main(int argc, char** argv) {
  doctest::Context context{argc, argv};
  bool alone = false;
  for (int i = 1; i + 1 < argc; ++i) {
    const std::string_view word = argv[i];
    if (word == "--list-for-ctest") {
      list_file = argv[i + 1];
      const char* options[] = {argv[0], "--list-test-cases", "--reporters=list_for_ctest"};
      context.applyCommandLine(3, options);
    } else if (word == "--exactly") {
      alone = true;
      context.setOption("test-case", fathom::test::doctest_filter(argv[i + 1]).c_str());
      context.setOption("case-sensitive", true);
    }
  }
  const int result = context.run();
  if (list_file != nullptr) return listed ? 0 : 1;
  if (context.shouldExit()) return result;
  if (cases_run == 0 || (alone && cases_run != 1)) {
    std::fprintf(stderr, "%s: %u test cases are meant by these words\n", argv[0], cases_run);
    return 1;
  }
  return result == 0 && alone && skipped ? kSkipped : result;
}
