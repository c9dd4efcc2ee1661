#include "test/sealed/dives/pilot.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <numbers>

#include "test/sealed/craft/body.hpp"
#include "test/sealed/mechanisms/mechanism_tools.hpp"

namespace fathom::sealed {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kFade = 1.5;           // s, at both ends of a segment
constexpr double kHandPeriod = 22.0;    // s: slower than the excitation, so that it does not fight it
constexpr double kWallPeriod = 7.0;     // s, where the box ends
constexpr double kUprightPeriod = 5.0;  // s
constexpr double kFilter = 0.4;         // s, on what the instruments show
constexpr double kReserve = 2.2;        // thrusters are this much stronger than the excitation

/// Straight lines between levels that are held for `hold`, with ramps of a quarter of it.
double staircase(const std::vector<double>& levels, double hold, double t) {
  const double place = t / hold;
  const auto i = std::min(static_cast<std::size_t>(place), levels.size() - 1);
  const double last = i == 0 ? 0.0 : levels[i - 1], share = std::min(4.0 * (place - static_cast<double>(i)), 1.0);
  return last + (levels[i] - last) * share;
}

}  // namespace

Pilot::Pilot(const Craft& craft, const Site& site, double from, double to, Random& random)
    : craft_(craft), site_(site), strength_(1.15 * usual_drag(craft)), inertia_(craft.hull.added) {
  inertia_.head<3>().array() += craft.hull.mass;
  inertia_.tail<3>() += craft.hull.inertia;
  const Hull& hull = craft.hull;
  for (int i = 0; i < 6; ++i) {  // moments also have to work against inertia at a third of a hertz
    strength_[i] = std::hypot(strength_[i], inertia_[i] * craft.pace[i] * (i < 3 ? 0.5 : 1.0));
    if (i == 3 || i == 4) strength_[i] += 0.12 * hull.first_moment.norm();
    if (!craft.actuated[static_cast<std::size_t>(i)]) strength_[i] = 0.0;
  }
  // Only rows that are driven: the others (roll of a vehicle with one vertical thruster) are left to weight and
  // buoyancy.
  const auto allocation = craft.allocation();
  Eigen::MatrixXd driven(6, allocation.cols());
  for (int i = 0; i < 6; ++i)
    driven.row(i) = (craft.actuated[static_cast<std::size_t>(i)] ? 1.0 : 0.0) * allocation.row(i);
  from_wrench_ = driven.completeOrthogonalDecomposition().pseudoInverse();
  limit_ = kReserve * (from_wrench_.cwiseAbs() * strength_);
  limit_.array() += 0.2 * limit_.maxCoeff() + 0.5 * std::abs(hull.net_weight);
  for (double t = from; t < to;) {
    const double end = std::min(t + random.uniform(18.0, 45.0), to + 1.0);
    segments_.push_back(draw(t, end, random));
    t = end;
  }
}

Pilot::Segment Pilot::draw(double from, double to, Random& random) const {
  Segment segment{.from = from, .to = to};
  const double die = random.unit();
  segment.style = die < 0.25   ? Style::kSweep
                  : die < 0.55 ? Style::kMultisine
                  : die < 0.8  ? Style::kNoise
                               : Style::kStopAndGo;
  segment.axis = draw_axis(craft_, random);
  const double room = segment.axis < 3 ? site_.half[segment.axis == 1 ? 1 : segment.axis] : 1.0;
  segment.slow = segment.axis < 3 ? craft_.pace[segment.axis] / (kTurn * 0.6 * room) : 0.05;
  segment.fast = random.uniform(0.25, 0.5);
  const double length = to - from;
  segment.hold = segment.style == Style::kNoise ? random.uniform(0.8, 1.6) : random.uniform(2.5, 5.0);
  const auto levels = static_cast<std::size_t>(length / segment.hold) + 2;
  for (std::size_t i = 0; i < 6; ++i) {
    const double strength = strength_[static_cast<Eigen::Index>(i)];
    for (int k = 0; k < 6; ++k) {
      segment.tones[i].push_back({0.45 * strength * random.uniform(0.6, 1.4), kTurn * random.log_uniform(0.04, 0.4),
                                  random.uniform(0.0, kTurn)});
    }
    // Stop-and-go moves two axes; a push is paid back by one the other way, with rests between.
    const bool moves = segment.style == Style::kNoise || static_cast<int>(i) == segment.axis || random.chance(0.25);
    double owed = 0.0;
    for (std::size_t k = 0; k < levels; ++k) {
      double level = 0.0;
      if (segment.style == Style::kNoise) {
        level = 0.75 * strength * random.normal();
      } else if (k % 2 == 0) {
        level = owed != 0.0 ? -owed : strength * random.sign() * random.uniform(0.6, 1.4);
        owed = owed != 0.0 ? 0.0 : level;
      }
      segment.levels[i].push_back(moves ? level : 0.0);
    }
  }
  return segment;
}

Vector6 Pilot::excitation(double t) const {
  Vector6 wrench = Vector6::Zero();
  for (const Segment& segment : segments_) {
    if (t < segment.from || t >= segment.to) continue;
    const double s = t - segment.from, length = segment.to - segment.from;
    const double fade = std::clamp(std::min(s, length - s) / kFade, 0.0, 1.0);
    for (int i = 0; i < 6; ++i) {
      const auto k = static_cast<std::size_t>(i);
      if (!craft_.actuated[k]) continue;
      double value = 0.0;
      switch (segment.style) {
        case Style::kSweep:
          if (i == segment.axis) {
            const double rate = std::log(segment.fast / segment.slow) / length;
            value = 1.2 * strength_[i] * std::sin(kTurn * segment.slow * std::expm1(rate * s) / rate);
          }
          break;
        case Style::kMultisine:
          for (const Tone& tone : segment.tones[k]) value += tone.amplitude * std::sin(tone.omega * s + tone.phase);
          break;
        case Style::kNoise:
        case Style::kStopAndGo:
          value = staircase(segment.levels[k], segment.hold, s);
          break;
      }
      wrench[i] = fade * value;
    }
  }
  return wrench;
}

Vector6 Pilot::keeping(double dt, const Eigen::Vector3d& position, const Eigen::Vector3d& euler, const Vector6& nu) {
  const double pass = dt / (kFilter + dt);
  smooth_nu_ += pass * (nu - smooth_nu_);
  smooth_offset_ += pass * (position - site_.centre - smooth_offset_);
  const double omega = kTurn / kHandPeriod, wall = kTurn / kWallPeriod;
  drift_ += dt * omega / 12.0 * smooth_offset_;
  Eigen::Vector3d pull;  // m/s^2, in the world
  for (int i = 0; i < 3; ++i) {
    const double half = site_.half[i], x = smooth_offset_[i];
    const double over = std::copysign(std::max(std::abs(x) - 0.75 * half, 0.0), x);
    drift_[i] = std::clamp(drift_[i], -0.5 * half, 0.5 * half);
    pull[i] = -omega * omega * (x + drift_[i]) - wall * wall * over;
  }
  const Eigen::Matrix3d turn = turn_of(euler);
  Vector6 wrench;
  const double outside = (smooth_offset_.cwiseAbs() - 0.75 * site_.half).maxCoeff() > 0.0 ? 0.6 * wall : 0.4 * omega;
  wrench.head<3>() = turn.transpose() * pull - outside * smooth_nu_.head<3>();
  const double upright = kTurn / kUprightPeriod;
  wrench[3] = -upright * upright * euler[0] - 1.8 * upright * smooth_nu_[3];
  wrench[4] = -upright * upright * euler[1] - 1.8 * upright * smooth_nu_[4];
  wrench[5] = -0.15 * smooth_nu_[5];
  wrench = wrench.cwiseProduct(inertia_);
  wrench.head<3>() -= craft_.hull.net_weight * turn.row(2).transpose();
  return wrench;
}

Eigen::VectorXd Pilot::command(double t, double dt, const Eigen::Vector3d& position, const Eigen::Vector3d& euler,
                               const Vector6& nu) {
  Vector6 wrench = excitation(t) + keeping(dt, position, euler, nu);
  for (int i = 0; i < 6; ++i) {
    if (!craft_.actuated[static_cast<std::size_t>(i)]) wrench[i] = 0.0;
  }
  return (from_wrench_ * wrench).cwiseMin(limit_).cwiseMax(-limit_);
}

}  // namespace fathom::sealed
