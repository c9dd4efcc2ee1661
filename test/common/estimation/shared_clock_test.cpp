// Files that follow one another share a clock; files that overlap or lie far apart keep their own.
#include "common/estimation/shared_clock.hpp"

#include <doctest/doctest.h>

using namespace fathom;
using fathom::estimation::share_clock;

namespace {

struct File {
  Recording recording;
  Trial trial;
};

/// A file of ten seconds whose first stamp is at `begin` [s].
File file(double begin) {
  File made;
  for (int k = 0; k <= 100; ++k) {
    PoseCapture sample;
    sample.utime = static_cast<Utime>((begin + 0.1 * k) * 1e6);
    made.recording.pose_capture.push_back(sample);
    made.trial.t.push_back(0.1 * k);
  }
  return made;
}

struct Files {
  explicit Files(std::initializer_list<double> begins) {
    for (const double begin : begins) {
      File made = file(begin);
      recordings.push_back(std::move(made.recording));
      trials.push_back(std::move(made.trial));
    }
  }
  std::vector<Recording> recordings;
  std::vector<Trial> trials;
};

}  // namespace

TEST_CASE("shared clock: files of one session count from its beginning, in whatever order they are given") {
  Files files{1050.0, 1000.0};
  CHECK(share_clock(files.recordings, files.trials));
  CHECK(files.trials[0].t.front() == doctest::Approx(50.0));
  CHECK(files.trials[1].t.front() == doctest::Approx(0.0));
}

TEST_CASE("shared clock: files that each begin at zero keep their own") {
  Files files{0.0, 0.0};
  CHECK_FALSE(share_clock(files.recordings, files.trials));
  CHECK(files.trials[1].t.front() == 0.0);
}

TEST_CASE("shared clock: another day is another clock, and one file needs none") {
  Files days{0.0, 86400.0}, one{500.0};
  CHECK_FALSE(share_clock(days.recordings, days.trials));
  CHECK_FALSE(share_clock(one.recordings, one.trials));
  CHECK(days.trials[1].t.front() == 0.0);
}
