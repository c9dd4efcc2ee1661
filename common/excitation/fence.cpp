#include "common/excitation/fence.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace fathom::excitation {
namespace {

constexpr double kReaction = 0.15;  // s from deciding to feeling the thrust
constexpr double kSoften = 0.4;     // s in which outward speed shall be taken away
constexpr double kCalm = 0.4;       // of the largest tilt: up to there nothing is done
constexpr std::array kSides{"south", "north", "west", "east", "up", "down"};
constexpr std::size_t kUp = 4;
constexpr double kOutward = 0.2;  // share of an axis's push that leads outwards before its signal turns

// 0 far inside, 1 where all that is left must go into braking.
double urgency(double room, double speed, double braking, double band) {
  const double outward = std::max(0.0, speed);
  const double stop = outward * kReaction + outward * outward / (2.0 * braking);
  return std::clamp((stop + band - room) / band, 0.0, 1.0);
}

struct Tilt {
  double angle{};  // rad between the body's down axis and the vertical
  double rate{};   // rad/s, how fast that grows
};

Tilt tilt_of(const StateEstimate& state) {
  const Eigen::RowVector3d down = state.q_WB.toRotationMatrix().row(2);
  const double level = std::max(down.head<2>().norm(), 1e-6);
  // d(R_33)/dt = (R [w]x)_33
  return {std::atan2(level, down[2]), (down[1] * state.nu[3] - down[0] * state.nu[4]) / level};
}

}  // namespace

Eigen::Vector3d Fence::middle() const {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < 3; ++i) {
    if (std::isfinite(settings_.low[i]) && std::isfinite(settings_.high[i])) {
      p[i] = 0.5 * (settings_.low[i] + settings_.high[i]);
    }
  }
  return p;
}

Fence::Bent Fence::bend(const Vector6d& tau, const StateEstimate& state, double turned, double mass, double inertia,
                        const Vector6d& largest) const {
  Bent bent{.tau = tau};
  // Push and turn tilt the hull by its own coupling as well as roll and pitch thrust do: all but the vertical gives
  // way, and what rights the hull by itself is helped to come to rest.
  const Tilt tilt = tilt_of(state);
  const double calm = kCalm * settings_.largest_tilt;
  const double soon = tilt.angle + kSoften * std::max(0.0, tilt.rate);
  const double tilted = std::clamp((soon - calm) / (settings_.largest_tilt - calm), 0.0, 1.0);
  const Eigen::Vector3d lean{0.0, 0.0, settings_.half_length * std::sin(std::min(soon, settings_.largest_tilt))};
  if (tilted > 0.0) {
    bent.bent = true;
    for (const Eigen::Index axis : {0, 1, 3, 4, 5}) bent.tau[axis] *= 1.0 - tilted;
    bent.tau.segment<2>(3) -= tilted * inertia / kSoften * state.nu.segment<2>(3);
  }
  const Vector6d asked_for = bent.tau;
  const Eigen::Matrix3d R_WB = state.q_WB.toRotationMatrix();
  const Eigen::Vector3d v_W = R_WB * state.nu.head<3>();
  Eigen::Vector3d force_W = R_WB * asked_for.head<3>();
  for (Eigen::Index i = 0; i < 3; ++i) {
    for (const double side : {-1.0, 1.0}) {
      const double room = (side > 0.0 ? settings_.high[i] - state.p_WB[i] : state.p_WB[i] - settings_.low[i]) - lean[i];
      const double speed = side * v_W[i];
      const double u = urgency(room, speed, settings_.braking, settings_.band);
      if (u <= 0.0) continue;
      const double inwards = mass * (std::max(0.0, speed) / kSoften +
                                     settings_.braking * std::clamp(-room / settings_.band + 0.5, 0.0, 1.0));
      const double asked = side * force_W[i];
      const double given = std::min(asked, (1.0 - u) * asked - u * inwards);
      if (given < asked) {
        bent.bent = true;
        force_W[i] = side * given;
      }
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        const double outward = side * R_WB(i, axis) * asked_for[axis];
        if (outward > kOutward * std::abs(asked_for[axis]) && outward > 0.0)
          bent.turn[static_cast<std::size_t>(axis)] = true;
      }
    }
  }
  bent.tau.head<3>() = R_WB.transpose() * force_W;
  const double limit = 2.0 * std::numbers::pi * settings_.turns;
  for (const double side : {-1.0, 1.0}) {
    const double speed = side * state.nu[5];
    const double u = urgency(limit - side * turned, speed, settings_.turning, 0.5);
    if (u <= 0.0) continue;
    const double asked = side * asked_for[5];
    const double given = std::min(asked, (1.0 - u) * asked - u * inertia * std::max(0.0, speed) / kSoften);
    if (asked > 0.0) bent.turn[5] = true;
    if (given < asked) {
      bent.bent = true;
      bent.tau[5] = side * given;
    }
  }
  bent.tau = bent.tau.cwiseMax(-largest).cwiseMin(largest);
  return bent;
}

double Fence::room(const Eigen::Vector3d& p_WB, std::size_t side) const {
  const auto axis = static_cast<Eigen::Index>(side / 2);
  return side % 2 == 0 ? p_WB[axis] - settings_.low[axis] : settings_.high[axis] - p_WB[axis];
}

bool Fence::floats(const Eigen::Vector3d& p_WB) const {
  return p_WB.z() < settings_.low.z() && p_WB.z() >= settings_.waterline - settings_.hard;
}

void Fence::begin(const Eigen::Vector3d& p_WB, bool dives) {
  afloat_ = floats(p_WB) && dives;
  lifted_ = std::min(p_WB.z(), settings_.low.z()) - settings_.hard;
  if (floats(p_WB) && !dives) settings_.low.z() = p_WB.z() - settings_.band - settings_.hard;
}

void Fence::follow(const Eigen::Vector3d& p_WB) { afloat_ = afloat_ && p_WB.z() < settings_.low.z(); }

std::string Fence::outside(const StateEstimate& state, double turned) const {
  for (std::size_t side = 0; side < kSides.size(); ++side) {
    if (afloat_ && side == kUp ? state.p_WB.z() < lifted_ : room(state.p_WB, side) < -settings_.hard)
      return std::string{"too far "} + kSides[side];
  }
  if (state.nu.head<3>().norm() > settings_.largest_speed) return "too fast";
  if (state.nu.tail<3>().norm() > settings_.largest_rate) return "turning too fast";
  const double upright = (state.q_WB * Eigen::Vector3d::UnitZ()).z();
  if (upright < std::cos(settings_.largest_tilt)) return "tilted too far";
  if (std::abs(turned) > 2.0 * std::numbers::pi * (settings_.turns + 1.0)) return "the tether is wound up";
  return {};
}

std::string Fence::place(const StateEstimate& state, double surface) const {
  std::size_t nearest = 0;
  for (std::size_t side = 1; side < kSides.size(); ++side) {
    if (room(state.p_WB, side) < room(state.p_WB, nearest)) nearest = side;
  }
  const double left = room(state.p_WB, nearest), under = state.p_WB.z() - surface;
  std::array<char, 120> text{};
  std::snprintf(text.data(), text.size(), "at %.2f m north, %.2f m east, the hull's top %.2f m %s the surface",
                state.p_WB.x(), state.p_WB.y(), std::abs(under), under < 0.0 ? "above" : "below");
  std::string said = text.data();
  if (!std::isfinite(left)) return said;  // no bound anywhere
  std::snprintf(text.data(), text.size(), ", %.2f m %s the bound: %s", std::abs(left), left < 0.0 ? "beyond" : "from",
                kSides[nearest]);
  return said + text.data();
}

bool Fence::holds(const Eigen::Vector3d& p_WB, const Eigen::Vector3d& v_WB) const {
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double stop = v_WB[i] * std::abs(v_WB[i]) / (2.0 * settings_.braking) + v_WB[i] * kReaction;
    const double reach = p_WB[i] + stop;
    if (std::min(reach, p_WB[i]) < settings_.low[i] || std::max(reach, p_WB[i]) > settings_.high[i]) return false;
  }
  return true;
}

}  // namespace fathom::excitation
