// Is the instrument well? Counts what comes and says in one line what an operator should do when it is not.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/base/time.hpp"
#include "common/devices/parser.hpp"

namespace fathom::driver {

/// Pure: times are passed in, in seconds of any steady clock.
class Watch {
 public:
  /// `period` [s] between samples, as configured; `protocol` for what is said.
  Watch(double period, std::string protocol) : period_{period}, protocol_{std::move(protocol)} {}

  void link(bool up, const std::string& why, double now);
  void bytes(std::size_t count, double now);
  void frame(double now);
  /// A sample with its utime; counts gaps.
  void sample(Utime utime, double now);

  /// Why the instrument is not well; empty when it is. A line that came up again is believed with its first
  /// measurement. `failure` and `complaint` are those of dialogue and parser.
  [[nodiscard]] std::string unhealthy(double now, const std::string& failure, const std::string& complaint) const;
  /// Nothing comes at all, or nothing that can be read.
  [[nodiscard]] bool silent(double now) const { return !up_ || now - last_frame_ > patience(); }
  [[nodiscard]] std::uint64_t gaps() const { return gaps_; }
  /// s since the newest sample, or since the line came up.
  [[nodiscard]] double since_sample(double now) const { return now - last_sample_; }
  /// Longest silence that is not said yet [s].
  [[nodiscard]] double patience() const;

 private:
  double period_;
  std::string protocol_;
  bool up_{false}, well_{false};  ///< well: a measurement has come since the line came up
  static constexpr const char* kNotYet = "the line is not open yet";
  std::string why_{kNotYet};
  double up_since_{}, last_bytes_{}, last_frame_{}, last_sample_{};
  std::uint64_t bytes_since_frame_{};
  std::optional<Utime> last_utime_;
  std::uint64_t gaps_{};
};

}  // namespace fathom::driver
