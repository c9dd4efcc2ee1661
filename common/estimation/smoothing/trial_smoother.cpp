#include "common/estimation/smoothing/trial_smoother.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "common/base/error.hpp"

namespace fathom::estimation {
namespace {

namespace at = model::at;

constexpr const char *kForward = "filter", *kBackward = "way back";  // phases of the work
constexpr std::size_t kStretch = 400;  // instants whose record is kept at a time: it stays in the cache
constexpr double kUneven = 1.5;        // usual steps: longer ones are told of

struct Event {
  Utime utime{};
  SampleView sample;
};

std::vector<Event> events_of(const Recording& recording, const KalmanSettings& settings) {
  std::vector<Event> events;
  const auto add = [&events](const auto& stream) {
    for (const auto& sample : stream) events.push_back({sample.utime, &sample});
  };
  add(recording.ahrs);
  add(recording.pose_capture);
  add(recording.dvl);
  add(recording.depth);
  add(recording.usbl);
  if (!settings.transponders.empty()) add(recording.ranges);
  if (!settings.tags.empty()) add(recording.tag_pose);
  if (settings.floor && settings.flow) add(recording.optical_flow);
  if (settings.floor && settings.laser) add(recording.laser_range);
  for (const Signal& one : recording.signals) {
    const auto which = settings.singles.empty() ? std::nullopt : settings.single(one.name);
    if (!which) continue;
    const char* unit = settings.singles[*which].mount.unit();
    if (one.unit != unit)
      throw InputError(recording.name + ": column '" + one.name + "' is told in '" + one.unit + "', not in " + unit +
                       "; state its unit in the column map, or take it out of the vehicle file's sensors");
    events.push_back({one.utime, &one});
  }
  std::stable_sort(events.begin(), events.end(), [](const Event& a, const Event& b) {
    return a.utime != b.utime ? a.utime < b.utime : a.sample.index() < b.sample.index();
  });
  return events;
}

KalmanStart start_of(const Recording& recording, const std::vector<Event>& events, const KalmanSettings& settings) {
  StartFinder finder{settings, tells_position(recording, settings)};
  for (const Event& event : events) {
    finder.hear(event.utime, event.sample);
    if (const auto start = finder.found()) return *start;
  }
  throw InputError(recording.name + ": " + (events.empty() ? "no sensor to estimate motion from" : finder.missing()));
}

/// [first, last) of one time stamp.
template <int N>
void pass_instant(const std::vector<Event>& events, std::size_t first, std::size_t last,
                  KinematicEstimator<N>& estimator, FilterRecord<N>* record) {
  estimator.advance(events[first].utime, record);
  for (std::size_t i = first; i < last; ++i) estimator.take(events[i].sample, record);
  estimator.close(record);
}

bool is_output(const std::vector<Event>& events, std::size_t first, std::size_t last, bool inertial) {
  return std::any_of(events.begin() + static_cast<std::ptrdiff_t>(first),
                     events.begin() + static_cast<std::ptrdiff_t>(last), [inertial](const Event& event) {
                       return inertial ? std::holds_alternative<const Ahrs*>(event.sample)
                                       : !std::holds_alternative<const Depth*>(event.sample) &&
                                             !std::holds_alternative<const Signal*>(event.sample);
                     });
}

template <int N>
model::KinematicVector widen(const Eigen::Matrix<double, N, 1>& x) {
  model::KinematicVector wide = model::KinematicVector::Zero();
  wide.template head<N>() = x;
  return wide;
}

/// The inertial acceleration less w x v is the derivative of v in B.
SmoothedState motion_of(Utime utime, const model::KinematicVector& x, const model::KinematicVector& variance,
                        const std::optional<Eigen::Matrix3d>& reference, const KalmanSettings& settings) {
  StateEstimate state = state_of(utime, x, variance, reference);
  const auto widen = [&state](Eigen::Index begin, const Eigen::Vector3d& lasting) {
    state.sigma.segment<3>(begin) =
        (state.sigma.segment<3>(begin).cwiseAbs2() + lasting.cwiseAbs2()).cwiseSqrt().eval();
  };
  widen(0, settings.lasting_position);
  widen(3, settings.lasting_attitude);
  widen(6, settings.lasting_velocity);
  // A package turned by a small angle is off by that angle times what it measures.
  const Eigen::Vector3d turned = settings.lasting_attitude.cwiseAbs2();
  widen(9, (skew(state.nu.tail<3>()).cwiseAbs2() * turned).cwiseSqrt());
  SmoothedState motion{.utime = utime, .p_WB = state.p_WB, .q_WB = state.q_WB, .nu = state.nu};
  const Eigen::Vector3d v = state.nu.head<3>(), w = state.nu.tail<3>();
  motion.nu_dot << x.segment<3>(at::kAcceleration) - w.cross(v), x.segment<3>(at::kRateSlopes);
  const Eigen::Vector3d v2 = state.sigma.segment<3>(6).cwiseAbs2();
  const Eigen::Vector3d turning = skew(w).cwiseAbs2() * v2;  // the rates are far better known than the velocity
  motion.sigma << state.sigma, (variance.segment<3>(at::kAcceleration) + turning).cwiseMax(0.0).cwiseSqrt(),
      variance.segment<3>(at::kRateSlopes).cwiseMax(0.0).cwiseSqrt();
  return motion;
}

template <int N>
class Run {
 public:
  Run(const Recording& recording, const KalmanSettings& settings)
      : name_{recording.name},
        settings_{settings},
        events_{events_of(recording, settings)},
        inertial_{!recording.ahrs.empty()},
        estimator_{settings} {
    for (std::size_t first = 0; first < events_.size();) {
      std::size_t last = first + 1;
      while (last < events_.size() && events_[last].utime == events_[first].utime) ++last;
      instants_.push_back(first);
      first = last;
    }
    instants_.push_back(events_.size());
    estimator_.start(events_.empty() ? 0 : events_.front().utime, start_of(recording, events_, settings));
  }

  void forward(SmoothedTrial* trial, const Progress& progress = {}, bool keep_filtered = true) {
    const auto stretches = static_cast<double>(instants_.size() / kStretch + 1);
    progress.expect(kForward, stretches);
    progress.expect(kBackward, stretches, 3.0);  // the filter again, and the way back
    progress.begin(kForward, "filtering " + name_);
    for (std::size_t k = 0; k + 1 < instants_.size(); ++k) {
      if (k % kStretch == 0 && k > 0) progress.done(kForward);
      if (k % kStretch == 0 && trial != nullptr) checkpoints_.push_back(estimator_);
      pass_instant<N>(events_, instants_[k], instants_[k + 1], estimator_, nullptr);
      if (trial == nullptr || !output(k)) continue;
      const StateEstimate state =
          state_of(events_[instants_[k]].utime, widen<N>(estimator_.filter().state()),
                   widen<N>(estimator_.filter().covariance().diagonal()), estimator_.filter().reference());
      places_.push_back(state.p_WB);
      if (keep_filtered) trial->filtered.push_back(state);
    }
    if (!estimator_.oriented()) {
      throw InputError(name_ + ": the attitude is lost; check the noises of gyro and attitude, and their axes");
    }
    if (!estimator_.filter().state().allFinite()) throw InputError(name_ + ": the filter diverged; check the noises");
  }

  void backward(SmoothedTrial& trial, const SmoothedVisit& visit, const Progress& progress) {
    progress.expect(kForward, 0);
    progress.begin(kBackward, "smoothing " + name_);
    FilterRecord<N> record;
    Smoother<N> smoother;
    std::vector<Utime> utimes;  // of the record's instants; 0: a step inside a gap
    trial.smoothed.reserve(places_.size());
    trial.apart.reserve(places_.size());
    for (std::size_t c = checkpoints_.size(); c > 0; --c) {
      KinematicEstimator<N>& estimator = checkpoints_[c - 1];
      record.begin(estimator.filter());
      utimes.assign(1, 0);
      const std::size_t from = (c - 1) * kStretch, to = std::min(c * kStretch, instants_.size() - 1);
      for (std::size_t k = from; k < to; ++k) {
        pass_instant<N>(events_, instants_[k], instants_[k + 1], estimator, &record);
        utimes.resize(record.instants.size(), 0);
        if (output(k)) utimes.back() = events_[instants_[k]].utime;
      }
      smoother.back_over(record, [&](std::size_t i, const Smoothed<N>& smoothed) {
        if (utimes[i] == 0) return;
        const typename KalmanFilter<N>::State x = smoothed.state();
        if (visit)
          visit(utimes[i], x, model::KinematicPoint{widen<N>(x), smoothed.reference()}.R_WB, smoothed.covariance());
        if (trial.smoothed.empty()) trial.biases = widen<N>(x);
        trial.smoothed.push_back(
            motion_of(utimes[i], widen<N>(x), widen<N>(smoothed.variance()), smoothed.reference(), settings_));
        const Eigen::Vector3d& filtered = places_[places_.size() - trial.smoothed.size()];
        trial.apart.emplace_back((filtered - trial.smoothed.back().p_WB).cast<float>());
      });
      progress.done(kBackward);
    }
    std::ranges::reverse(trial.smoothed);
    std::ranges::reverse(trial.apart);
  }

  [[nodiscard]] const KinematicEstimator<N>& estimator() const { return estimator_; }

 private:
  [[nodiscard]] bool output(std::size_t k) const {
    return is_output(events_, instants_[k], instants_[k + 1], inertial_);
  }

  const std::string& name_;
  const KalmanSettings& settings_;
  std::vector<Event> events_;
  bool inertial_;
  std::vector<std::size_t> instants_;  // first event of each, and the end
  KinematicEstimator<N> estimator_;
  std::vector<KinematicEstimator<N>> checkpoints_;
  std::vector<Eigen::Vector3d> places_;  // m, of the filter at every output
};

/// What unequal steps and gaps a run has; nothing where all are alike.
std::optional<std::string> uneven(const std::string& name, const std::vector<SmoothedState>& states) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < states.size(); ++k) {
    steps.push_back(seconds_between(states[k - 1].utime, states[k].utime));
  }
  if (steps.empty()) return std::nullopt;
  std::vector<double> sorted = steps;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double usual = kUneven * *middle;
  const auto longest = std::max_element(steps.begin(), steps.end());
  if (*longest <= usual) return std::nullopt;
  const auto at = static_cast<std::size_t>(longest - steps.begin());
  char text[200];
  std::snprintf(
      text, sizeof text,
      ": %td of %zu steps are longer than the usual %.3g s, the longest %.3g s at %.1f s; the model bridges them",
      std::count_if(steps.begin(), steps.end(), [&](double step) { return step > usual; }), steps.size(), *middle,
      *longest, seconds_between(states.front().utime, states[at].utime));
  return name + text;
}

template <int N>
SmoothedTrial smooth_as(const Recording& recording, const KalmanSettings& settings, const SmoothedVisit& visit,
                        const Progress& progress, bool keep_filtered) {
  SmoothedTrial trial;
  Run<N> run{recording, settings};
  if (keep_filtered) trial.filtered.reserve(std::max(recording.ahrs.size(), recording.pose_capture.size()));
  run.forward(&trial, progress, keep_filtered);
  trial.statistics = run.estimator().statistics();
  trial.likelihood = run.estimator().likelihood();
  run.backward(trial, visit, progress);
  if (const auto note = uneven(recording.name, trial.smoothed)) trial.notes.push_back(*note);
  return trial;
}

template <int N>
std::vector<InnovationStatistics> statistics_as(const Recording& recording, const KalmanSettings& settings) {
  Run<N> run{recording, settings};
  run.forward(nullptr);
  return run.estimator().statistics();
}

}  // namespace

bool tells_position(const Recording& recording, const KalmanSettings& settings) {
  const auto camera = [&](const std::string& name) {
    return std::ranges::find(settings.cameras, name, &KnownCamera::name) != settings.cameras.end();
  };
  const auto tag = [&](int number) {
    return std::ranges::find(settings.tags, number, &KnownTag::number) != settings.tags.end();
  };
  return std::ranges::any_of(recording.pose_capture, [](const auto& one) { return one.valid && one.has_position; }) ||
         std::ranges::any_of(recording.usbl, &Usbl::valid) ||
         std::ranges::any_of(recording.tag_pose, [&](const auto& one) { return camera(one.camera) && tag(one.tag); }) ||
         (settings.transponders.size() >= 3 && !recording.ranges.empty());
}

std::vector<InnovationStatistics> innovations(const Recording& recording, const KalmanSettings& settings) {
  switch (settings.states()) {
    case model::kMostStates:
      return statistics_as<model::kMostStates>(recording, settings);
    case model::kLoggedStates:
      return statistics_as<model::kLoggedStates>(recording, settings);
    case model::kInertialStates:
      return statistics_as<model::kInertialStates>(recording, settings);
    default:
      return statistics_as<model::kKinematicStates>(recording, settings);
  }
}

SmoothedTrial smooth(const Recording& recording, const KalmanSettings& settings, const SmoothedVisit& visit,
                     const Progress& progress, bool keep_filtered) {
  switch (settings.states()) {
    case model::kMostStates:
      return smooth_as<model::kMostStates>(recording, settings, visit, progress, keep_filtered);
    case model::kLoggedStates:
      return smooth_as<model::kLoggedStates>(recording, settings, visit, progress, keep_filtered);
    case model::kInertialStates:
      return smooth_as<model::kInertialStates>(recording, settings, visit, progress, keep_filtered);
    default:
      return smooth_as<model::kKinematicStates>(recording, settings, visit, progress, keep_filtered);
  }
}

double likelihood(const Recording& recording, const KalmanSettings& settings) {
  double sum = 0.0;
  for (const InnovationStatistics& one : innovations(recording, settings)) sum += one.likelihood;
  return sum;
}

}  // namespace fathom::estimation
