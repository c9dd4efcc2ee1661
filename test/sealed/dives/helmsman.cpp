#include "test/sealed/dives/helmsman.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fathom::sealed {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kFilter = 0.3;     // s, on rates
constexpr double kSteepest = 0.35;  // rad, of a torpedo's pitch

double held(const std::vector<double>& levels, double hold, double t) {
  return levels[std::min(static_cast<std::size_t>(std::max(t, 0.0) / hold), levels.size() - 1)];
}

}  // namespace

Helmsman::Helmsman(const Craft& craft, const Site& site, double from, double to, Random& random)
    : craft_(craft), site_(site) {
  for (double t = from; t < to;) {
    const double end = std::min(t + random.uniform(22.0, 45.0), to + 1.0);
    segments_.push_back(draw(t, end, random));
    t = end;
  }
}

Helmsman::Segment Helmsman::draw(double from, double to, Random& random) const {
  Segment segment{.from = from, .to = to};
  segment.style = static_cast<Style>(random.below(5));
  segment.turn = random.uniform(-1.5, 1.5);
  segment.amplitude = random.sign() * random.uniform(0.4, 1.0);
  segment.angle = random.uniform(0.15, 0.45);
  segment.slow = random.uniform(0.02, 0.05);
  segment.fast = random.uniform(0.15, 0.35);
  segment.hold = segment.style == Style::kNoise ? random.uniform(1.5, 4.0) : random.uniform(7.0, 14.0);
  segment.depth_hold = random.uniform(9.0, 18.0);
  // A torpedo needs its way to steer; a boat stops and backs.
  const bool backs = craft_.craft_class == CraftClass::kBoat;
  const bool steady = segment.style == Style::kSine || segment.style == Style::kZigzag;
  const auto levels = static_cast<std::size_t>((to - from) / std::min(segment.hold, 7.0)) + 2;
  const double cruise = random.uniform(0.3, 0.9);
  for (std::size_t k = 0; k < levels; ++k) {
    double drive = steady ? cruise : random.uniform(0.15, 1.0);
    if (backs && !steady && random.chance(0.3)) drive = random.chance(0.4) ? 0.0 : -0.6 * drive;
    segment.drive.push_back(drive);
    segment.helm.push_back(random.uniform(-1.0, 1.0));
    segment.depth.push_back(random.uniform(-0.8, 0.8));
  }
  segment.wobble = random.uniform(0.05, 0.25);
  segment.wobble_rate = kTurn * random.log_uniform(0.08, 0.35);
  return segment;
}

double Helmsman::helm_for(const Segment& segment, double t, const Eigen::Vector3d& position, double heading,
                          double turning) {
  const Eigen::Vector2d away = (position - site_.centre).head<2>();
  const double radius = site_.half.x();
  if (away.norm() > radius) homeward_ = true;
  if (away.norm() < 0.6 * radius) homeward_ = false;
  const double pace = craft_.pace[5];
  const auto steer = [&](double course) {
    const double off = std::remainder(course - heading, kTurn);
    return std::clamp(1.6 * off - 0.8 * turning / std::max(pace, 0.05) * 0.4, -1.0, 1.0);
  };
  if (homeward_) return 0.8 * steer(std::atan2(-away.y(), -away.x()));
  const double s = t - segment.from;
  switch (segment.style) {
    case Style::kSpeedSteps:
      return steer(course_);
    case Style::kZigzag: {
      const double off = std::remainder(heading - course_, kTurn);
      if (off > segment.angle) side_ = -1.0;
      if (off < -segment.angle) side_ = 1.0;
      return side_ * std::abs(segment.amplitude);
    }
    case Style::kCircle:
      return segment.amplitude;
    case Style::kSine: {
      const double rate = std::log(segment.fast / segment.slow) / (segment.to - segment.from);
      return segment.amplitude * std::sin(kTurn * segment.slow * std::expm1(rate * s) / rate);
    }
    case Style::kNoise:
      return held(segment.helm, segment.hold, s);
  }
  return 0.0;
}

double Helmsman::planes_for(const Segment& segment, double t, double depth, double pitch, double pitching) {
  const double s = t - segment.from;
  const double wanted = site_.centre.z() + site_.half.z() * held(segment.depth, segment.depth_hold, s);
  const double climb = std::clamp(0.3 * (depth - wanted), -kSteepest, kSteepest);
  const double wobble = segment.wobble * std::sin(segment.wobble_rate * s);
  return std::clamp(2.5 * (climb - pitch) - 1.5 * pitching + wobble, -1.0, 1.0);
}

/// A saw-tooth: heavy and bow down as far as the lower end, light and bow up to the upper; the battery moves besides.
Eigen::VectorXd Helmsman::glide(double t, double dt, double depth) {
  const Segment& segment = *now_;
  const double off = (depth - site_.centre.z()) / site_.half.z();
  if (off > 1.0) sinks_ = -1.0;
  if (off < -1.0) sinks_ = 1.0;
  const double s = t - segment.from, level = held(segment.drive, segment.hold, s);
  const double engine = sinks_ * level, battery = sinks_ * 0.5 * level + 0.4 * held(segment.helm, segment.hold, s);
  engine_ += std::clamp(engine - engine_, -0.15 * dt, 0.15 * dt);  // pumps and screws are slow
  battery_ += std::clamp(battery - battery_, -0.25 * dt, 0.25 * dt);
  return Eigen::Vector2d(engine_ * craft_.jets[0].largest, battery_ * craft_.jets[1].largest);
}

Eigen::VectorXd Helmsman::command(double t, double dt, const Eigen::Vector3d& position, const Eigen::Vector3d& euler,
                                  const Vector6& nu) {
  const auto next = std::ranges::find_if(segments_, [&](const Segment& one) { return t < one.to; });
  const Segment* segment = next == segments_.end() ? &segments_.back() : &*next;
  if (segment != now_) {
    now_ = segment;
    course_ = euler[2] + segment->turn;
  }
  if (craft_.craft_class == CraftClass::kGlider) return glide(t, dt, position.z());
  const double pass = dt / (kFilter + dt);
  smooth_turning_ += pass * (nu[5] - smooth_turning_);
  smooth_pitching_ += pass * (nu[4] - smooth_pitching_);
  const double helm = helm_for(*segment, t, position, euler[2], smooth_turning_);
  const double planes = planes_for(*segment, t, position.z(), euler[1], smooth_pitching_);
  double drive = held(segment->drive, segment->hold, t - segment->from);
  if (homeward_) drive = std::max(drive, 0.4);
  Eigen::VectorXd force(static_cast<Eigen::Index>(craft_.jets.size()));
  for (std::size_t i = 0; i < craft_.jets.size(); ++i) {
    const Jet& jet = craft_.jets[i];
    double told = drive;
    if (jet.drive == Drive::kFin) {
      const bool rudder = std::abs(jet.axis.y()) > 0.5;
      told = rudder ? std::copysign(helm, helm * jet.position.x()) : -std::copysign(planes, planes * jet.position.x());
    } else if (craft_.craft_class == CraftClass::kBoat) {
      told = drive - 0.45 * std::copysign(helm, helm * jet.position.y());
    }
    force[static_cast<Eigen::Index>(i)] = std::clamp(told, -1.0, 1.0) * jet.largest;
  }
  return force;
}

}  // namespace fathom::sealed
