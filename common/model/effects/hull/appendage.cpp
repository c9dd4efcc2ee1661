// Physics: a part that the vehicle file does not have (an arm, a sampler, a lamp, a skirt that came loose) drags where
// it sticks out, at p_BC in B: F = -k |v_C| v_C with its own velocity past the water, v_C = v_r + w x p_BC, and the
// moment p_BC x F (the form of Morison's drag; Hoerner 1965, ch. 13 for drag of parts and their arms). Forms: `blunt`,
// as wide on all sides; `wider on one side`, F = -k |v_C| (u_C, e^a v_C, e^b w_C), a rod or a plate. Its place is
// sought along those axes in which it turns the vehicle, its height also where the vehicle sways. Takes energy, always.
// Ignores: its mass and added mass, linear drag, the hull's wake over it, a rod or plate across no axis. Revealed by
// straight runs along every axis, on which it turns the vehicle, and by turning on the spot. Confused with
// asymmetric_drag and cross_coupling (one pair of axes alone), tether_drag far from its fixed end, and, of a vehicle
// that hardly turns, with the hull's own drag and another place.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "common/model/attachment.hpp"
#include "common/model/component_set.hpp"
#include "common/model/hull_in_flow.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::effects {
namespace {

/// Logarithm of how much wider it is there than along x: a rod ten times.
constexpr EffectParameter wider(std::string_view name) {
  return {.name = name, .unit = "", .sigma = 1.0, .low = -5.0, .high = 5.0};
}
constexpr std::array kAppendageParameters{EffectParameter{"coefficient", "N/(m/s)^2", 10.0, 0.0, 1e4},
                                          wider("log_wider_y"),
                                          wider("log_wider_z"),
                                          kAttachment[0],
                                          kAttachment[1],
                                          kAttachment[2]};
constexpr std::size_t kY = 1, kZ = 2, kPlace = 3;  // the last: its first number
constexpr int kOnePart = 0;                        // all forms are laws of one and the same thing
constexpr double kStartShare = 0.2;                // of the thrust, where a search begins
constexpr double kSmallestSpeed = 0.01;            // m/s
constexpr double kBesideHull = 0.3;                // m, where the file does not tell the hull's size
constexpr double kOfHull = 0.5;                    // of its length, width, height: at the hull's skin

class PartOutside final : public OneOfMany {
 public:
  PartOutside(int set, NumberSet sides)
      : OneOfMany{{.sought = sought_of(set, sides), .obeys = kOnePart}}, set_{set}, sides_{sides} {}
  FormName name(const Scene& scene) const override {
    const Vehicle& vehicle = *scene.vehicle;
    const bool asked = set_ != 0 && set_ == attachment_set(vehicle, sways(scene)) && tells_sides(vehicle.dof);
    // Of a craft that lives by its flow, every part of the hull lifts and drags: body_lift and cross_flow have it.
    return when(asked && !lives_by_flow(vehicle), sides_.has(kY) ? "wider on one side" : "blunt");
  }
  Starts starts(const Scene& scene) const override {
    const double speed = std::max(scene.nu_rms.head<3>().norm(), kSmallestSpeed);
    const double coefficient = kStartShare * std::max(scene.tau_rms.head<3>().norm(), 1e-2) / (speed * speed);
    Starts starts;
    for (std::size_t i = 0; i < 3; ++i) {
      if (!in_set(set_, i)) continue;
      const double hull = scene.vehicle->hull[static_cast<Eigen::Index>(i)];
      for (const double side : {-1.0, 1.0}) {
        std::vector<double> start(kAppendageParameters.size(), 0.0);
        start[0] = coefficient;
        start[kPlace + i] = side * (hull > 0.0 ? kOfHull * hull : kBesideHull);
        starts.push_back(std::move(start));
      }
    }
    return starts;
  }
  void load(const Motion& motion, EffectTheta theta, Load& load) const override {
    if (theta[0] == 0.0) return;
    const Eigen::Vector3d p_BC = components(theta, set_, kPlace);
    const Vector6d nu_r = motion.nu_r();
    const Eigen::Vector3d v = nu_r.head<3>() + nu_r.tail<3>().cross(p_BC);
    const Eigen::Vector3d wide{1.0, std::exp(theta[kY]), std::exp(theta[kZ])};
    const Eigen::Vector3d drag = -theta[0] * v.norm() * wide.cwiseProduct(v);
    load.wrench.head<3>() += drag;
    load.wrench.tail<3>() += p_BC.cross(drag);
  }

 private:
  static NumberSet sought_of(int set, NumberSet sides) {
    NumberSet numbers{0};
    for (const std::size_t side : {kY, kZ}) {
      if (sides.has(side)) numbers.add(side);
    }
    for (std::size_t i = 0; i < 3; ++i) {
      if (in_set(set, i)) numbers.add(kPlace + i);
    }
    return numbers;
  }
  /// Whether the vehicle is pushed along the axes that the form tells apart, and along no other.
  [[nodiscard]] bool tells_sides(const std::array<bool, 6>& dof) const {
    return sides_.has(kY) ? dof[0] && dof[1] && dof[2] == sides_.has(kZ) : dof[0] || dof[1] || dof[2];
  }

  int set_;
  NumberSet sides_;
};

Forms every_part() {
  Forms all;
  for (const NumberSet sides : {NumberSet{}, NumberSet{kY, kZ}, NumberSet{kY}}) {
    for (int set = 0; set < kSetsOfThree; ++set) all.push_back(std::make_unique<PartOutside>(set, sides));
  }
  return all;
}

}  // namespace

const Effect& appendage() {
  static const Effect kEffect{{.name = "appendage",
                               .sentence = "A part that the vehicle file lacks sticks out and drags there.",
                               .revealed_by = "straight runs along every axis, and turning on the spot",
                               .finding = "Something sticks out and drags at x {attached_x}, y {attached_y}",
                               .stage = Stage::kBody,
                               .amplitudes = 1,
                               .feels_motion = false,
                               .takes_energy = true},
                              kAppendageParameters,
                              every_part()};
  return kEffect;
}

}  // namespace fathom::model::effects
