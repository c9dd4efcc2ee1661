// Every attitude sample makes a node; what was measured meanwhile is put in at its own time, and everything since is
// computed anew. What is let in stands in navigator_intake.cpp, what each measurement does in navigator_aids.cpp.
#include "common/estimation/online/navigator.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/base/spatial.hpp"

namespace fathom::estimation {
namespace {

std::size_t slot(Source source) { return static_cast<std::size_t>(source); }

}  // namespace

Navigator::Navigator(const NavigatorSettings& settings, const NavigatorPlaces& places)
    : settings_{settings}, places_{places}, vertical_velocity_{settings.dvl.used || settings.published_gains} {
  if (settings_.tags.used && places_.tags.empty())
    throw InputError("estimator: tags are used; give a site file with tags");
  if ((settings_.flow.used || settings_.laser.used) && !places_.floor) {
    throw InputError("estimator: flow and laser need a floor; give a site file with one");
  }
  if ((settings_.flow.used || settings_.laser.used || settings_.tags.used) && places_.cameras.empty()) {
    throw InputError("estimator: tags, flow and laser need a camera; give a vehicle file with its mount");
  }
  const NavigationFilter filter{{.acceleration = settings_.acceleration_noise,
                                 .vertical_acceleration = settings_.vertical_acceleration_noise,
                                 .bias_walk = settings_.bias_walk,
                                 .bias_prior = settings_.bias_prior,
                                 .attitude = settings_.attitude_noise,
                                 .gravity = places_.gravity}};
  nodes_.assign(kHistory, Node{.after = {.filter = filter}});
  waiting_.reserve(kHistory);
}

void Navigator::reset() { *this = Navigator{NavigatorSettings{settings_}, NavigatorPlaces{places_}}; }

const AidSettings& Navigator::aid(Source source) const {
  switch (source) {
    case Source::kTagPose:
      return settings_.tags;
    case Source::kOpticalFlow:
      return settings_.flow;
    case Source::kLaserRange:
      return settings_.laser;
    case Source::kDvl:
      return settings_.dvl;
    case Source::kUsbl:
      return settings_.usbl;
    default:
      return settings_.depth;
  }
}

// What the accelerometer would feel at the body's origin: f - w' x r - w x (w x r).
Navigator::Input Navigator::input_of(const Ahrs& sample) {
  Input input{.q_WB = sample.q_WB.normalized(), .w_B = sample.w_WB_B, .f_B = sample.f_B};
  if (!places_.p_BI.isZero() && last_ahrs_) {
    const double dt = seconds_between(last_ahrs_->utime, sample.utime);
    const Eigen::Vector3d turning =
        dt <= settings_.max_gap ? Eigen::Vector3d((sample.w_WB_B - last_ahrs_->w_WB_B) / dt) : Eigen::Vector3d::Zero();
    input.f_B -= turning.cross(places_.p_BI) + input.w_B.cross(input.w_B.cross(places_.p_BI));
  }
  return input;
}

const Navigator::Output& Navigator::step(const Ahrs& sample) {
  output_.clear();
  if (!usable(sample)) {
    // What was refused must not stand as the last good one, but a frozen one is compared with itself.
    return output_;
  }
  const Input input = input_of(sample);
  last_ahrs_ = sample;
  if (count_ == kHistory) {
    first_ = (first_ + 1) % kHistory;
    --count_;
  }
  const std::size_t newest = (first_ + count_) % kHistory;
  const Utime before = count_ > 0 ? this->newest().utime : sample.utime - 1;
  nodes_[newest].utime = sample.utime;
  nodes_[newest].input = input;
  ++count_;
  Utime since = before;  // everything up to here stands as it is
  for (Measurement& m : waiting_) {
    if (m.counts || utime_after(m.utime, aid(m.source).delay) > sample.utime || m.utime > sample.utime) continue;
    m.counts = true;
    since = std::min(since, m.utime - 1);
  }
  if (count_ == 1) {
    const Memory fresh{.filter = NavigationFilter{{.acceleration = settings_.acceleration_noise,
                                                   .vertical_acceleration = settings_.vertical_acceleration_noise,
                                                   .bias_walk = settings_.bias_walk,
                                                   .bias_prior = settings_.bias_prior,
                                                   .attitude = settings_.attitude_noise,
                                                   .gravity = places_.gravity}}};
    nodes_[newest].after = fresh;
  } else {
    std::size_t from = count_ - 2;
    while (from > 0 && nodes_[(first_ + from) % kHistory].utime > since) --from;
    run(from, nodes_[(first_ + from) % kHistory].utime);
  }
  say(nodes_[newest]);
  forget();
  return output_;
}

// Computes all nodes behind number `from` anew.
void Navigator::run(std::size_t from, Utime since) {
  auto next =
      static_cast<std::size_t>(std::upper_bound(waiting_.begin(), waiting_.end(), since,
                                                [](Utime time, const Measurement& m) { return time < m.utime; }) -
                               waiting_.begin());
  for (std::size_t k = from; k + 1 < count_; ++k) {
    const Node& before = nodes_[(first_ + k) % kHistory];
    Node& after = nodes_[(first_ + k + 1) % kHistory];
    after.after = before.after;
    Memory& memory = after.after;
    Utime now = before.utime;
    const double gap = seconds_between(before.utime, after.utime);
    if (gap > settings_.max_gap) {
      memory.filter.forget_motion(gap, settings_.unknown_acceleration);
      now = after.utime;
    }
    while (next < waiting_.size() && waiting_[next].utime <= after.utime) {
      std::size_t end = next + 1;  // one picture's tags belong together
      const Measurement& first = waiting_[next];
      while (end < waiting_.size() && waiting_[end].utime == first.utime && waiting_[end].source == first.source) ++end;
      if (std::any_of(waiting_.begin() + static_cast<std::ptrdiff_t>(next),
                      waiting_.begin() + static_cast<std::ptrdiff_t>(end),
                      [](const Measurement& m) { return m.counts; })) {
        const Utime at = std::max(now, first.utime);
        advance(memory, before, after, now, at);
        use(memory, next, end, between(before, after, first.utime));
        now = at;
      }
      next = end;
    }
    advance(memory, before, after, now, after.utime);
  }
}

Navigator::Input Navigator::between(const Node& before, const Node& after, Utime utime) {
  const double whole = seconds_between(before.utime, after.utime);
  const double share = whole > 0.0 ? std::clamp(seconds_between(before.utime, utime) / whole, 0.0, 1.0) : 1.0;
  return {.q_WB = before.input.q_WB.slerp(share, after.input.q_WB),
          .w_B = before.input.w_B + share * (after.input.w_B - before.input.w_B),
          .f_B = before.input.f_B + share * (after.input.f_B - before.input.f_B)};
}

void Navigator::advance(Memory& memory, const Node& before, const Node& after, Utime from, Utime to) const {
  const double dt = seconds_between(from, to);
  if (dt <= 0.0 || !memory.started) return;
  const Input middle = between(before, after, from + (to - from) / 2);
  memory.filter.predict(dt, middle.q_WB.toRotationMatrix(), middle.f_B);
}

void Navigator::say(const Node& node) {
  const Memory& memory = node.after;
  StateEstimate state;
  state.utime = node.utime;
  state.q_WB = node.input.q_WB;
  const Eigen::Matrix3d R_WB = state.q_WB.toRotationMatrix();
  state.p_WB = memory.filter.position();
  state.nu << R_WB.transpose() * memory.filter.velocity(), node.input.w_B;
  state.covariance = memory.filter.covariance_body(R_WB);
  // What the source that it rests on is off by all the time.
  const auto systematic = [&](Source source) {
    const double s = memory.tracks[slot(source)].last ? aid(source).systematic : 0.0;
    return s * s;
  };
  const double across = std::max(systematic(Source::kTagPose), systematic(Source::kUsbl));
  // Depth from pressure takes the vertical from the fixes.
  const double depth = systematic(Source::kDepth);
  const double down = depth > 0.0 ? depth : std::max(across, systematic(Source::kLaserRange));
  const double speed = std::max(systematic(Source::kOpticalFlow), systematic(Source::kDvl));
  state.covariance.diagonal() += (Vector6d{} << across, across, down, speed, speed, speed).finished();
  const Vector6d sigma = state.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::Vector3d turned = (R_WB.transpose().cwiseAbs2() * settings_.attitude_sigma().cwiseAbs2()).cwiseSqrt();
  state.sigma << sigma.head<3>(), turned, sigma.tail<3>(), Eigen::Vector3d::Constant(settings_.rate_noise);
  for (std::size_t i = 0; i < kSources; ++i) {
    if (memory.tracks[i].last) state.age[i] = seconds_between(*memory.tracks[i].last, node.utime);
  }
  state.age[slot(Source::kAhrs)] = 0.0;
  // A first fix alone may be wild: another one must have agreed with it.
  const bool witnessed =
      memory.tracks[slot(Source::kTagPose)].accepted + memory.tracks[slot(Source::kUsbl)].accepted > 0;
  state.valid = memory.started && witnessed && sigma.head<3>().maxCoeff() <= settings_.largest_position_sigma &&
                sigma.tail<3>().maxCoeff() <= settings_.largest_velocity_sigma;
  output_.push_back(state);
}

// Measurements older than the oldest node can never be asked for again.
void Navigator::forget() {
  const Utime oldest = nodes_[first_].utime;
  if (waiting_.size() < kHistory / 2) return;
  waiting_.erase(waiting_.begin(), std::lower_bound(waiting_.begin(), waiting_.end(), oldest,
                                                    [](const Measurement& m, Utime t) { return m.utime < t; }));
}

}  // namespace fathom::estimation
