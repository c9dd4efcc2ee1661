// Figures 1.4 and 1.5: which filters are drawn, with which gains.
#include "common/report/filter_figures.hpp"

#include <doctest/doctest.h>

#include <algorithm>

using namespace fathom;
using namespace fathom::report;

namespace {

/// With one gap, which the median does not see.
estimation::Seen seen_at(double interval, int count = 100) {
  estimation::Seen seen;
  for (int i = 0; i < count; ++i) seen.t.push_back(interval * i + (i > count / 2 ? 5.0 : 0.0));
  seen.x.resize(seen.t.size());
  return seen;
}

estimation::NavigatorSettings settings() {
  estimation::NavigatorSettings s;
  s.tags = {.used = true, .cutoff = 4.0};
  s.flow = {.used = true, .cutoff = 4.0, .damping = 3.0};
  s.dvl = {.used = true, .cutoff = 2.0, .damping = 1.0};
  return s;
}

}  // namespace

TEST_CASE("filters drawn: gains at the interval that was, the paper's beside them, and no aid that said nothing") {
  estimation::AidsSeen seen;
  seen.tags = seen_at(1.0 / 30.0);
  seen.flow = seen_at(1.0 / 15.0);  // half the rate that was meant
  const auto filters = filters_of(settings(), seen);
  REQUIRE(filters.size() == 4);  // no velocity log: it is used, and was not heard
  CHECK(filters[0].gains.value == doctest::Approx(estimation::first_order_gains(4.0, 1.0 / 30.0).value));
  CHECK(!filters[0].second_order);
  CHECK(filters[1].published);
  CHECK(filters[1].gains.value == 0.09);
  CHECK(filters[2].gains.rate == doctest::Approx(estimation::second_order_gains(4.0, 3.0, 1.0 / 15.0).rate));
  CHECK(filters[2].interval == doctest::Approx(1.0 / 15.0));
  CHECK(filters[3].gains.rate == 0.2);
  auto published = settings();
  published.published_gains = true;
  const auto papers = filters_of(published, seen);
  REQUIRE(papers.size() == 2);
  CHECK(std::ranges::all_of(papers, &DrawnFilter::published));
}

TEST_CASE("filters drawn: both parts are pictures that gnuplot takes") {
  estimation::AidsSeen seen;
  seen.flow = seen_at(1.0 / 30.0);
  const auto filters = filters_of(settings(), seen);
  for (const BodePart part : {BodePart::kMagnitude, BodePart::kPhase}) {
    const std::string svg = render({draw_bode(filters, part)}, "gnuplot").front();
    CHECK(svg.find("frequency [Hz]") != std::string::npos);
    CHECK(svg.find("rgb( 10,  94, 168)") != std::string::npos);  // computed gains
    CHECK(svg.find("rgb(224, 123,   0)") != std::string::npos);  // published ones
  }
}
