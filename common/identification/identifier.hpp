// The on-line identifier: STATE and THRUSTERS in, MODEL and RESIDUAL out. States meet inputs by their time stamps,
// never by the order of arrival, so that a replay over the network and a log read directly give the same numbers to the
// last bit.
#pragma once

#include <array>
#include <deque>
#include <iosfwd>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/identification/effect_track.hpp"
#include "common/identification/integral_regressor.hpp"
#include "common/identification/misfit.hpp"
#include "common/identification/recursive.hpp"
#include "common/identification/stream_aligner.hpp"
#include "common/model/vehicle.hpp"
#include "common/samples/commands.hpp"
#include "common/samples/estimates.hpp"
#include "common/samples/sensors.hpp"

namespace fathom {
class Config;
}

namespace fathom::identification {

struct IdentifierSettings {
  double window{2.0};              ///< s, of the integral regressor
  double stride{0.5};              ///< s between updates
  double max_gap{0.35};            ///< s between states beyond which the window starts over
  double memory{0.0};              ///< s that an update stays in memory; 0: for ever
  double noise_force{0.5};         ///< N, sigma of a window's average
  double noise_acceleration{0.0};  ///< m/s^2 likewise, of STATE's: times the expected mass it is a force
  double noise_velocity{0.0};      ///< m/s, STATE's sigma up to which that holds; beyond, it grows with it; 0: never
  double noise_moment{0.1};        ///< N m
  bool interpolate_input{true};    ///< false: a command holds until the next
  double max_input_gap{0.5};       ///< s; a state between inputs further apart is not used
  double max_skew{0.5};            ///< s by which one channel may lag the other without changing the result
  bool buoyant{false};             ///< W-B is known to be negative
  bool from_zero{false};           ///< begins with all parameters zero and one sigma, as the paper does
  double zero_sigma{10.0};       ///< of every parameter in its own unit (the paper's P_0 = sigma^2 I), for its vehicle
  double residual_memory{30.0};  ///< s over which MODEL's residual statistics look back
  double velocity_scale{0.0};   ///< share by which u v w may be off in proportion: no residual shows it, intervals must
  double velocity_offset{0.0};  ///< m/s by which each of u v w may be off all the time: drag makes a steady force of it
  double attitude_offset{0.0};  ///< rad by which roll and pitch may be off all the time: it turns the restoring moment
  double rate_offset{0.0};      ///< rad/s by which each of p q r may be off all the time: drag makes a moment of it
  double freeze_delay{0.5};     ///< s after its stamp that a wish to freeze is obeyed: more than any channel is late
  int adopt_after{0};           ///< rankings in a row that must accept an effect before it is adopted; 0: none ever is
  double adopt_delay{2.0};      ///< s after its stamp that a ranking is judged: more than the diagnoser is late
  double keep{600.0};           ///< s of motion that are kept to learn anew from when an effect is adopted
  bool joint{false};            ///< MODEL carries the numbers of the joint estimate (common/joint), where there is one

  /// Keys: window, stride, max_gap, memory, noise_force, noise_moment, input (linear or hold), max_input_gap, max_skew,
  /// buoyant; optional: prior (vehicle or zero) with prior_sigma, residual_memory, velocity_scale,
  /// velocity_offset, attitude_offset, rate_offset, noise_acceleration with noise_velocity, freeze_delay, adopt_after
  /// with adopt_delay and keep, estimate (recursive or joint).
  [[nodiscard]] static IdentifierSettings from(const Config& config);
};

class Identifier {
 public:
  /// What one call released, in the order of message time; there is one residual and one model per update.
  struct Output {
    std::vector<ModelEstimate> models;
    std::vector<Residual> residuals;
    std::vector<RowBlock> blocks;  ///< the rows that each update took in
    std::vector<ParameterMatrix>
        bends;  ///< of each model, its share of the covariance that is for what the model lacks
    [[nodiscard]] bool empty() const { return models.empty(); }
    void clear() {
      models.clear();
      residuals.clear();
      blocks.clear();
      bends.clear();
    }
  };

  /// InputError when the vehicle enables a parameter that nobody knows, none at all, or leaves a prior without sigma.
  Identifier(const IdentifierSettings& settings, const model::Vehicle& vehicle);

  /// The reference is good until the next call.
  const Output& step(const StateEstimate& state);
  /// `force` times the vehicle's allocation, else `tau`; a sample with neither is rejected.
  const Output& step(const Thrusters& thrusters);
  /// What the numbers of model() keep to.
  [[nodiscard]] const Signs& signs() const { return estimator_.signs(); }
  /// The wrench [N, N m] that such a sample applies, after step() has heard it; nothing when it was rejected.
  [[nodiscard]] std::optional<Vector6d> wrench(const Thrusters& thrusters) const;
  /// Which parameters shall not be learnt from then on; unknown names are nobody's.
  void hear(const Excitation& excitation);
  /// What the diagnoser thinks is missing. An effect that it accepts again and again is adopted: all that is kept of
  /// the motion is learnt from anew, with the effect in the model and its numbers learnt like all others.
  void hear(const EffectRanking& ranking);
  void hear(const Battery& battery) { voltage_ = battery.voltage; }
  /// A log started over: back to the prior, nothing pending.
  void reset();

  /// The model as it stands.
  [[nodiscard]] ModelEstimate model() const;
  /// What the base parameters may be off by for what the model lacks: in the covariance of model().
  [[nodiscard]] ParameterMatrix bend() const;
  /// False when this vehicle has no such parameter. A frozen one is neither learnt nor forgotten.
  bool freeze(std::string_view parameter);
  bool resume(std::string_view parameter);
  [[nodiscard]] const RecursiveEstimator& estimator() const { return estimator_; }
  [[nodiscard]] const RecursiveEstimator::State& save() const { return estimator_.state(); }
  void restore(const RecursiveEstimator::State& state) { estimator_.restore(state); }
  /// Everything learnt as text, for a file; and such a text offered to a new process. It is taken when the first state
  /// comes at most `within` [s] after it was written; a file of another vehicle, time or run is left alone.
  [[nodiscard]] std::string save_text() const;
  void offer(const std::string& text, double within);
  /// True when an offered state was taken.
  [[nodiscard]] bool resumed() const { return resumed_; }
  /// The effect in the model, or nullptr.
  [[nodiscard]] const model::ActiveEffect* adopted() const { return track_ ? &track_->effect() : nullptr; }
  /// Samples not used, by reason: "late", "state invalid", "no force", "not finite", "no input".
  [[nodiscard]] const std::map<std::string, std::int64_t>& rejected() const { return rejected_; }

 private:
  /// Recent residuals of one axis, each divided by its standard deviation.
  struct Recent {
    double weight{};
    double mean{};
    double square{};
    double product{};  ///< of one with the next
    double last{};
    double speed{};  ///< m/s or rad/s along this axis, magnitude; not divided; 0 without quadratic drag
  };
  struct Wish {
    Utime utime{};
    std::vector<std::string> frozen;
  };
  [[nodiscard]] std::optional<model::ActuatorForces> input_of(const Thrusters& thrusters) const;
  void reject(const char* reason) { ++rejected_[reason]; }
  void obey(Utime utime);
  void remember(const RowBlock& block);
  void decide(Utime first);
  void take_effect(const model::Effect& effect, std::istringstream& text);
  void add_metrics(ModelEstimate& estimate, const RecursiveReport& report) const;
  [[nodiscard]] double moment_of_offsets(int axis, const RecursiveReport& report) const;
  void compensate(RecursiveReport& report) const;
  void doubt_unmoved(RecursiveReport& report) const;
  void add_systematic(RecursiveReport& report) const;
  void release();
  void use(const EffectSample& sample);
  [[nodiscard]] std::optional<RowBlock> rows_of(const EffectSample& sample);
  void keep(const EffectSample& sample);
  void weigh(Utime utime);
  void adopt(const EffectEvidence& found);
  bool try_on(model::ActiveEffect effect);
  void prefer(int plain);
  [[nodiscard]] bool explains() const;
  [[nodiscard]] bool vanishes() const;
  void drop();
  void follow(model::ActiveEffect effect, const ParameterVector& base);
  enum class Held { kNothing, kEffect, kMoment };  // of an adopted effect's numbers
  void learn_anew(Held held = Held::kNothing);
  void find_moment(model::ActiveEffect& effect);
  [[nodiscard]] double moved() const;
  bool relearn();
  [[nodiscard]] double cost_with(const model::ActiveEffect& effect, const ParameterVector& base);
  [[nodiscard]] model::Model base_model(const ParameterVector& estimate) const;
  [[nodiscard]] RecursiveSettings estimator_settings(const model::ActiveEffect* effect) const;
  void add_effect(ModelEstimate& estimate, const RecursiveReport& report) const;
  [[nodiscard]] int column(std::string_view parameter) const;
  [[nodiscard]] int column(model::BaseParameter parameter) const;

  enum class InputKind { kUnknown, kForce, kWrench };

  IdentifierSettings settings_;
  std::unique_ptr<const model::Vehicle> vehicle_;
  InputKind input_{InputKind::kUnknown};
  std::vector<model::BaseParameter> parameters_;
  IntegralRegressor regressor_;
  RecursiveEstimator estimator_;
  StreamAligner aligner_;
  Utime model_utime_{};
  std::array<Recent, 6> recent_{};
  Misfit misfit_;
  std::vector<Wish> wishes_;            // in the order of time, not yet obeyed
  std::deque<EffectRanking> rankings_;  // likewise, not yet judged
  EffectEvidence leader_;               // accepted in the last rankings
  int in_a_row_{}, without_{};
  std::deque<EffectSample> kept_;
  std::unique_ptr<EffectTrack> track_;
  ParameterVector linearised_at_;  // base parameters of the track
  std::vector<double> stuck_at_;   // numbers of the effect around which it fitted no better; empty: not so
  int stands_for_{-1};             // variant that was named where the ordinary form was adopted
  double cost_{};                  // squared innovations over their variance since all was learnt anew
  Utime origin_{};                 // of the first motion used
  double voltage_{};
  std::vector<std::string> frozen_;
  std::string offered_;
  double offered_within_{};
  bool resumed_{false};
  Output output_;
  std::map<std::string, std::int64_t> rejected_;
};

}  // namespace fathom::identification
