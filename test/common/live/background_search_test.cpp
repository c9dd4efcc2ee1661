// A search beside the trial: its answer, its end before it has one, and what it throws.
#include "common/live/background_search.hpp"

#include <doctest/doctest.h>

#include <atomic>
#include <stdexcept>

namespace fathom::live {
namespace {

using Priority = BackgroundSearch::Priority;

const auto kAlways = [] { return true; };

}  // namespace

TEST_CASE("background search: its answer is waited for, below the caller's priority or not") {
  for (const Priority priority : {Priority::kAsCaller, Priority::kBelow}) {
    BackgroundSearch search{[](const Progress& progress) {
                              progress.begin("one", "one");
                              return Found{.ranking = {.verdict = "adequate"}, .rivals = {}, .notes = {"a"}};
                            },
                            priority};
    const std::optional<Found> found = search.wait(kAlways);
    REQUIRE(found);
    CHECK(found->ranking.verdict == "adequate");
    CHECK(found->notes == std::vector<std::string>{"a"});
  }
}

TEST_CASE("background search: one that nobody wants any more ends where it next tells of itself") {
  std::atomic<bool> begun{false}, ended{false};
  {
    BackgroundSearch search{[&](const Progress& progress) {
                              struct AtEnd {
                                std::atomic<bool>& ended;
                                ~AtEnd() { ended = true; }
                              } at_end{ended};
                              for (;;) {
                                begun = true;
                                progress.done("for ever");
                              }
                              return Found{};
                            },
                            Priority::kAsCaller};
    while (!begun) std::this_thread::yield();
    CHECK_FALSE(search.ready());
    int asked = 0;
    CHECK_FALSE(search.wait([&] { return ++asked < 3; }));
    CHECK(asked == 3);
    CHECK_FALSE(ended);
  }
  CHECK(ended);
}

TEST_CASE("background search: what it throws is thrown to who waits for it") {
  BackgroundSearch search{[](const Progress&) -> Found { throw std::runtime_error{"no"}; }, Priority::kAsCaller};
  CHECK_THROWS_WITH_AS(static_cast<void>(search.wait(kAlways)), "no", std::runtime_error);
}

}  // namespace fathom::live
