// What the search for effects says of itself, in phases and units for whoever tells the time that is left. The search
// names its steps in words alone: each begins with what kind of step it is.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "common/base/progress.hpp"

namespace fathom::tool {

class SearchProgress {
 public:
  explicit SearchProgress(Progress progress) : progress_{std::move(progress)} {}

  /// A step begins; the one before is done. The search's own share of the work is not used.
  void operator()(const std::string& what, double /*share*/) {
    finish();
    const Kind& kind = kind_of(what);
    if (&kind == &kKinds.front()) {  // a search begins
      for (const Kind& each : kKinds) progress_.expect(each.phase, each.usual, each.weight);
    } else if (kind.of_round && what.starts_with("round")) {  // this one, and one that finds nothing more
      for (const Kind& each : kKinds) {
        if (each.of_round) progress_.expect(each.phase, each.usual, each.weight);
      }
    } else if (kind.phase == kEverything) {
      for (const Kind& each : kKinds) {
        if (each.of_round) progress_.expect(each.phase, 0.0);
      }
    }
    running_ = kind.phase;
    progress_.begin(running_, what);
  }
  /// The last step is done, and none is to come.
  void end() {
    finish();
    for (const Kind& each : kKinds) progress_.expect(each.phase, 0.0);
  }

 private:
  struct Kind {
    std::string_view begins;  // the words
    std::string_view phase;
    double usual;   // steps that are expected of it
    double weight;  // guessed cost of one, until it has been timed
    bool of_round;  // comes again in every round
  };
  static constexpr std::string_view kEverything = "everything";
  static constexpr std::array kKinds{
      Kind{"fitting the base model", "base model", 1, 2, false},
      Kind{"round", "questions", 2, 6, true},
      Kind{"fitting", "fits", 12, 1, true},
      Kind{"asking again", "forms", 0, 2, true},
      Kind{"asking where", "orders", 0, 1, true},
      Kind{"looking further", "afar", 0, 2, true},
      Kind{"final fits", kEverything, 1, 4, false},
      Kind{"testing", "tests", 1, 2, false},
      Kind{"asking whether anything", "unlisted", 1, 2, false},
      Kind{"intervals", "intervals", 1, 2, false},
      Kind{"the last digits", "poses", 1, 2, false},
      Kind{"predicting", "prediction", 1, 1, false},
      Kind{"", "others", 0, 1, false},
  };
  static const Kind& kind_of(std::string_view what) {
    for (const Kind& each : kKinds) {
      if (what.starts_with(each.begins)) return each;
    }
    return kKinds.back();
  }
  void finish() {
    if (!running_.empty()) progress_.done(running_);
    running_ = {};
  }

  Progress progress_;
  std::string_view running_{};
};

}  // namespace fathom::tool
