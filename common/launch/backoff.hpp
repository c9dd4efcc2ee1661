// How long a program that ended by itself waits before it is started again.
#pragma once

namespace fathom::launch {

/// Ten milliseconds for what ran well; doubled, up to a second, while starts follow each other within a second; halved
/// for every whole second between two starts.
class Backoff {
 public:
  static constexpr double kLeast = 0.010, kMost = 1.0;  ///< s
  void started(double now);
  [[nodiscard]] double delay() const { return delay_; }

 private:
  double delay_{kLeast};
  double last_{-1e9};
};

}  // namespace fathom::launch
