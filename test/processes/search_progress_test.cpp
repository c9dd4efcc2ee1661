// The steps of a diagnosis as phases: what is announced is done at the end, and a round more is time more.
#include "processes/fathom/search_progress.hpp"

#include <doctest/doctest.h>

#include "common/base/remaining_time.hpp"

namespace fathom {
namespace {

struct Diagnosis {
  void step(const std::string& what, double seconds) {
    search(what, 0.5);
    now += seconds;
  }
  [[nodiscard]] double left() const { return remaining.left(now).value(); }

  double now{0.0};
  RemainingTime remaining;
  tool::SearchProgress search{Progress{[this](const Progress::Event& event) { remaining.take(now, event); }}};
};

}  // namespace

TEST_CASE("search progress: every step counts, and nothing is left at the end") {
  Diagnosis d;
  d.step("fitting the base model", 4.0);
  d.step("round 1: asking 61 candidates", 12.0);
  for (int i = 0; i < 6; ++i) d.step("fitting tether 2", 2.0);
  const double first = d.left();
  // Announced are another round and what ends the search, at what the steps have cost: 12 + 6 x 2 s, and weights of
  // 13 at 2 s; the fit that is as old as expected counts with a quarter of that.
  CHECK(first == doctest::Approx(12.0 + 6 * 2.0 + 13 * 2.0 + 0.5));
  d.step("asking again which form of current it is", 2.0);
  d.step("round 2: asking 61 candidates", 0.0);  // an effect was found: one round more than announced
  CHECK(d.left() > first + 10.0);
  d.step("fitting wall", 2.0);
  d.step("final fits", 8.0);
  CHECK(d.left() < first);
  d.step("testing tether on everything", 4.0);
  d.step("asking whether anything unlisted is at work", 4.0);
  d.step("intervals of what was found", 4.0);
  d.step("the last digits, from places and headings", 4.0);
  d.step("predicting the validation runs", 2.0);
  d.search.end();
  CHECK(d.left() == 0.0);
}

}  // namespace fathom
