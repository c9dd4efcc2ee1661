// Which times are believed. A stamp is judged by its neighbours: the one believed before it and the median of the few
// behind it. So one wrong stamp moves nothing, a gap is a gap, and a clock that starts again begins a new recording.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "common/recordings/topic.hpp"

namespace fathom::recordings {

/// How a format's own clock behaves.
struct ClockRules {
  std::int64_t ahead{10'000'000};    ///< us that a stamp may stand before and behind its neighbours: slow writers
  std::int64_t back{3'600'000'000};  ///< us back that are no new start: little where a clock counts from power-on
  std::int64_t leap{3'600'000'000};  ///< us of silence after which it is another recording
};

/// One message on its way: held back until its stamp is judged.
struct Judged {
  std::size_t topic{};
  Stamp stamp{};
  std::vector<double> values;
};

class StampGuard {
 public:
  /// `believed` gets the message and the number of the recording, which rises with each new start; `refused` the
  /// others.
  using Believed = std::function<void(const Judged&, std::size_t recording)>;
  using Refused = std::function<void(const Judged&)>;
  StampGuard(ClockRules rules, Believed believed, Refused refused);

  void push(std::size_t topic, Stamp stamp, std::span<const double> values);
  void finish();

 private:
  static constexpr std::size_t kBehind = 8;  // stamps behind the one in question: five wrong ones in a row are believed
  static constexpr std::int64_t kSteps = 4;  // a step this many times the latest is still one of a slow recording
  static constexpr std::size_t kEnough = 3;  // stamps behind the first of all, to judge it by
  struct Behind {
    std::int64_t median{};
    std::int64_t spread{};  ///< from the lower quarter to the median
    std::size_t count{};
  };
  void judge();
  [[nodiscard]] bool believe(std::int64_t stamp);
  [[nodiscard]] Behind behind() const;

  ClockRules rules_;
  Believed believed_;
  Refused refused_;
  std::array<Judged, kBehind + 1> ring_;
  std::size_t first_{};
  std::size_t held_{};
  std::int64_t last_{kNoTime};    ///< the greatest so far
  std::int64_t latest_{kNoTime};  ///< the one before
  std::int64_t step_{};           ///< the latest forward, fading: how far apart messages are
  std::size_t recording_{};
};

}  // namespace fathom::recordings
