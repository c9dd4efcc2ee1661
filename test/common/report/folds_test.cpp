// Leave-run-out validation: who is held out when, and what the folds came to together.
#include "common/report/folds.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "common/base/error.hpp"

namespace fathom::report {
namespace {

DiagnosisResult result(const std::string& run, double before, double after, bool wave) {
  DiagnosisResult one;
  one.validate = {run};
  one.verdict = wave ? "effect" : "adequate";
  if (wave) one.effects.push_back({.name = "wave"});
  const double none = std::nan("");
  one.error_before.prediction = {{.horizon_s = 1.0, .rmse = {9, 9, 9, 9, 9, 9}},
                                 {.horizon_s = 10.0, .rmse = {before, none, none, none, none, 2 * before}}};
  one.error_after.prediction = {{.horizon_s = 1.0, .rmse = {9, 9, 9, 9, 9, 9}},
                                {.horizon_s = 10.0, .rmse = {after, none, none, none, none, 2 * after}}};
  return one;
}

}  // namespace

TEST_CASE("folds: each recording is held out once, and never by a fold that fits it") {
  const std::vector<std::string> paths{"e", "a", "c", "b", "d"};
  for (const int count : {2, 3, 5, 9}) {
    CAPTURE(count);
    const auto folds = folds_of(paths, count);
    CHECK(folds.size() == static_cast<std::size_t>(std::min(count, 5)));
    std::vector<std::string> held;
    for (const Fold& fold : folds) {
      CHECK(fold.fitted.size() + fold.held_out.size() == paths.size());
      for (const std::string& one : fold.held_out) CHECK(std::ranges::find(fold.fitted, one) == fold.fitted.end());
      held.insert(held.end(), fold.held_out.begin(), fold.held_out.end());
    }
    std::ranges::sort(held);
    CHECK(held == std::vector<std::string>{"a", "b", "c", "d", "e"});
  }
  CHECK(folds_of({"b", "a", "c"}, 3)[0].held_out == std::vector<std::string>{"a"});
  CHECK_THROWS_AS((void)folds_of({"a"}, 2), InputError);
  CHECK_THROWS_AS((void)folds_of({"a", "a"}, 2), InputError);  // it would judge a fit of itself
}

TEST_CASE("folds: the table has a line per fold, the pooled error, and how often each effect was found") {
  const std::string text = fold_table({result("a", 0.3, 0.1, true), result("b", 0.4, 0.4, false)});
  CHECK(text.find("fold 1, held out a: effect (wave)") != std::string::npos);
  CHECK(text.find("fold 2, held out b: adequate (no effect)") != std::string::npos);
  CHECK(text.find("u 0.3000 -> 0.1000  r 0.6000 -> 0.2000") != std::string::npos);
  // Root of the mean square: sqrt((.09 + .16) / 2) and sqrt((.01 + .16) / 2).
  CHECK(text.find("all folds\n   u 0.3536 -> 0.2915  r 0.7071 -> 0.5831") != std::string::npos);
  CHECK(text.find("wave: found in 1 of 2") != std::string::npos);
}

}  // namespace fathom::report
