// How much of the way to a steady value is gone in a step.
#pragma once

#include <cmath>

namespace fathom::model {

/// 1 - exp(-dt / time constant), and 1 where there is none. A rollout asks the same at every step: it is worked out
/// anew when one of the two has changed.
class DecayShare {
 public:
  double operator()(double dt, double time_constant) {
    if (dt != dt_ || time_constant != time_constant_) {
      dt_ = dt;
      time_constant_ = time_constant;
      share_ = time_constant > 0.0 ? -std::expm1(-dt / time_constant) : 1.0;
    }
    return share_;
  }

 private:
  double dt_{}, time_constant_{}, share_{1.0};
};

}  // namespace fathom::model
