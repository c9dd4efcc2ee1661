// Physics: a jet that meets the hull, or clings to it, drags it along (Coanda effect), and a part of the push is lost;
// but only while the jet goes that way: f_i = (1 - a) f_c,i where f_c,i has one sign. Forms: each thruster, ahead and
// astern; one of the two, or it is thruster_gain. Source: Nienhuis 1992 (thruster and hull); in open frames a
// battery or a bottle behind the propeller does the same. Ignores: that a deflected jet also pushes aside
// (thruster_misalignment). Revealed by that thruster driven both ways. Confused with thrust_asymmetry (of all at once).
#include <array>

#include "common/model/one_of_many.hpp"
#include "common/model/thruster_kinds.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kJetOnHullParameters{EffectParameter{"share_lost", "", 0.2, 0.0, 1.0}};

/// `sign`: of the thrust whose jet meets the hull.
class OneWay final : public OfThruster {
 public:
  OneWay(Eigen::Index thruster, double sign)
      : OfThruster{thruster, {.obeys = static_cast<int>(thruster)}}, sign_{sign} {}
  FormName name(const Scene& scene) const override {
    if (scene.input_is_wrench || !exists(scene)) return {};
    const Thruster& one = scene.vehicle->thrusters[place()];
    return when(is_propeller(one), one.name + (sign_ > 0.0 ? " ahead" : " astern"));
  }
  void feel(Motion& motion, EffectTheta theta, std::span<const double>) const override {
    if (thruster_ < motion.force.size() && sign_ * motion.force[thruster_] > 0.0)
      motion.force[thruster_] *= 1.0 - theta[0];
  }

 private:
  double sign_;
};

Forms both_ways_of_each() {
  Forms all;
  for (Eigen::Index thruster = 0; thruster < kMaxActuators; ++thruster)
    for (const double sign : {1.0, -1.0}) all.push_back(std::make_unique<OneWay>(thruster, sign));
  return all;
}

}  // namespace

const Effect& jet_on_hull() {
  static const Effect kEffect{{.name = "jet_on_hull",
                               .sentence = "One thruster's jet meets the hull one way, and a part of its push is lost.",
                               .revealed_by = "each thruster driven by itself, ahead and in reverse",
                               .finding = "{thruster} loses {share_lost %} of its push that way",
                               .stage = Stage::kThrust,
                               .forms_coexist = true,
                               .feels_motion = false},
                              kJetOnHullParameters,
                              both_ways_of_each()};
  return kEffect;
}

}  // namespace fathom::model::effects
