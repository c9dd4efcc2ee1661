// The report page opens alone, stays small, and survives data that lack something.
#include "common/report/page.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <set>

#include "common/base/error.hpp"
#include "common/base/version.hpp"
#include "common/report/live_plot.hpp"
#include "common/report/report.hpp"
#include "test/support/diagnosis_fixture.hpp"

using fathom::report::to_html;
using fathom::test::FixtureOptions;
using fathom::test::made_up_report;

namespace {

constexpr std::size_t kLargestPage = 3'000'000;  // bytes: mails and browsers still take it

bool has(const std::string& page, const std::string& words) { return page.find(words) != std::string::npos; }

std::size_t count(const std::string& page, const std::string& words) {
  std::size_t n = 0;
  for (std::size_t at = page.find(words); at != std::string::npos; at = page.find(words, at + 1)) ++n;
  return n;
}

// Values of id="..." and id='...'.
std::vector<std::string> ids(const std::string& page) {
  std::vector<std::string> found;
  for (std::size_t at = page.find(" id="); at != std::string::npos; at = page.find(" id=", at + 1)) {
    const char quote = page[at + 4];
    found.push_back(page.substr(at + 5, page.find(quote, at + 5) - at - 5));
  }
  return found;
}

const std::string& usual_page() {
  static const std::string page = to_html(made_up_report());
  return page;
}

}  // namespace

TEST_CASE("The page says which build wrote it") {
  CHECK(has(usual_page(), "Written by Fathom " + std::string{fathom::version()} + "."));
}

TEST_CASE("The page loads nothing from anywhere") {
  const std::string& page = usual_page();
  for (const char* word : {"http:", "https:", "src=", "<link", "@import", "<iframe", "<image", "url(http"}) {
    CAPTURE(word);
    CHECK_FALSE(has(page, word));
  }
  // The browser is told so before all else, and the only scripts are the two that came with this build.
  CHECK(page.find("content=\"default-src 'none'; style-src 'unsafe-inline'; script-src 'nonce-fathom'\"") <
        page.find("<title>"));
  CHECK(count(page, "<script") == 2);
  CHECK(has(page, fathom::report::live_script()));
}

TEST_CASE("The page's scripts carry their licence") {
  const std::string script = fathom::report::live_script();
  CHECK(has(script, "The MIT License (MIT)"));
  CHECK(has(script, "Leon Sorokin"));
  CHECK(count(script, "</script>") == 2);  // none ends early
}

TEST_CASE("Ids of all pictures on the page differ, and every reference has its target") {
  const auto all = ids(usual_page());
  const std::set<std::string> unique(all.begin(), all.end());
  CHECK(unique.size() == all.size());
  const std::string& page = usual_page();
  const std::string reference = "xlink:href='#";
  for (std::size_t at = page.find(reference); at != std::string::npos; at = page.find(reference, at + 1)) {
    const std::size_t begin = at + reference.size();
    REQUIRE(unique.contains(page.substr(begin, page.find('\'', begin) - begin)));
  }
}

TEST_CASE("The page escapes text that looks like markup") {
  auto report = made_up_report({.samples = 200});
  report.result.candidates[0].reason = "<script>alert('x')</script> & \"more\"";
  report.result.consistency[0].signal = "<b>gyro";
  report.traces[0].run =
      "run '<i>' \x02"
      "0\x03";
  const std::string page = to_html(report);
  CHECK_FALSE(has(page, "<script>"));
  CHECK(has(page, "&lt;script&gt;alert(&#39;x&#39;)&lt;/script&gt; &amp; &quot;more&quot;"));
  CHECK(has(page, "&lt;b&gt;gyro"));
  CHECK(has(page, "Why does Beluga &lt;test&gt; move"));
}

TEST_CASE("A long run makes a small page") { CHECK(to_html(made_up_report()).size() < kLargestPage); }

TEST_CASE("Many long runs still make a page of the allowed size") {
  auto report = made_up_report();
  for (unsigned seed = 1; seed < 8; ++seed) {
    report.traces.push_back(fathom::test::made_up_trace({}, "run-" + std::to_string(seed), seed));
  }
  CHECK(to_html(report).size() < kLargestPage);
}

TEST_CASE("The same diagnosis gives the same page, byte for byte") {
  const auto report = made_up_report({.samples = 500});
  CHECK(to_html(report) == to_html(report));
}

TEST_CASE("Only simulated axes are drawn") {
  const std::string page = to_html(made_up_report({.axes = {false, false, false, false, false, true}, .samples = 600}));
  CHECK(has(page, "yaw r [deg/s]"));
  CHECK_FALSE(has(page, "Measured and predicted surge"));
  CHECK(count(page, "Measured and predicted") == 1);
  CHECK_FALSE(has(page, "Leftover surge"));
}

TEST_CASE("What was not recorded is left out of the picture") {
  const std::string bare = to_html(made_up_report({.samples = 600, .position = false, .voltage = false}));
  CHECK_FALSE(has(bare, "battery voltage"));
  CHECK_FALSE(has(bare, "position north"));
  CHECK(has(bare, "heading [deg]"));
  CHECK(has(usual_page(), "battery voltage"));
  CHECK(has(usual_page(), "position north"));
}

TEST_CASE("A page without effects, candidates, findings or traces is whole") {
  fathom::DiagnosisReport report;
  report.result.vehicle = "empty";
  report.result.verdict = "adequate";
  const std::string page = to_html(report);
  CHECK(has(page, "The model is adequate"));
  CHECK(has(page, "No cause was tried."));
  CHECK(has(page, "Nothing is left open"));
  CHECK(has(page, "</html>"));
}

TEST_CASE("Where nothing was added no change is weighed against luck") {
  fathom::DiagnosisReport report = made_up_report({.samples = 0});
  CHECK(has(to_html(report), "With 95 % confidence"));
  report.result.effects.clear();
  const std::string page = to_html(report);
  CHECK_FALSE(has(page, "With 95 % confidence"));
  CHECK_FALSE(has(page, "luck"));
  CHECK(has(page, "nothing was added to the model"));
}

TEST_CASE("What could not be asked for want of measurements is said to be open") {
  fathom::DiagnosisReport report;
  report.result.verdict = "adequate";
  report.result.not_measured = {{"position", {"tether_drag"}, "Position was not measured: the tether <is> not known."},
                                {"velocity", {}}};
  const std::string page = to_html(report);
  CHECK(has(page, "<li>Position was not measured: the tether &lt;is&gt; not known.</li>"));
  CHECK_FALSE(has(page, "Nothing is left open"));
  CHECK_FALSE(has(page, "<li></li>"));
}

TEST_CASE("Too little data to judge on does not look like a model that is adequate") {
  fathom::DiagnosisReport report;
  report.result.verdict = "unjudged";
  const std::string page = to_html(report);
  CHECK(has(page, "These runs show too little to judge by"));
  CHECK_FALSE(has(page, "badge adequate"));
  CHECK_FALSE(has(page, "Nothing is left open"));
}

TEST_CASE("What is constant but for rounding is drawn too") {
  fathom::DiagnosisReport report = made_up_report({.samples = 600});
  for (auto& trace : report.traces) {
    for (std::size_t i = 0; i < trace.t.size(); ++i) {
      const double rounding = i % 2 == 0 ? 1e-16 : 0.0;
      for (auto* rows : {&trace.measured, &trace.before, &trace.after, &trace.tau}) (*rows)[i].fill(0.3 + rounding);
      for (auto* rows : {&trace.residual_before, &trace.residual_after}) (*rows)[i].fill(-14.67 + 40.0 * rounding);
      trace.heading[i] = 0.2 + rounding;
    }
  }
  CHECK(has(to_html(report), "</html>"));
}

TEST_CASE("What no known cause fits is called so") {
  fathom::DiagnosisReport report = made_up_report({.samples = 0});
  report.result.verdict = "unexplained";
  CHECK(has(to_html(report), "Something is missing, and none of the known causes fits"));
  report.result.correction = fathom::CorrectionGiven{.asked = true, .adopted = true};
  CHECK(has(to_html(report), "None of the known causes fits: what is missing was learned"));
}

TEST_CASE("Traces that are all gaps, constant or too short do not break the page") {
  auto report = made_up_report({.samples = 300});
  for (auto& row : report.traces[0].measured) row.fill(fathom::test::kAbsent);
  for (auto& row : report.traces[0].tau) row.fill(0.0);
  report.traces.push_back(fathom::test::made_up_trace({.samples = 1}, "one sample", 3));
  report.traces.push_back(fathom::test::made_up_trace({.samples = 0}, "no sample", 3));
  CHECK(has(to_html(report), "</html>"));
}

TEST_CASE("A missing gnuplot is said in one line with the remedy") {
  const auto report = made_up_report({.samples = 200});
  try {
    static_cast<void>(to_html(report, "no-such-gnuplot"));
    FAIL("no complaint");
  } catch (const fathom::InputError& error) {
    const std::string said = error.what();
    CHECK(said.find("no-such-gnuplot") != std::string::npos);
    CHECK(said.find("apt-get install gnuplot-nox") != std::string::npos);
    CHECK(said.find('\n') == std::string::npos);
  }
}

TEST_CASE("Both files are written, into a folder that did not exist") {
  const std::filesystem::path folder = std::filesystem::path(FATHOM_BINARY_DIR) / "test-report" / "beluga";
  std::filesystem::remove_all(folder);
  const auto written = fathom::report::write(made_up_report(), folder.string());
  CHECK(std::filesystem::file_size(written.json) > 1000);
  CHECK(std::filesystem::file_size(written.html) > 100'000);
}

TEST_CASE("A folder that cannot be made is refused by name") {
  CHECK_THROWS_AS(static_cast<void>(fathom::report::write({}, "/proc/no/such/folder")), fathom::InputError);
}
