// Whose clock is off, or whose messages are long under way: every aid's stamps against those of the attitude sensor, by
// which STATE is told. Times are those of messages, in the order of their arrival.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>

#include "common/base/time.hpp"

namespace fathom::estimation {

class ClockCheck {
 public:
  static constexpr std::size_t kMost = 16;  ///< channels
  /// A sample of a channel came when the newest attitude was `age` s younger than it (< 0: older). `late`: the age that
  /// is stated for the channel at most; `gap`: what the attitude sensor may lag by itself.
  void hear(std::size_t channel, Utime utime, double age, double late, double gap);
  /// One line when the attitude sensor disagrees with all others, else empty.
  [[nodiscard]] std::string attitude() const;
  /// One line on that channel when it disagrees now, however briefly; for one that is missed already.
  [[nodiscard]] std::string off(std::size_t channel, const char* name) const;
  /// One line on the channel that disagrees most; empty when none does by more than its `tolerated` [s], or by half a
  /// second where that is less. `names`: of the channels, in their order.
  [[nodiscard]] std::string odd_one(std::span<const char* const> names, std::span<const double> tolerated = {}) const;

 private:
  static constexpr double kLasts = 2.0;      // s: shorter, and a busy machine was it
  static constexpr double kForgotten = 5.0;  // s: who is silent has no part in the comparison
  static constexpr double kOneOff = 0.5;     // s: STATE goes on without it, and is corrected later
  static constexpr double kAllLate = 0.2;    // s: that all are late at once is hardly their doing
  struct Channel {
    std::optional<Utime> last, late_since, ahead_since;
    double age{}, stated{}, gap{};  // s, of the last sample
    [[nodiscard]] double late() const { return age - stated; }
  };
  [[nodiscard]] bool heard(const Channel& one) const;
  [[nodiscard]] bool explained_by(double behind) const;
  [[nodiscard]] bool lasts(const std::optional<Utime>& since, const Channel& channel) const;

  std::array<Channel, kMost> channels_{};
  Utime newest_{};
};

}  // namespace fathom::estimation
