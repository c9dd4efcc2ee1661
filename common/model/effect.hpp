// One physical effect that a model may lack: one file in a folder of effects/ and one line in effects/effects.def.
// Simulator, identifier and diagnoser use the same object. What it is stands in its Traits; what it does, in its Forms
// (form.hpp): several laws, or the same law for each of several places, of which `variant` numbers one.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/model/form.hpp"

namespace fathom::model {

/// Where on the way from the command to the measurement an effect acts. Effects act in this order, those of one stage
/// in the order of effects.def.
enum class Stage {
  kCommand,  ///< on the command's way to the propellers, by command and time alone
  kThrust,   ///< on the thrust before it meets the water, by command, time and voltage alone
  kWater,    ///< how the water moves, and what that does to the thrust
  kBody,     ///< wrench and inertia on the hull
  kSensor    ///< on what the sensors say, not on what the vehicle does
};

struct Traits {
  std::string_view name;         ///< = file name = registry line
  std::string_view sentence;     ///< for people
  std::string_view revealed_by;  ///< the motion that shows it best
  /// What was found, for whoever repairs it: "{thruster} gives {gain_change more} than the file says". {form},
  /// {thruster}: where; {NUMBER}: with unit and interval; {NUMBER %}, {NUMBER more}: a share; {NUMBER late}: a time.
  std::string_view finding{};
  Stage stage{Stage::kBody};
  /// How many leading numbers it is proportional to; the others say where, when or how fast. 0: not told apart.
  int amplitudes{0};
  bool forms_coexist{false};  ///< several forms can act at once: results must say which one a number belongs to
  bool knows_size{false};     ///< its numbers' sigmas are already those of the data at hand
  bool feels_motion{true};    ///< false: feel() changes the thrust by command, time and voltage alone, or nothing
  bool feels_place{false};    ///< the wrench depends on where the vehicle is (not only on how it moves)
  /// The memory depends on how the vehicle has moved (not only on commands), or leaves a wrench rather than a thrust.
  /// advance() and feel() must then be linear in the relative velocity, the thrust and the memory, feel() by the memory
  /// alone, and alter w_memory alone, so that derivatives go the same way.
  bool remembers_motion{false};
  bool asked_first{false};  ///< the recording's business rather than the vehicle's: a force would stand in for it
  /// A craft that lives by its flow has it by its nature: it takes no place among the names of what is missing.
  bool own_flow{false};
  bool takes_energy{false};  ///< with positive amplitudes only; negative ones are fitted but belong to no water
};

class Effect {
 public:
  Effect(Traits traits, std::span<const EffectParameter> parameters, Forms forms);
  Effect(const Effect&) = delete;
  Effect& operator=(const Effect&) = delete;
  virtual ~Effect() = default;

  [[nodiscard]] const Traits& traits() const { return traits_; }
  [[nodiscard]] std::string_view name() const { return traits_.name; }
  [[nodiscard]] std::string_view sentence() const { return traits_.sentence; }
  [[nodiscard]] std::string_view revealed_by() const { return traits_.revealed_by; }
  [[nodiscard]] std::span<const EffectParameter> parameters() const { return parameters_; }
  [[nodiscard]] int amplitudes() const { return traits_.amplitudes; }
  [[nodiscard]] bool variants_matter() const { return traits_.forms_coexist; }
  [[nodiscard]] bool knows_size() const { return traits_.knows_size; }
  [[nodiscard]] bool feels_motion() const { return traits_.feels_motion; }
  [[nodiscard]] bool feels_place() const { return traits_.feels_place; }
  [[nodiscard]] bool remembers_motion() const { return traits_.remembers_motion; }
  [[nodiscard]] bool measures() const { return traits_.stage == Stage::kSensor; }

  [[nodiscard]] int form_count() const { return static_cast<int>(forms_.size()); }
  [[nodiscard]] const Form& form(int variant) const { return *forms_[static_cast<std::size_t>(variant)]; }
  /// Names of the forms on this data, by variant; "-": cannot act or be seen here. Empty: none can.
  [[nodiscard]] std::vector<std::string> variants(const Scene& scene) const;
  /// True when both forms are laws of one and the same thing, which obeys one of them: together they imitate another.
  [[nodiscard]] bool rules_out(int variant, int other) const;
  /// Of the number in that form of the effect.
  [[nodiscard]] std::string_view unit(int variant, std::size_t number) const;
  /// False when that form of the effect has no use for the number, or when it is given: no fit moves it.
  [[nodiscard]] bool takes_part(int variant, std::size_t number) const {
    return form(variant).traits().sought.has(number);
  }
  /// True when the start sets the number for others to refer to: the place at which a strength is meant, say.
  [[nodiscard]] bool is_given(int variant, std::size_t number) const {
    return form(variant).traits().given.has(number);
  }
  /// Whether results name the number.
  [[nodiscard]] bool is_told(int variant, std::size_t number) const {
    return takes_part(variant, number) || is_given(variant, number);
  }
  /// Places of the numbers that a fit seeks in that form, and how many they are.
  [[nodiscard]] std::vector<std::size_t> sought(int variant) const;
  [[nodiscard]] int numbers(int variant) const;
  [[nodiscard]] bool multiplies_drag(int variant) const { return form(variant).traits().multiplies_drag; }

  // The form's own, by its variant.
  [[nodiscard]] Starts starts(const Scene& scene, int variant) const { return form(variant).starts(scene); }
  [[nodiscard]] double left_open(EffectTheta theta, int variant, std::size_t number) const {
    return form(variant).left_open(theta, number);
  }
  [[nodiscard]] Unlisted looks_like(EffectTheta theta, int variant, const Scene& scene) const {
    return form(variant).looks_like(theta, scene);
  }
  [[nodiscard]] bool possible(EffectTheta theta, int variant, const Scene& scene) const {
    return form(variant).possible(theta, scene);
  }
  void feel(Motion& motion, EffectTheta theta, int variant, std::span<const double> z) const {
    form(variant).feel(motion, theta, z);
  }
  void load(const Motion& motion, EffectTheta theta, int variant, Load& load) const {
    form(variant).load(motion, theta, load);
  }
  void settle(const Motion& motion, EffectTheta theta, int variant, std::span<double> z) const {
    form(variant).settle(motion, theta, z);
  }
  void advance(const Motion& motion, EffectTheta theta, int variant, double dt, std::span<double> z) const {
    form(variant).advance(motion, theta, dt, z);
  }
  void measure(VelocityView& nu, double dt, EffectTheta theta, int variant) const {
    form(variant).measure(nu, dt, theta);
  }
  void unmeasure(VelocityView& nu, double dt, EffectTheta theta, int variant) const {
    form(variant).unmeasure(nu, dt, theta);
  }
  // Alike in all forms.
  [[nodiscard]] int state_size(const Vehicle&, int actuators) const { return forms_.front()->state_size(actuators); }
  [[nodiscard]] double run_in(EffectTheta theta) const { return forms_.front()->run_in(theta); }

 private:
  Traits traits_;
  std::vector<EffectParameter> parameters_;
  Forms forms_;
};

/// All effects, in the order in which they act.
[[nodiscard]] std::span<const Effect* const> all_effects();
/// The effect of that name, or nullptr.
[[nodiscard]] const Effect* find_effect(std::string_view name);

/// Whether it is one of those that change the thrust before it meets the water.
[[nodiscard]] inline bool changes_thrust(const Effect& effect) { return effect.traits().stage <= Stage::kThrust; }

/// An effect with numbers: part of a model.
struct ActiveEffect {
  const Effect* effect{};
  int variant{};
  std::string variant_name;
  std::vector<double> theta;
};

}  // namespace fathom::model
