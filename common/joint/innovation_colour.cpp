#include "common/joint/innovation_colour.hpp"

#include <algorithm>

namespace fathom::joint {
namespace {

constexpr int kOfASecond = 100;  // innovations
constexpr int kSeen = 40;        // seconds looked back
constexpr int kBefore = 20;      // seconds that are taken to have been white
constexpr double kLeast = 0.1;   // what is learnt does not come from the inertial instruments alone

}  // namespace

void InnovationColour::hear(double score) {
  if (score == 0.0) return;
  sum_ += score;
  squares_ += score * score;
  if (++count_ < kOfASecond) return;
  seconds_ = std::min(seconds_ + 1, kSeen);
  sums_ += (sum_ * sum_ / count_ - sums_) / seconds_;
  white_ += (squares_ / count_ - white_) / seconds_;
  sum_ = squares_ = 0.0;
  count_ = 0;
}

double InnovationColour::ratio() const {
  return std::max((kBefore * white_ + seconds_ * sums_) / (kBefore + seconds_), kLeast);
}

}  // namespace fathom::joint
