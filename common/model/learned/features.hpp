// A free force: weights times functions of a model's own state and of what drives it. Weights are numbers of the
// fit with one Gaussian prior per group, so that a learned force is part of a model like any effect.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/spatial.hpp"
#include "common/model/motion.hpp"

namespace fathom::model {

/// Time constants of the low passes that features may run over, s. Files name them by their places. Those of thrust
/// stand so close that any time constant between two is a mixture of both.
constexpr std::array kThrustMemories{0.05, 0.15, 0.4, 1.2, 0.09, 0.25, 0.7, 2.0};
constexpr std::array kVelocityMemories{0.4, 1.5, 4.0};
constexpr std::array kUseMemories{10.0, 40.0};  // of how much an actuator has done: motors and windings warm

/// What features read at one instant.
struct FeatureState {
  double t{};  ///< s
  Eigen::Vector3d p_WB{Eigen::Vector3d::Zero()};
  Eigen::Matrix3d R_WB{Eigen::Matrix3d::Identity()};
  double heading_cosine{1.0}, heading_sine{0.0};
  Vector6d nu{Vector6d::Zero()};   ///< past the water, as the named effects have it move
  Vector6d tau{Vector6d::Zero()};  ///< wrench of the actuators as they reach the water
  model::ActuatorForces force{};   ///< N
  std::array<Vector6d, kThrustMemories.size()> slow_tau{};
  std::array<Vector6d, kVelocityMemories.size()> slow_nu{};
  std::array<model::ActuatorForces, kUseMemories.size()> use{};  ///< N: size of each actuator's force, lately
  Vector6d drag{Vector6d::Zero()};                               ///< N, N m: the hull's own by the base numbers
  /// What water does that moves toward N, E, D, N s/m and N s, and that gains speed toward there, N s^2/m and N s^2.
  Eigen::Matrix<double, 6, 3> by_stream{Eigen::Matrix<double, 6, 3>::Zero()};
  Eigen::Matrix<double, 6, 3> by_stream_rate{Eigen::Matrix<double, 6, 3>::Zero()};
  Vector6d by_mass{Vector6d::Zero()};  ///< m/s^2: what a mass at Bo holds back, -(v_dot + w x v)
  const Allocation* allocation{};      ///< tau = B f
  double voltage{};                    ///< V, of the supply; 0: not logged
  std::span<const double> columns{};   ///< as Motion::columns
};

/// FeatureState::by_mass
[[nodiscard]] Vector6d held_back_by_mass(const Vector6d& nu_dot, const Vector6d& nu);

/// Largest sizes that a recording has shown of what features read.
struct Visited {
  Vector6d nu{Vector6d::Zero()};                                                    ///< m/s, rad/s
  Vector6d tau{Vector6d::Zero()};                                                   ///< N, N m
  ActuatorForces force{};                                                           ///< N
  Eigen::Vector3d p_low{Eigen::Vector3d::Zero()}, p_high{Eigen::Vector3d::Zero()};  ///< m, box of positions
};

/// Times the visited size, up to which features are taken at their word: a table knows nothing beyond, a law in closed
/// form is believed as far again, like the base's own drag, beside which it was fitted.
constexpr double kVisitedReach = 1.15, kLawReach = 2.0;

/// What a factor reads: one kind each, in a source of factors/.
enum class Quantity : std::uint8_t {
#define FACTOR(enumerator, name) enumerator,
#include "common/model/learned/factors/factors.def"
#undef FACTOR
};
struct FactorKind;  ///< factors/factor_kind.hpp
[[nodiscard]] const FactorKind& kind_of(Quantity quantity);
/// As result.json names it.
[[nodiscard]] std::string_view word(Quantity quantity);
[[nodiscard]] std::optional<Quantity> quantity_from(std::string_view word);

struct Factor {
  Quantity quantity{};
  int index{}, bank{};
  double a{}, b{1.0}, c{1.0}, d{};
  std::string column{};  ///< what a measured column is called; others have none
  [[nodiscard]] bool operator==(const Factor&) const = default;
};

/// Along what a feature acts: X..N of the body; north, east and down of the world; all of the hull's drag; all thrust,
/// as it is applied; the line of each thruster; all thrusters by one law, each along its line and reading its own
/// force; all axes by one law, each reading its own thrust. Toward north, east and down as a velocity of the water,
/// too, which hull and effects feel as they feel any stream, and with the acceleration of water that swings: no force
/// that adds to others.
/// The levers G_x, G_y, G_z of weight and buoyancy, whose moment is G x down. A mass at Bo: inertia, no weight. A pull
/// on Bo toward the point of the world that its factor of kStretch names. The hull's drag against translation alone.
/// Last against the way past the water, each N s/m times the velocity: a drag that is the same on all sides.
constexpr int kWorldAxis = 6, kHullDrag = 9, kAllThrust = 10, kThrusterLine = 11;
constexpr int kEachThruster = kThrusterLine + kMaxActuators, kEachAxis = kEachThruster + 1;
constexpr int kStream = kEachAxis + 1;
constexpr int kLever = kStream + 3;
constexpr int kMass = kLever + 3;
constexpr int kPull = kMass + 1;
constexpr int kGoingDrag = kPull + 1;
constexpr int kAgainstWay = kGoingDrag + 1;
constexpr int kDirections = kAgainstWay + 1;
/// In words of a law of all thrusters or axes, in place of an index.
constexpr int kOwn = -1;
[[nodiscard]] std::string direction_words(int axis);  ///< "X", "north", "the hull's drag", "thruster 2"
/// What stands before the amplitude in an equation, Fossen's notation: "tau_Y =", "tau = b_2" (column of B).
[[nodiscard]] std::string direction_symbol(int axis);

struct Feature {
  int axis{};
  int count{};  ///< of factors
  std::array<Factor, 4> factors{};
  double scale{1.0};
  /// Scaled value: N, N m, N s/m against the way, m/s of a stream, kg of a mass, or a share of the drag or thrust that
  /// it acts along. Of a law of all thrusters or axes that of the one which its factors name.
  [[nodiscard]] double value(const FeatureState& state) const;
  [[nodiscard]] double rate(const FeatureState& state) const;  ///< of a swing's value, with the clock alone, per second
  /// How much it pushes, without sign: of a law of all thrusters or axes the root of their sum of squares, of a stream
  /// or a mass the force to first order.
  [[nodiscard]] double size(const FeatureState& state) const;
  /// This law for one of the thrusters or axes for which it holds; others are as they are.
  [[nodiscard]] Feature of_own(int own) const;
  /// For how many it holds: thrusters or axes; 1 for all others.
  [[nodiscard]] int owners(const FeatureState& state) const;
  [[nodiscard]] bool streams() const { return axis >= kStream && axis < kLever; }
  [[nodiscard]] bool levers() const { return axis >= kLever && axis < kMass; }
  [[nodiscard]] bool weighs() const { return axis == kMass; }
  [[nodiscard]] bool pulls() const { return axis == kPull; }
  [[nodiscard]] bool against_way() const { return axis == kAgainstWay; }
  [[nodiscard]] bool of_drag() const { return axis == kHullDrag || axis == kGoingDrag; }  ///< a share of it
  [[nodiscard]] bool moves_with_velocity() const;
  [[nodiscard]] bool depends_on_time() const;
  [[nodiscard]] bool swings() const;
  [[nodiscard]] bool remembers() const;     ///< reads low passes
  [[nodiscard]] std::string words() const;  ///< its product, Fossen's notation; empty: it is constant
  /// Of a stream or a mass what it does to first order.
  void add(const FeatureState& state, double weight, Vector6d& wrench) const;

 private:
  /// `own`: whose law it is; kOwn: of the one that the factors name.
  [[nodiscard]] double product(const FeatureState& state, int own) const;
};

struct FeatureGroup {
  std::string kind;  ///< in words: "depth", "thrust a moment ago"
  int axis{};
  int first{}, count{};  ///< of the features
  double sigma{0.05};    ///< of its weights
  bool searched{false};  ///< its moment or frequency was sought in the data
  bool closed{false};    ///< few columns that are a law together, none of a table of bumps or steps
};

struct Stream {
  Eigen::Vector3d v_WF{Eigen::Vector3d::Zero()};  ///< m/s
  Eigen::Vector3d a_WF{Eigen::Vector3d::Zero()};  ///< m/s^2, of what swings
};

struct FreeForce {
  std::vector<Feature> features;
  std::vector<FeatureGroup> groups;
  std::vector<double> weights;
  [[nodiscard]] bool empty() const { return features.empty(); }
  [[nodiscard]] Vector6d wrench(const FeatureState& state) const;  ///< without what streams and masses do
  [[nodiscard]] double mass(const FeatureState& state) const;      ///< kg
  [[nodiscard]] Stream stream(const FeatureState& state) const;
  [[nodiscard]] bool reads_drag() const;
  [[nodiscard]] bool streams() const;
};

}  // namespace fathom::model
