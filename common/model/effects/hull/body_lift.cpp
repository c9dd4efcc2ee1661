// Physics: a hull that goes at an angle to its path lifts, as its fins do, and its Munk moment is not the ideal one of
// its added masses: forces and moments as products of the speed ahead and of the speed across or of turning, on
//   Y and N by v and r,  Z and M by w and q      (Y_uv, N_uv, Y_ur, N_ur, Z_uw, M_uw, Z_uq, M_uq: Prestero 2001,
//   sec. 4.3
// and 4.5; Feldman 1979), each a form of its own: w_i = c u_r nu_r,j, which turns round when the craft goes astern, as
// Munk's moment does, beside what the base model's added masses make of the same product; and w_i = c |u_r| nu_r,j,
// which does not, as fins that lift either way. What fixed fins do at no deflection is among them. Hull and fins
// together, each a surface at x that lifts with the water's angle there: Y = -|u| (S v + S_x r), N = -|u| (S_x v +
// S_xx r), up and down Z = -|u| (H w - H_x q), M = |u| (H_x w - H_xx q), with S, S_x, S_xx and H, H_x, H_xx the sums of
// 1/2 rho A C_L over all surfaces, times x and x^2 (strip theory of quasi-steady lift, Newman 1977, sec. 7.9). A
// surface at an angle is drawn ahead by the suction at its nose, less what its wake takes: X = E_S (S v^2 + 2 S_x v r +
// S_xx r^2) u / |(u, v)|, E_S = 1 - C_L' / (pi AR) of an elliptic wing (Prandtl's lifting line; Fossen 2021, sec. 9.7),
// some .5; up and down E_H with H, w and -q. What the actuators give of a fin that turns is its lift by its deflection
// alone, in straight flow. Its whole law is that of an angle, alpha = delta - atan(across, along) as far as the stall,
// at the speed V past it, its propeller's wash included: lift q V^2 alpha square to the flow, and D_S times q V^2
// alpha^2 along it (D_S = C_L' / (pi e AR), some .5). F_S, some 1, is the share of what that law adds to the lift: that
// a drifting fin resists being carried across, in the wash most of all, leans back, and stalls by its whole angle.
// A vehicle file that names a standard set and its coefficients (`hydrodynamics: {model: mmg_3}`) gives one law more:
// what was published of the craft beside its base model, times a share, some 1 (standard_set.hpp).
// Every craft that steers by its flow has that, and no free force is told from others beside a base model that lacks
// it: so it is asked for before anything else. Ignores: stall of the hull. Revealed by drifting and turning at several
// speeds ahead and astern, and at rest. Confused with linear drag across at one speed, with masses that serve inertia
// and Coriolis moment at once, with speed_drag, and E_S with turning_resistance.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "common/model/actuators.hpp"
#include "common/model/manoeuvring/standard_set.hpp"
#include "common/model/speed_products.hpp"

namespace fathom::model::effects {
namespace {

// Results name both ways by their numbers: S sideways, H up and down.
constexpr std::array kBodyLiftParameters{EffectParameter{.name = "coefficient", .unit = "N/(m/s)^2", .sigma = 20.0},
                                         EffectParameter{.name = "S", .unit = "N/(m/s)^2", .sigma = 60.0},
                                         EffectParameter{.name = "S_x", .unit = "N/(m/s)/(rad/s)", .sigma = 30.0},
                                         EffectParameter{.name = "S_xx", .unit = "N m/(m/s)/(rad/s)", .sigma = 30.0},
                                         EffectParameter{.name = "E_S", .unit = "", .sigma = 0.5},
                                         EffectParameter{.name = "D_S", .unit = "1/rad", .sigma = 0.5},
                                         EffectParameter{.name = "F_S", .unit = "", .sigma = 1.0},
                                         EffectParameter{.name = "H", .unit = "N/(m/s)^2", .sigma = 60.0},
                                         EffectParameter{.name = "H_x", .unit = "N/(m/s)/(rad/s)", .sigma = 30.0},
                                         EffectParameter{.name = "H_xx", .unit = "N m/(m/s)/(rad/s)", .sigma = 30.0},
                                         EffectParameter{.name = "E_H", .unit = "", .sigma = 0.5},
                                         EffectParameter{.name = "D_H", .unit = "1/rad", .sigma = 0.5},
                                         EffectParameter{.name = "F_H", .unit = "", .sigma = 1.0},
                                         EffectParameter{.name = "share", .unit = "", .sigma = 1.0, .low = 0.0}};
constexpr std::size_t kSideways = 1, kUpAndDown = 7;  // where the numbers of each begin
constexpr std::size_t kShare = kBodyLiftParameters.size() - 1;
constexpr std::size_t kLift = 0, kLiftX = 1, kLiftXX = 2, kSuction = 3, kDrag = 4, kWhole = 5;
constexpr double kSlowest = 0.02;  // m/s, rad/s RMS: less shows no lift
constexpr double kNoFlow = 1e-9;   // m/s: no angle to a flow that is none

constexpr Eigen::Index kU = 0;

/// All surfaces that stand one way: `across` 1 with yaw, or 2 with pitch. With fins that turn, lift costs resistance.
class LiftingSurfaces final : public Form {
 public:
  LiftingSurfaces(Eigen::Index across, bool fins, std::string name)
      : Form{{.sought = numbers_of(first_of(across), fins), .drawn = kDrawn}},
        across_{across},
        fins_{fins},
        name_{std::move(name)} {}
  FormName name(const Scene& scene) const override {
    const Vehicle& vehicle = *scene.vehicle;
    const bool moves = scene.nu_rms[kU] > kSlowest && scene.nu_rms[across_] > 0.25 * kSlowest;
    return when(lives_by_flow(vehicle) && vehicle.dof[static_cast<std::size_t>(across_)] &&
                    vehicle.dof[static_cast<std::size_t>(turning())] && moves && fins_turn(scene) == fins_,
                name_);
  }
  Starts starts(const Scene& scene) const override {
    const double product = std::max(scene.nu_rms[kU] * scene.nu_rms[across_], 1e-4);
    std::vector<double> start(parameters().size(), 0.0);
    start[first_of(across_) + kLift] = 0.05 * std::max(scene.tau_rms[kU], 1e-3) / product;
    return {start};
  }
  void load(const Motion& motion, EffectTheta all, Load& load) const override {
    const EffectTheta theta = all.subspan(first_of(across_));
    const Vector6d nu_r = motion.nu_r();
    // A surface at x moves across by v + x r, or w - x q.
    const double speed = std::abs(nu_r[kU]), side = across_ == 1 ? 1.0 : -1.0;
    const double along = nu_r[across_], turn = side * nu_r[turning()];
    load.wrench[across_] -= speed * (theta[kLift] * along + theta[kLiftX] * turn);
    load.wrench[turning()] -= side * speed * (theta[kLiftX] * along + theta[kLiftXX] * turn);
    const double past = std::hypot(nu_r[kU], along);
    if (theta[kSuction] != 0.0 && past > 0.0) {
      const double square =
          theta[kLift] * along * along + 2.0 * theta[kLiftX] * along * turn + theta[kLiftXX] * turn * turn;
      load.wrench[kU] += theta[kSuction] * square * nu_r[kU] / past;
    }
    const bool fins = theta[kDrag] != 0.0 || theta[kWhole] != 0.0;
    if (!fins || motion.vehicle == nullptr) return;
    const auto& thrusters = motion.vehicle->thrusters;
    if (static_cast<std::size_t>(motion.force.size()) != thrusters.size()) return;
    for (std::size_t i = 0; i < thrusters.size(); ++i) {
      if (!stands(thrusters[i])) continue;
      const Eigen::Vector3d force_B =
          beside_straight_flow(motion, thrusters[i], motion.force[static_cast<Eigen::Index>(i)], theta);
      load.wrench.head<3>() += force_B;
      load.wrench.tail<3>() += thrusters[i].p_BJ.cross(force_B);
    }
  }

 private:
  static constexpr double kDrawn = 0.2;
  static constexpr std::size_t first_of(Eigen::Index across) { return across == 1 ? kSideways : kUpAndDown; }
  static constexpr NumberSet numbers_of(std::size_t first, bool fins) {
    NumberSet set{first + kLift, first + kLiftX, first + kLiftXX, first + kSuction};
    if (fins) set.add(first + kDrag), set.add(first + kWhole);
    return set;
  }
  [[nodiscard]] Eigen::Index turning() const { return across_ == 1 ? 5 : 4; }
  [[nodiscard]] bool stands(const Thruster& one) const {
    return one.fin.has_value() && std::abs(one.axis_B[across_]) > 0.7;
  }
  [[nodiscard]] bool fins_turn(const Scene& scene) const {
    return !scene.input_is_wrench &&
           std::ranges::any_of(scene.vehicle->thrusters, [this](const Thruster& one) { return stands(one); });
  }
  /// N in B: what the whole law of a fin adds to its lift in straight flow, `told` N at the reference speed.
  [[nodiscard]] static Eigen::Vector3d beside_straight_flow(const Motion& motion, const Thruster& one, double told,
                                                            EffectTheta theta) {
    const Fin& fin = *one.fin;
    const Eigen::Vector3d v_r = motion.nu_r().head<3>() + motion.nu.tail<3>().cross(one.p_BJ);
    double square = v_r.x() * std::abs(v_r.x());  // (m/s)^2, negative astern
    if (fin.behind >= 0) square += fin.slipstream * std::max(acting_force(*motion.vehicle, motion, fin.behind), 0.0);
    const double along = std::copysign(std::sqrt(std::abs(square)), square), across = one.axis_B.dot(v_r);
    const double speed = std::hypot(along, across);
    if (speed < kNoFlow) return Eigen::Vector3d::Zero();
    const double drift = std::atan2(across, std::abs(along)) * (along < 0.0 ? -1.0 : 1.0);
    const double alpha = std::clamp(told / fin.slope - drift, -fin.stall, fin.stall);
    const double q = fin.slope / (fin.reference_speed * fin.reference_speed);   // N/rad per (m/s)^2
    const double lift = q * speed * alpha, drag = theta[kDrag] * lift * alpha;  // per m/s of the flow
    return (-theta[kWhole] * lift * across - drag * along) * Eigen::Vector3d::UnitX() +
           (theta[kWhole] * (lift * along - q * square * told / fin.slope) - drag * across) * one.axis_B;
  }

  Eigen::Index across_;
  bool fins_;
  std::string name_;
};

/// The set that the vehicle file names, as published.
class PublishedSet final : public Form {
 public:
  PublishedSet() : Form{{.sought = {kShare}}} {}
  FormName name(const Scene& scene) const override {
    const auto& h = scene.vehicle->hydrodynamics;
    const bool beyond_base = h && h->named && !h->coefficients.empty() && !h->set->is_base;
    return when(beyond_base && lives_by_flow(*scene.vehicle) && scene.nu_rms.maxCoeff() > kSlowest,
                beyond_base ? "as published: " + std::string{h->set->name} : std::string{});
  }
  Starts starts(const Scene&) const override {
    std::vector<double> start(parameters().size(), 0.0);
    start[kShare] = 1.0;
    return {start};
  }
  void load(const Motion& motion, EffectTheta theta, Load& load) const override {
    if (theta[kShare] == 0.0 || motion.vehicle == nullptr || !motion.vehicle->hydrodynamics) return;
    load.wrench += theta[kShare] * beside_base(*motion.vehicle, motion);
  }
};

Forms every_product() {
  using Sense = SpeedProduct::Sense;
  constexpr std::array<std::array<Eigen::Index, 2>, 8> kLoadedBy{
      {{1, 1}, {5, 1}, {1, 5}, {5, 5}, {2, 2}, {4, 2}, {2, 4}, {4, 4}}};
  Forms all;
  for (const Sense sense : {Sense::kWithSign, Sense::kEitherWay}) {
    for (const auto& [row, column] : kLoadedBy) all.push_back(std::make_unique<SpeedProduct>(row, kU, column, sense));
  }
  for (const Eigen::Index across : {1, 2}) {
    const std::string way = across == 1 ? ", sideways" : ", up and down";
    all.push_back(std::make_unique<LiftingSurfaces>(across, false, "hull" + way));
    all.push_back(std::make_unique<LiftingSurfaces>(across, true, "hull and fins" + way));
  }
  all.push_back(std::make_unique<PublishedSet>());
  return all;
}

}  // namespace

const Effect& body_lift() {
  static const Effect kEffect{
      {.name = "body_lift",
       .sentence = "The hull lifts: drifting and turning load it in proportion to its speed ahead.",
       .revealed_by = "drifting and turning at rest, at half and at full speed ahead",
       .stage = Stage::kBody,
       .amplitudes = static_cast<int>(kBodyLiftParameters.size()),
       .forms_coexist = true,
       .feels_motion = false,
       .asked_first = true,
       .own_flow = true},
      kBodyLiftParameters,
      every_product()};
  return kEffect;
}

}  // namespace fathom::model::effects
