// One law that an effect can follow: its equation, and what a search has to know of it. Const, and every number that
// changes is passed in.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/model/motion.hpp"
#include "common/model/scene.hpp"

namespace fathom::model {

/// What no vehicle has more of than a share, where a simulator draws a number.
enum class DrawnWithin { kSigma, kRightingMoment, kVehicleMass };

/// One number of an effect, as it is on a small craft (effect_size.hpp). Zero means: the effect is absent.
struct EffectParameter {
  std::string_view name;
  std::string_view unit;
  double sigma{1.0};  ///< prior standard deviation around zero: what would be ordinary
  double low{-std::numeric_limits<double>::infinity()};
  double high{std::numeric_limits<double>::infinity()};
  double form_sigma{0.0};     ///< what the effect's assumed form alone leaves open, however good the data
  bool after_command{false};  ///< a time after the command: how commands are held is hardly told apart from it
  bool blurred{false};        ///< below its lower limit no data would tell: one that lies on it may be true
  DrawnWithin drawn_within{DrawnWithin::kSigma};
};

using EffectTheta = std::span<const double>;
using Starts = std::vector<std::vector<double>>;  ///< full parameter vectors at which a search begins
using FormName = std::optional<std::string>;

/// The name where the form can act and be seen.
[[nodiscard]] inline FormName when(bool seen, std::string name = "") {
  return seen ? FormName{std::move(name)} : std::nullopt;
}

/// Something that moves a vehicle in the same way and that no list holds, or that acts where it has not been.
struct Unlisted {
  std::string_view what;       ///< for people; empty: nothing is known to
  std::string_view told_by{};  ///< the motion that would tell the two apart
};

/// Numbers of an effect, by their places among its parameters.
class NumberSet {
 public:
  constexpr NumberSet() = default;
  constexpr NumberSet(std::initializer_list<std::size_t> places) {
    for (const std::size_t place : places) add(place);
  }
  [[nodiscard]] static constexpr NumberSet all() {
    NumberSet set;
    set.bits_ = ~std::uint32_t{0};
    return set;
  }
  constexpr void add(std::size_t place) { bits_ |= std::uint32_t{1} << place; }
  [[nodiscard]] constexpr bool has(std::size_t place) const { return (bits_ >> place & 1U) != 0; }

 private:
  std::uint32_t bits_{0};
};

struct FormTraits {
  NumberSet sought{NumberSet::all()};      ///< numbers that a fit moves; the form has no use for the others, or:
  NumberSet given{};                       ///< numbers that the start sets for others to refer to, such as a place
  std::optional<std::string_view> unit{};  ///< of the leading numbers, where it is not the one in the list
  int obeys{-1};                ///< forms that share it are laws of one and the same thing: only one of them is true
  bool multiplies_drag{false};  ///< the wrench is a share of the hull's drag: it changes with the base parameters
  double drawn{1.0};            ///< times sigma: how large a simulator draws the leading numbers
};

class Form {
 public:
  explicit Form(FormTraits traits = {}) : traits_{traits} {}
  virtual ~Form() = default;
  [[nodiscard]] const FormTraits& traits() const { return traits_; }
  /// Of the effect whose form it is.
  [[nodiscard]] std::span<const EffectParameter> parameters() const { return parameters_; }

  /// What results call it on this data ("thruster 3"); nothing where it cannot act or be seen.
  [[nodiscard]] virtual FormName name(const Scene&) const { return ""; }
  /// Where a search begins. Default: one start with every parameter at a tenth of its sigma.
  [[nodiscard]] virtual Starts starts(const Scene&) const;
  /// Standard deviation of the number that the form as it is computed leaves open, however good the data: within the
  /// width over which it rounds off an edge, say.
  [[nodiscard]] virtual double left_open(EffectTheta, std::size_t /*number*/) const { return 0.0; }
  /// What is known to look the same with these numbers, however good the data of this scene.
  [[nodiscard]] virtual Unlisted looks_like(EffectTheta, const Scene&) const { return {}; }
  /// False for numbers that nothing can have: a floor that drives off, a wall through which the vehicle has gone.
  [[nodiscard]] virtual bool possible(EffectTheta, const Scene&) const { return true; }

  /// Alters what is felt (forces that reach the water, the water's motion). `z` is the effect's memory.
  virtual void feel(Motion&, EffectTheta, std::span<const double> /*z*/) const {}
  /// Adds wrench and inertia. Sees the motion after all feel().
  virtual void load(const Motion&, EffectTheta, Load&) const {}
  /// Size of the memory z.
  [[nodiscard]] virtual int state_size(int /*actuators*/) const { return 0; }
  /// Memory at rest in this motion (steady state).
  virtual void settle(const Motion&, EffectTheta, std::span<double> /*z*/) const {}
  /// Memory after dt, exact for constant input. Sees the motion as felt before this effect.
  virtual void advance(const Motion&, EffectTheta, double /*dt*/, std::span<double> /*z*/) const {}
  /// Seconds of measured motion before a window that fill the memory. Of the time constants' size, but no smooth
  /// function of them: see run_in_for().
  [[nodiscard]] virtual double run_in(EffectTheta) const { return 3.0; }
  /// True velocities, `dt` apart, become measured ones, in place. Linear in the velocities, so that derivatives go the
  /// same way.
  virtual void measure(VelocityView& /*nu*/, double /*dt*/, EffectTheta) const {}
  /// The way back; at the ends of the stretch as well as it can be done.
  virtual void unmeasure(VelocityView& /*nu*/, double /*dt*/, EffectTheta) const {}

 private:
  friend class Effect;
  FormTraits traits_;
  std::span<const EffectParameter> parameters_;
};

using Forms = std::vector<std::unique_ptr<Form>>;

/// The forms of an effect, in the order of their variants.
template <class... F>
[[nodiscard]] Forms forms(F... each) {
  Forms all;
  (all.push_back(std::make_unique<F>(std::move(each))), ...);
  return all;
}

/// One form per thruster: F{its place}.
template <class F>
[[nodiscard]] Forms form_per_thruster() {
  Forms all;
  for (Eigen::Index i = 0; i < kMaxActuators; ++i) all.push_back(std::make_unique<F>(i));
  return all;
}

/// Four and a half time constants or somewhat more, 3 s at least and 48 at most, in steps: what a search moves a little
/// leaves it as it is.
[[nodiscard]] double run_in_for(double time_constant);

}  // namespace fathom::model
