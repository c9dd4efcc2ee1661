#include "common/estimation/shared_clock.hpp"

#include <algorithm>
#include <vector>

#include "common/estimation/run_signals.hpp"

namespace fathom::estimation {

bool share_clock(std::span<const Recording> recordings, std::span<Trial> trials) {
  struct Span {
    double begin, end;  // s
    Utime origin;
    Trial* trial;
  };
  std::vector<Span> spans;
  Utime first{};
  for (std::size_t i = 0; i < recordings.size() && i < trials.size(); ++i) {
    if (trials[i].size() == 0) continue;
    const Utime origin = first_stamp(recordings[i]);
    first = spans.empty() ? origin : std::min(first, origin);
    spans.push_back({0.0, 0.0, origin, &trials[i]});
  }
  for (Span& span : spans) {
    const double offset = seconds_between(first, span.origin);
    span.begin = offset + span.trial->t.front();
    span.end = offset + span.trial->t.back();
  }
  std::ranges::sort(spans, {}, &Span::begin);
  for (std::size_t i = 1; i < spans.size(); ++i) {
    const double pause = spans[i].begin - spans[i - 1].end;
    if (pause < 0.0 || pause > kSessionPause) return false;
  }
  if (spans.size() < 2) return false;
  for (const Span& span : spans) {
    const double offset = seconds_between(first, span.origin);
    for (double& t : span.trial->t) t += offset;
  }
  return true;
}

}  // namespace fathom::estimation
