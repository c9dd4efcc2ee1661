#include "common/diagnosis/places.hpp"

#include <algorithm>

namespace fathom::diagnosis {
namespace {

constexpr std::size_t kMost = 512;

}  // namespace

void Places::add(const Eigen::Vector3d& p_WB) {
  if (heard_++ % stride_ != 0) return;
  places_.push_back(p_WB);
  if (places_.size() < kMost) return;
  for (std::size_t i = 0; 2 * i < places_.size(); ++i) places_[i] = places_[2 * i];
  places_.resize(kMost / 2);
  stride_ *= 2;
}

void Places::clear() { *this = Places{}; }

bool Places::rule_out(const model::Effect& effect, model::EffectTheta theta, int variant) const {
  if (!effect.feels_place()) return false;
  const auto inside = std::ranges::count_if(
      places_, [&](const Eigen::Vector3d& p_WB) { return !effect.possible(p_WB, theta, variant); });
  return static_cast<double>(inside) > kInside * static_cast<double>(places_.size());
}

}  // namespace fathom::diagnosis
