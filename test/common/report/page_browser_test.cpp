// The report page in a real browser, where one is installed: its plots come to life, nothing complains, and it prints
// on few pages.
#include <doctest/doctest.h>

#include "common/report/page.hpp"
#include "test/support/diagnosis_fixture.hpp"
#include "test/support/scratch.hpp"
#include "test/support/shell.hpp"

namespace fathom {
namespace {

constexpr int kMostPages = 8;  // A4, with every section unfolded

int count(const std::string& text, const std::string& words) {
  int n = 0;
  for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1)) ++n;
  return n;
}

}  // namespace

TEST_CASE("The report in a browser: plots come to life, and it prints on few pages" *
          doctest::test_suite("processes")) {
  if (test::shell("command -v chromium").code != 0) {
    MESSAGE("skipped: chromium is not installed");
    return;
  }
  const test::Scratch scratch;
  std::string page = report::to_html(test::made_up_report());
  test::write_bytes(scratch.path("report.html"), page);
  const std::string folded = "<details class=\"section\">", open = "<details class=\"section\" open>";
  for (std::size_t at = page.find(folded); at != std::string::npos; at = page.find(folded, at + 1))
    page.replace(at, folded.size(), open);
  test::write_bytes(scratch.path("open.html"), page);
  const std::string browser =
      "timeout 120 chromium --headless --no-sandbox --disable-gpu --enable-logging=stderr "
      "--window-size=1200,1400 --virtual-time-budget=5000 --user-data-dir='" +
      scratch.path("browser") + "' ";

  const test::Ran seen = test::shell(browser + "--dump-dom 'file://" + scratch.path("report.html") + "' 2>&1");
  REQUIRE_MESSAGE(seen.code == 0, seen.text);
  CHECK(seen.says("class=\"plot on\""));
  CHECK(seen.says("<canvas"));
  CHECK_FALSE(seen.says("CONSOLE"));  // neither errors nor what the policy forbids

  const std::string paper = scratch.path("paper.pdf");
  const test::Ran printed =
      test::shell(browser + "--print-to-pdf='" + paper + "' 'file://" + scratch.path("open.html") + "'");
  REQUIRE_MESSAGE(printed.code == 0, printed.text);
  const std::string pdf = test::read_bytes(paper);
  const int pages = count(pdf, "/Type /Page\n") + count(pdf, "/Type /Page ");
  CHECK(pages >= 2);
  CHECK(pages <= kMostPages);
}

}  // namespace fathom
