// Stamps of pictures that bring none: as they arrive, or by the clock of a camera whose rate is stated.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include "common/pictures/camera_clock.hpp"

namespace fathom::camera_driver {

class ArrivalStamps {
 public:
  explicit ArrivalStamps(std::optional<double> rate) : rate_{rate} {
    if (rate) clock_.emplace(*rate);
  }

  /// Nothing for a picture that shall be left out.
  std::optional<Utime> step(Utime arrival) {
    if (!clock_) return arrival;
    const auto stamp = clock_->step(arrival);
    left_out_ += stamp ? 0 : 1;
    return stamp;
  }
  /// A line for the operator, once; else empty.
  std::string news() {
    if (said_ || !clock_ || clock_->steady()) return {};
    said_ = true;
    return ": pictures do not come at 'rate', " + std::to_string(*rate_).substr(0, 5) +
           " Hz, or too irregularly to tell: meanwhile they are stamped as they come";
  }
  /// For HEALTH.
  [[nodiscard]] std::string detail() const {
    if (!clock_) return {};
    std::string text = clock_->steady() ? ", the last one " + std::to_string(std::lround(1e3 * clock_->delay())) +
                                              " ms later than the least delayed"
                                        : ", rate not kept";
    if (left_out_ > 0) text += ", too late " + std::to_string(left_out_);
    return text;
  }

 private:
  std::optional<double> rate_;
  std::optional<pictures::CameraClock> clock_;
  bool said_{false};
  std::int64_t left_out_{};
};

}  // namespace fathom::camera_driver
