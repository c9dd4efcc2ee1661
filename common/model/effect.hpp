// One physical effect that a model may lack: one file in effects/ and one line in effects/effects.def.
// Simulator, identifier and diagnoser use the same object; it is const, and every number that changes is passed in.
#pragma once

#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/model/motion.hpp"

namespace fathom::model {

/// A force that swings with time alone: cosine cos(omega t) + sine sin(omega t), t from the run's start.
struct Tone {
  double omega{};                                   ///< rad/s
  Eigen::Vector3d cosine{Eigen::Vector3d::Zero()};  ///< N in W
  Eigen::Vector3d sine{Eigen::Vector3d::Zero()};
};

/// What a data set offers and how large things are in it. Effects choose their variants and starting points from it.
struct Scene {
  const Vehicle* vehicle{};
  bool position{false}, attitude{false}, velocity{false}, rates{false};  ///< which groups were measured
  /// A sensor that kinematics has compared with another is corrected before anything is fitted: forces need not be
  /// asked.
  [[nodiscard]] bool velocity_checked() const { return velocity && position && attitude; }
  [[nodiscard]] bool rates_checked() const { return rates && attitude; }
  bool input_is_wrench{false};  ///< inputs are the six axes of the wrench, not single thrusters
  bool voltage{false};
  double duration{};         ///< s, longest run
  double t_low{}, t_high{};  ///< s, times within the runs that the data covers; equal: not known beforehand
  double mean_voltage{};     ///< V
  double voltage_range{};    ///< V
  Eigen::Vector3d p_low{Eigen::Vector3d::Zero()}, p_high{Eigen::Vector3d::Zero()};  ///< m, box of positions
  Vector6d nu_rms{Vector6d::Zero()};
  Vector6d tau_rms{Vector6d::Zero()};
  ActuatorForces force_rms{};  ///< N per actuator
  double tilt_rms{};           ///< horizontal share of the body's down axis; 0 when attitude was not measured
  /// Oscillating forces that a linear regression leaves in the longest run, most prominent first; empty when not known.
  std::vector<Tone> tones_horizontal{}, tones_vertical{};
};

/// One number of an effect, as it is on a small craft (effect_size.hpp). Zero means: the effect is absent.
struct EffectParameter {
  std::string_view name;
  std::string_view unit;
  double sigma{1.0};  ///< prior standard deviation around zero: what would be ordinary
  double low{-std::numeric_limits<double>::infinity()};
  double high{std::numeric_limits<double>::infinity()};
  double form_sigma{0.0};     ///< what the effect's assumed form alone leaves open, however good the data
  bool after_command{false};  ///< a time after the command: how commands are held is hardly told apart from it
  bool of_run{false};         ///< may be another in another run: a phase, a moment, where the water goes
  bool blurred{false};        ///< below its lower limit no data would tell: one that lies on it may be true
};

using EffectTheta = std::span<const double>;

/// Something that no list holds and that moves a vehicle in the same way.
struct Unlisted {
  std::string_view what;       ///< for people; empty: nothing is known to
  std::string_view told_by{};  ///< the motion that would tell the two apart
};

class Effect {
 public:
  virtual ~Effect() = default;
  [[nodiscard]] virtual std::string_view name() const = 0;         ///< = file name = registry line
  [[nodiscard]] virtual std::string_view sentence() const = 0;     ///< for people
  [[nodiscard]] virtual std::string_view revealed_by() const = 0;  ///< the motion that shows it best
  [[nodiscard]] virtual std::span<const EffectParameter> parameters() const = 0;

  /// The forms it can take on this data ("thruster 3"); one unnamed form by default. Empty: cannot act or be seen here.
  [[nodiscard]] virtual std::vector<std::string> variants(const Scene&) const { return {""}; }
  /// Of the number in that form of the effect.
  [[nodiscard]] virtual std::string_view unit(int /*variant*/, std::size_t number) const {
    return parameters()[number].unit;
  }
  /// False when that form of the effect has no use for the number, or when it is given: no fit moves it.
  [[nodiscard]] virtual bool takes_part(int /*variant*/, std::size_t /*number*/) const { return true; }
  /// True when the start sets the number for others to refer to: the place at which a strength is meant, say.
  [[nodiscard]] virtual bool is_given(int /*variant*/, std::size_t /*number*/) const { return false; }
  /// Whether results name the number.
  [[nodiscard]] bool is_told(int variant, std::size_t number) const {
    return takes_part(variant, number) || is_given(variant, number);
  }
  /// Standard deviation of the number that the form as it is computed leaves open, however good the data: within the
  /// width over which it rounds off an edge, say.
  [[nodiscard]] virtual double left_open(EffectTheta, int /*variant*/, std::size_t /*number*/) const { return 0.0; }
  /// How many numbers a fit seeks in that form.
  [[nodiscard]] int numbers(int variant) const;
  /// True when several forms can act at once, so that results must say which one a number belongs to.
  [[nodiscard]] virtual bool variants_matter() const { return false; }
  /// True when both forms are laws of one and the same thing, which obeys one of them: together they imitate another.
  [[nodiscard]] virtual bool rules_out(int variant, int other) const { return variant == other; }
  /// Where a search begins: full parameter vectors. Default: one start with every parameter at a tenth of its sigma.
  [[nodiscard]] virtual std::vector<std::vector<double>> starts(const Scene&, int variant) const;

  /// True when its numbers' sigmas are already those of the data at hand.
  [[nodiscard]] virtual bool knows_size() const { return false; }
  /// How many leading numbers the effect is proportional to; the others say where, when or how fast.
  [[nodiscard]] virtual int amplitudes() const { return 0; }
  /// Sizes at which the effect reshapes the whole model, so that it can only be recognised with the base parameters
  /// fitted anew (its small sizes may even look harmful). Tried by full fits; none by default.
  [[nodiscard]] virtual std::vector<std::vector<double>> far_starts(const Scene&, int /*variant*/) const { return {}; }
  /// What is known to look the same as that form with these numbers, however good the data of this scene.
  [[nodiscard]] virtual Unlisted looks_like(EffectTheta, int /*variant*/, const Scene&) const { return {}; }
  /// False where the vehicle cannot have been, were these numbers true: inside a wall, say; everywhere for numbers that
  /// nothing can have.
  [[nodiscard]] virtual bool possible(const Eigen::Vector3d& /*p_WB*/, EffectTheta, int /*variant*/) const {
    return true;
  }
  /// Alters what is felt (forces that reach the water, the water's motion). `z` is the effect's memory.
  virtual void feel(Motion&, EffectTheta, int /*variant*/, std::span<const double> /*z*/) const {}
  /// Adds wrench and inertia. Sees the motion after all feel().
  virtual void load(const Motion&, EffectTheta, int /*variant*/, Load&) const {}
  /// False when feel() changes the thrust by command, time and voltage alone: derivatives then need not ask it.
  [[nodiscard]] virtual bool feels_motion() const { return true; }
  /// True when the thrust is not the same where a gain, or a lag, comes before it as where that comes after it.
  [[nodiscard]] virtual bool order_matters() const { return false; }
  /// True when the wrench is a share of the hull's drag: it then changes with the base parameters.
  [[nodiscard]] virtual bool multiplies_drag(int /*variant*/) const { return false; }
  /// True when the wrench depends on where the vehicle is (not only on how it moves).
  [[nodiscard]] virtual bool feels_place() const { return false; }
  /// True when the memory depends on how the vehicle has moved (not only on commands). advance() and feel() must then
  /// be linear in the relative velocity and the memory, and alter w_memory alone, so that derivatives go the same way.
  [[nodiscard]] virtual bool remembers_motion() const { return false; }
  /// Size of the memory z.
  [[nodiscard]] virtual int state_size(const Vehicle&, int /*actuators*/) const { return 0; }
  /// Memory at rest in this motion (steady state).
  virtual void settle(const Motion&, EffectTheta, int /*variant*/, std::span<double> /*z*/) const {}
  /// Memory after dt, exact for constant input. Sees the motion as felt before this effect.
  virtual void advance(const Motion&, EffectTheta, int /*variant*/, double /*dt*/, std::span<double> /*z*/) const {}
  /// Seconds of measured motion before a window that fill the memory. Of the time constants' size, but no smooth
  /// function of them: see run_in_for().
  [[nodiscard]] virtual double run_in(EffectTheta) const { return 3.0; }
  /// True when it alters what the sensors say, not what the vehicle does.
  [[nodiscard]] virtual bool measures() const { return false; }
  /// True velocities, `dt` apart, become measured ones, in place. Linear in the velocities, so that derivatives go the
  /// same way.
  virtual void measure(VelocityView& /*nu*/, double /*dt*/, EffectTheta, int /*variant*/) const {}
  /// The way back; at the ends of the stretch as well as it can be done.
  virtual void unmeasure(VelocityView& /*nu*/, double /*dt*/, EffectTheta, int /*variant*/) const {}
};

/// Four and a half time constants or somewhat more, 3 s at least and 48 at most, in steps: what a search moves a little
/// leaves it as it is.
[[nodiscard]] double run_in_for(double time_constant);

/// All effects, in the order in which they act: from the command to the water.
[[nodiscard]] std::span<const Effect* const> all_effects();
/// The effect of that name, or nullptr.
[[nodiscard]] const Effect* find_effect(std::string_view name);

/// Whether it is one of those that change the thrust before it meets the water.
[[nodiscard]] bool changes_thrust(const Effect& effect);

/// An effect with numbers: part of a model.
struct ActiveEffect {
  const Effect* effect{};
  int variant{};
  std::string variant_name;
  std::vector<double> theta;
  bool last{false};  ///< acts on the thrust that the others leave, not on the command
};

}  // namespace fathom::model
