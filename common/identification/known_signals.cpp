#include "common/identification/known_signals.hpp"

#include <algorithm>

#include "common/base/error.hpp"

namespace fathom::identification {

KnownSignal::KnownSignal(const Recording& recording, std::string_view quantity, std::string_view unit) {
  for (const Signal& one : recording.signals) {
    if (one.quantity != quantity) continue;
    if (one.unit != unit)
      throw InputError(recording.name + ": SIGNAL " + one.name + " tells " + one.quantity + " in '" + one.unit +
                       "'; it is read in " + std::string{unit} +
                       ", which 'fathom import' writes where its map says the unit");
    if (!times_.empty() && one.utime <= times_.back()) continue;  // a second witness of the same time
    times_.push_back(one.utime);
    values_.push_back(one.value);
  }
}

std::size_t KnownSignal::above(Utime utime) const {
  return static_cast<std::size_t>(std::ranges::upper_bound(times_, utime) - times_.begin());
}

double KnownSignal::at(Utime utime) const {
  if (empty()) return 0.0;
  const std::size_t i = above(utime);
  if (i == 0 || i == times_.size()) return values_[i == 0 ? 0 : i - 1];
  return values_[i - 1] + rate(utime) * seconds_between(times_[i - 1], utime);
}

double KnownSignal::rate(Utime utime) const {
  const std::size_t i = above(utime);
  if (i == 0 || i == times_.size()) return 0.0;
  return (values_[i] - values_[i - 1]) / seconds_between(times_[i - 1], times_[i]);
}

KnownFlow::KnownFlow(const Recording& recording) {
  for (std::size_t i = 0; i < components_.size(); ++i)
    components_[i] = KnownSignal{recording, kWaterVelocity[i], "m/s"};
}

bool KnownFlow::empty() const { return std::ranges::all_of(components_, &KnownSignal::empty); }

Eigen::Vector3d KnownFlow::velocity(Utime utime) const {
  return {components_[0].at(utime), components_[1].at(utime), components_[2].at(utime)};
}

Eigen::Vector3d KnownFlow::acceleration(Utime utime) const {
  return {components_[0].rate(utime), components_[1].rate(utime), components_[2].rate(utime)};
}

}  // namespace fathom::identification
