#include "common/estimation/online/kalman_estimator.hpp"

#include <algorithm>
#include <cmath>

namespace fathom::estimation {
namespace {

template <class... Kinds, class Sample>
bool holds(const Sample& sample) {
  return (std::holds_alternative<Kinds>(sample) || ...);
}

}  // namespace

KalmanEstimator::KalmanEstimator(const KalmanSettings& settings)
    : settings_{settings}, machine_{machine()}, finder_{settings_} {}

KalmanEstimator::Machine KalmanEstimator::machine() const {
  switch (settings_.states()) {
    case model::kMostStates:
      return KinematicEstimator<model::kMostStates>{settings_};
    case model::kLoggedStates:
      return KinematicEstimator<model::kLoggedStates>{settings_};
    case model::kInertialStates:
      return KinematicEstimator<model::kInertialStates>{settings_};
    default:
      return KinematicEstimator<model::kKinematicStates>{settings_};
  }
}

void KalmanEstimator::reset() {
  machine_ = machine();
  finder_ = StartFinder{settings_};
  waiting_.clear();
  newest_ = now_ = inertial_ = fixed_ = std::nullopt;
  output_.clear();
  late_ = unstarted_ = ahead_ = 0;
}

const KalmanEstimator::Output& KalmanEstimator::wait(Event event) {
  output_.clear();
  if (now_ && event.utime < *now_) {
    ++late_;
    return output_;
  }
  if (!holds<Signal>(event.sample)) newest_ = std::max(event.utime, newest_.value_or(event.utime));
  // At equal times the kinds have a fixed order, so that arrival does not matter there either.
  const auto place = std::upper_bound(waiting_.begin(), waiting_.end(), event, [](const Event& a, const Event& b) {
    return a.utime != b.utime ? a.utime < b.utime : a.sample.index() < b.sample.index();
  });
  waiting_.insert(place, std::move(event));
  release(utime_after(*newest_, -settings_.latency));
  return output_;
}

const KalmanEstimator::Output& KalmanEstimator::step(const Signal& sample) {
  output_.clear();
  if (!settings_.single(sample.name)) return output_;
  const double lead = newest_ ? seconds_between(*newest_, sample.utime) : HUGE_VAL;
  if (std::abs(lead) <= settings_.latency) return wait({sample.utime, sample});
  ++(lead > 0.0 ? ahead_ : late_);
  return output_;
}

const KalmanEstimator::Output& KalmanEstimator::finish() {
  output_.clear();
  if (!waiting_.empty()) release(waiting_.back().utime);
  return output_;
}

void KalmanEstimator::release(Utime until) {
  std::size_t done = 0;
  while (done < waiting_.size() && waiting_[done].utime <= until) {
    const Utime utime = waiting_[done].utime;
    bool inertial = false, captured = false;
    for (; done < waiting_.size() && waiting_[done].utime == utime; ++done) {
      use(waiting_[done]);
      inertial = inertial || holds<Ahrs>(waiting_[done].sample);
      captured = captured || holds<PoseCapture>(waiting_[done].sample);
    }
    if (inertial) inertial_ = utime;
    const bool fresh = inertial_ && seconds_between(*inertial_, utime) <= settings_.max_gap;
    if (inertial || (captured && !fresh)) say(utime);
  }
  waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(done));
}

bool KalmanEstimator::used(const Sample& sample) const {
  if (holds<OpticalFlow>(sample)) return settings_.flow && settings_.floor;
  if (holds<LaserRange>(sample)) return settings_.laser && settings_.floor;
  return true;
}

void KalmanEstimator::use(const Event& event) {
  if (!used(event.sample)) return;
  now_ = event.utime;
  const SampleView view = std::visit([](const auto& one) { return SampleView{&one}; }, event.sample);
  if (holds<PoseCapture, Dvl, Usbl, Ranges, TagPose, OpticalFlow>(event.sample)) fixed_ = event.utime;
  std::visit(
      [&](auto& estimator) {
        if (!estimator.started()) {
          finder_.hear(event.utime, view);
          const auto start = finder_.found();
          if (!start) {
            ++unstarted_;
            return;
          }
          estimator.start(event.utime, *start);
        }
        estimator.advance(event.utime, nullptr);
        estimator.take(view, nullptr);
      },
      machine_);
}

void KalmanEstimator::say(Utime utime) {
  std::visit(
      [&]<int N>(const KinematicEstimator<N>& estimator) {
        if (!estimator.started()) return;
        model::KinematicVector x = model::KinematicVector::Zero(), variance = x;
        x.head<N>() = estimator.filter().state();
        variance.head<N>() = estimator.filter().covariance().diagonal();
        StateEstimate state = state_of(utime, x, variance, estimator.filter().reference());
        state.valid = estimator.oriented() && fixed_ && seconds_between(*fixed_, utime) <= settings_.max_gap &&
                      x.allFinite() && variance.allFinite();
        if (state.p_WB.allFinite() && state.nu.allFinite()) output_.push_back(state);
      },
      machine_);
}

std::map<std::string, std::int64_t> KalmanEstimator::rejected() const {
  std::map<std::string, std::int64_t> counts;
  if (late_ > 0) counts["late"] = late_;
  if (ahead_ > 0) counts["ahead"] = ahead_;
  if (unstarted_ > 0) counts["no start yet"] = unstarted_;
  std::visit(
      [&](const auto& estimator) {
        for (const InnovationStatistics& one : estimator.statistics()) {
          if (one.refused > 0) counts[one.name + " gated"] = one.refused;
          if (one.dropped > 0) counts[one.name + " not heard"] = one.dropped;
        }
      },
      machine_);
  return counts;
}

}  // namespace fathom::estimation
