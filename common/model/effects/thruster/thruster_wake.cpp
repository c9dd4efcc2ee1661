// Physics: a thruster in the jet of another one works in water that moves already. The jet's speed goes as the root of
// the thrust that makes it, and what it takes as shaft speed times inflow, as an advance does (thrust_loss.cpp), so
//   f_i = f_c,i - c sqrt|f_c,i f_c,j| s     while f_c,j has the sign whose jet blows at i
// with s = sign(f_c,j) cos(a_i, a_j) where both push along much the same line, and s = sign(f_c,i) where the jet
// crosses the other's (which loses, whichever way it pushes). Forms: one per pair of which one stands in the other's
// jet by the vehicle file's places; "all", where there are several, with one c. Source: Nienhuis 1992 (thrusters behind
// each other; the loss grows as they come near). Ignores: the jet's travelling time, the hull that turns it away, and
// that it fades with distance. Revealed by one thruster at constant thrust while the other is switched. Confused with
// thruster_gain (which does not ask what another one does).
#include <algorithm>
#include <array>
#include <cmath>

#include "common/model/one_of_many.hpp"
#include "common/model/thruster_kinds.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kThrusterWakeParameters{EffectParameter{"loss", "", 0.3, 0.0, 2.0}};
constexpr double kSpread = 0.25;    // of a jet's radius over its length: a round turbulent jet, edge to edge 25 deg
constexpr double kPropeller = 0.1;  // radius of what blows and is blown at, of the largest distance between thrusters
constexpr double kAlongside = 0.5;  // cosine: more, and both push along one line

/// How the jet of one thruster meets another.
struct Meeting {
  double blows{0.0};  ///< sign of the thrust whose jet reaches it; 0: none does
  double cosine{0.0};
};

/// m: of what blows and is blown at.
double radius_of(const Vehicle& vehicle) {
  double largest = 0.0;
  for (const Thruster& a : vehicle.thrusters)
    for (const Thruster& b : vehicle.thrusters) largest = std::max(largest, (a.p_BJ - b.p_BJ).squaredNorm());
  return kPropeller * std::sqrt(largest);
}

Meeting meeting(const Vehicle& vehicle, double radius, std::size_t to, std::size_t from) {
  const Thruster &j = vehicle.thrusters[from], &i = vehicle.thrusters[to];
  if (!is_propeller(i) || !is_propeller(j)) return {};
  const Eigen::Vector3d apart = i.p_BJ - j.p_BJ;
  const double along = j.axis_B.dot(apart), aside = (apart - along * j.axis_B).norm();
  if (std::abs(along) <= radius || aside > radius + kSpread * std::abs(along)) return {};
  return {along > 0.0 ? -1.0 : 1.0, i.axis_B.dot(j.axis_B)};  // a jet leaves against the push
}

/// Force [N] that `f_i` loses, per unit of the number, to the jet of `f_j`.
double lost(const Meeting& m, double f_i, double f_j) {
  if (m.blows * f_j <= 0.0) return 0.0;
  const double size = std::sqrt(std::abs(f_i * f_j));
  return std::abs(m.cosine) > kAlongside ? size * std::copysign(1.0, f_j) * m.cosine : std::copysign(size, f_i);
}

/// `to` in the jet of `from`.
class OnePair final : public OneOfMany {
 public:
  OnePair(std::size_t to, std::size_t from) : to_{to}, from_{from} {}
  bool exists(const Scene& scene) const override { return std::max(to_, from_) < scene.vehicle->thrusters.size(); }
  FormName name(const Scene& scene) const override {
    if (scene.input_is_wrench || !exists(scene)) return {};
    const auto& thrusters = scene.vehicle->thrusters;
    return when(meeting(*scene.vehicle, radius_of(*scene.vehicle), to_, from_).blows != 0.0,
                thrusters[to_].name + " in the jet of " + thrusters[from_].name);
  }
  void feel(Motion& motion, EffectTheta theta, std::span<const double>) const override {
    if (theta[0] == 0.0 || !by_thruster(motion) || std::max(to_, from_) >= motion.vehicle->thrusters.size()) return;
    double& f = motion.force[static_cast<Eigen::Index>(to_)];
    const Meeting m = meeting(*motion.vehicle, radius_of(*motion.vehicle), to_, from_);
    f -= theta[0] * lost(m, f, motion.force[static_cast<Eigen::Index>(from_)]);
  }

 private:
  std::size_t to_, from_;
};

class EveryPair final : public OneOfMany {
 public:
  bool exists(const Scene&) const override { return true; }
  FormName name(const Scene& scene) const override {
    return when(!scene.input_is_wrench && pairs(*scene.vehicle) > 1, "all");
  }
  void feel(Motion& motion, EffectTheta theta, std::span<const double>) const override {
    if (theta[0] == 0.0 || !by_thruster(motion)) return;
    const ActuatorForces before = motion.force;
    const double radius = radius_of(*motion.vehicle);
    for (Eigen::Index i = 0; i < before.size(); ++i) {
      for (Eigen::Index j = 0; j < before.size(); ++j) {
        if (i == j) continue;
        const Meeting m = meeting(*motion.vehicle, radius, static_cast<std::size_t>(i), static_cast<std::size_t>(j));
        motion.force[i] -= theta[0] * lost(m, before[i], before[j]);
      }
    }
  }

 private:
  static int pairs(const Vehicle& vehicle) {
    int count = 0;
    const double radius = radius_of(vehicle);
    for (std::size_t i = 0; i < vehicle.thrusters.size(); ++i)
      for (std::size_t j = 0; j < vehicle.thrusters.size(); ++j)
        count += i != j && meeting(vehicle, radius, i, j).blows != 0.0 ? 1 : 0;
    return count;
  }
};

/// By the larger place, so that those which a vehicle lacks come last.
Forms every_pair() {
  Forms all;
  all.push_back(std::make_unique<EveryPair>());
  for (std::size_t last = 1; last < kMaxActuators; ++last) {
    for (std::size_t other = 0; other < last; ++other) {
      all.push_back(std::make_unique<OnePair>(last, other));
      all.push_back(std::make_unique<OnePair>(other, last));
    }
  }
  return all;
}

}  // namespace

const Effect& thruster_wake() {
  static const Effect kEffect{
      {.name = "thruster_wake",
       .sentence = "A thruster that runs in the jet of another one pushes less.",
       .revealed_by = "one thruster at constant thrust while the others are switched, both ways",
       .finding = "{thruster} loses {loss %} of its push where both push alike",
       .stage = Stage::kThrust,
       .forms_coexist = true,
       .feels_motion = false},
      kThrusterWakeParameters,
      every_pair()};
  return kEffect;
}

}  // namespace fathom::model::effects
