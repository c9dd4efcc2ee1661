#include "common/identification/effect_track.hpp"

#include <algorithm>
#include <utility>

namespace fathom::identification {
namespace {

constexpr Utime kPastStep = 20'000;       // us between commands kept for delays
constexpr std::size_t kPastLength = 100;  // of those: 2 s, longer than the longest delay

}  // namespace

EffectTrack::EffectTrack(const model::Model& base, model::ActiveEffect effect,
                         std::span<const model::BaseParameter> parameters, Utime origin, std::size_t capacity,
                         double max_gap)
    : wrench_{base, std::move(effect), parameters},
      sought_{this->effect().effect->sought(this->effect().variant)},
      vehicle_{base.vehicle},
      origin_{origin},
      max_gap_{max_gap} {
  base_.resize(static_cast<Eigen::Index>(parameters.size()));
  for (Eigen::Index i = 0; i < base_.size(); ++i) {
    base_[i] = base.theta[model::index(parameters[static_cast<std::size_t>(i)])];
  }
  wrenches_.assign(capacity, model::EffectColumns::Zero(6, wrench_.columns()));
  momenta_ = wrenches_;
  filtered_.setZero(6, wrench_.columns());
}

void EffectTrack::remember(const EffectSample& sample) {
  const auto end = [&] { return past_begin_ + static_cast<Utime>(past_.size()) * kPastStep; };
  if (past_.empty() || sample.utime - end() > static_cast<Utime>(kPastLength) * kPastStep) {
    past_.assign(1, Eigen::VectorXd{sample.force});
    past_begin_ = sample.utime;
  }
  while (end() <= sample.utime) past_.emplace_back(sample.force);
  if (past_.size() > 2 * kPastLength) {
    const std::size_t old = past_.size() - kPastLength;
    past_.erase(past_.begin(), past_.begin() + static_cast<std::ptrdiff_t>(old));
    past_begin_ += static_cast<Utime>(old) * kPastStep;
  }
}

void EffectTrack::step(const EffectSample& sample) {
  const double dt = has_last_ ? seconds_between(last_.utime, sample.utime) : 0.0;
  if (!sample.valid || dt < 0.0 || dt > max_gap_) {
    wrench_.reset();
    filled_ = 0;
    has_last_ = false;
    if (!sample.valid) return;
  }
  remember(sample);
  const model::InputSignal past{seconds_between(origin_, past_begin_), 1e-6 * static_cast<double>(kPastStep), past_};
  const model::Motion motion{.t = seconds_between(origin_, sample.utime),
                             .p_WB = sample.p_WB,
                             .R_WB = sample.q_WB.toRotationMatrix(),
                             .nu = sample.nu,
                             .force = sample.force,
                             .voltage = sample.voltage,
                             .input = &past,
                             .vehicle = vehicle_};
  const model::ActuatorForces middle =
      has_last_ ? model::ActuatorForces{0.5 * (last_.force + sample.force)} : sample.force;
  wrench_.step(motion, middle, has_last_ ? dt : 0.0, wrenches_[next_], momenta_[next_]);
  next_ = (next_ + 1) % wrenches_.size();
  filled_ = std::min(filled_ + 1, wrenches_.size());
  last_ = sample;
  has_last_ = true;
}

bool EffectTrack::extend(RowBlock& block, std::span<const double> average, std::span<const double> derivative) {
  const std::size_t count = average.size();
  if (count > filled_) return false;
  filtered_.setZero();
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = (next_ + wrenches_.size() - count + i) % wrenches_.size();
    filtered_ += average[i] * wrenches_[at];
    filtered_ -= derivative[i] * momenta_[at];
  }
  const std::vector<double>& theta = effect().theta;
  const auto all = static_cast<Eigen::Index>(theta.size()), numbers = static_cast<Eigen::Index>(sought_.size());
  for (int k = 0; k < block.count; ++k) {
    Row& row = block.rows[static_cast<std::size_t>(k)];
    const Eigen::Index base = row.h.size();
    row.h.conservativeResize(base + numbers);
    row.y += filtered_(row.axis, 0);
    for (Eigen::Index i = 0; wrench_.felt() && i < base; ++i) {
      const double change = filtered_(row.axis, 1 + all + i);
      row.h[i] -= change;
      row.y -= change * base_[i];
    }
    for (Eigen::Index i = 0; i < numbers; ++i) {
      const std::size_t place = sought_[static_cast<std::size_t>(i)];
      const double change = filtered_(row.axis, static_cast<Eigen::Index>(place) + 1);
      row.h[base + i] = -change;
      row.y -= change * theta[place];
    }
  }
  return true;
}

}  // namespace fathom::identification
