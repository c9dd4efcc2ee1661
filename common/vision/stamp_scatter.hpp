// By how much the stamps of a camera's pictures err, as their intervals show: a camera exposes at a steady rate, and
// who stamps what arrives adds the delays of transport and host. Flow divides by an interval.
#pragma once

#include <deque>
#include <vector>

#include "common/base/time.hpp"

namespace fathom::vision {

class StampScatter {
 public:
  void step(Utime utime);
  void reset() { stamps_.clear(); }
  /// s, standard deviation of a stamp; 0 while too few are known.
  [[nodiscard]] double sigma() const { return sigma_; }
  [[nodiscard]] double interval() const { return interval_; }  ///< s, the usual one

 private:
  std::deque<Utime> stamps_;
  std::vector<double> sorted_;
  double sigma_{}, interval_{};
};

}  // namespace fathom::vision
