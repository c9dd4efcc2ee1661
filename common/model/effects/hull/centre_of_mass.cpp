// Physics: the file counts from a point that is not the centre of mass. With r = r_BG in B and the mass m of the file,
//   dM = m [0, -S(r); S(r), -S(r)^2]     P = m w x r,  L = m r x (v + w x r)     w = -[w x P; w x L + v x P]
// (Fossen 2011, eq. 3.42 to 3.56): three numbers tie six off-diagonal masses together. The file's moments of inertia
// are then about axes through G, as drawing programs give them, and M stays positive definite for any r. Does no work.
// Ignores: added mass and drag that act elsewhere too (they hold about Bo), the weight's moment W r x down, which
// belongs to G_x, G_y, G_z of the base model or to restoring_moment.
// Revealed by turning on the spot, by steps along one axis, and by turning while moving. Confused with cross_coupling
// (one pair alone: Y_r_dot is x_G of a vehicle that does not pitch, but for the water's motion), lever_arm, and
// thruster_misalignment.
#include <algorithm>
#include <array>

#include "common/model/component_set.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::effects {
namespace {

// Sought together, as a centre that lies off is off in all directions.
constexpr std::array kCentreOfMassParameters{EffectParameter{"x_G", "m", 0.1, -1.0, 1.0},
                                             EffectParameter{"y_G", "m", 0.1, -1.0, 1.0},
                                             EffectParameter{"z_G", "m", 0.1, -1.0, 1.0}};
constexpr double kSmallestSpeed = 0.01;  // m/s, rad/s

/// The pairs of axes that a component couples: translation, rotation.
constexpr std::array<std::array<std::array<std::size_t, 2>, 2>, 3> kPairs{
    {{{{1, 5}, {2, 4}}}, {{{0, 5}, {2, 3}}}, {{{0, 4}, {1, 3}}}}};

class CentreOff final : public OneOfMany {
 public:
  explicit CentreOff(int set) : OneOfMany{{.sought = numbers_of(set)}}, set_{set} {}
  FormName name(const Scene& scene) const override {
    return when(set_ != 0 && set_ == asked_on(scene), names_of(kCentreOfMassParameters, set_));
  }
  Starts starts(const Scene&) const override {
    std::vector<double> start(kCentreOfMassParameters.size(), 0.0);
    for (std::size_t i = 0; i < start.size(); ++i) start[i] = in_set(set_, i) ? 0.01 : 0.0;
    return {start};
  }

  void load(const Motion& motion, EffectTheta theta, Load& load) const override {
    const Eigen::Vector3d r = components(theta, set_);
    if (r.isZero(0.0)) return;
    const double mass = motion.vehicle->mass;
    const Eigen::Matrix3d S = skew(r);
    Matrix6d& inertia = load.added_inertia();
    inertia.topRightCorner<3, 3>() -= mass * S;
    inertia.bottomLeftCorner<3, 3>() += mass * S;
    inertia.bottomRightCorner<3, 3>() -= mass * S * S;
    const Eigen::Vector3d v = motion.nu.head<3>(), w = motion.nu.tail<3>();
    const Eigen::Vector3d P = mass * w.cross(r), L = mass * r.cross(v + w.cross(r));
    load.wrench.head<3>() -= w.cross(P);
    load.wrench.tail<3>() -= w.cross(L) + v.cross(P);
  }

 private:
  static int asked_on(const Scene& scene) {
    const auto& dof = scene.vehicle->dof;
    if (!(scene.vehicle->mass > 0.0)) return 0;
    // An axis that is not simulated pushes those that are, as it is measured.
    const auto acts = [&](const auto& pair) {
      return (dof[pair[0]] || dof[pair[1]]) && std::ranges::all_of(pair, [&](std::size_t axis) {
               return scene.nu_rms[static_cast<Eigen::Index>(axis)] > kSmallestSpeed;
             });
    };
    int set = 0;
    for (std::size_t i = 0; i < kPairs.size(); ++i) {
      // A tilt that nobody measured pushes a heavy vehicle ahead as a centre of mass does that lies low.
      const bool like_tilt = i == 2 && !scene.attitude;
      if (!like_tilt && std::ranges::any_of(kPairs[i], acts)) set |= 1 << i;
    }
    return set;
  }

  int set_;
};

}  // namespace

const Effect& centre_of_mass() {
  static const Effect kEffect{
      {.name = "centre_of_mass",
       .sentence = "The origin of the vehicle file is not the centre of mass.",
       .revealed_by = "turning on the spot, thrust along one axis at a time, and turning while moving ahead",
       .stage = Stage::kBody,
       .amplitudes = 3,
       .feels_motion = false},
      kCentreOfMassParameters,
      form_per_set<CentreOff>()};
  return kEffect;
}

}  // namespace fathom::model::effects
