#include "common/model/motion.hpp"

#include <algorithm>
#include <cmath>

namespace fathom::model {

void InputSignal::at(double t, ActuatorForces& force) const {
  const double last = static_cast<double>(samples_.size() - 1);
  const double position = std::clamp((t - t0_) / dt_, 0.0, last);
  const auto index = static_cast<std::size_t>(std::min(std::floor(position), std::max(last - 1.0, 0.0)));
  const double share = position - static_cast<double>(index);
  const std::size_t next = std::min(index + 1, samples_.size() - 1);
  force = (1.0 - share) * samples_[index] + share * samples_[next];
}

}  // namespace fathom::model
