// The diagnoser on line: STATE, THRUSTERS and BATTERY in, EFFECTS out. A fast screening in a filtered regression: each
// candidate's wrench along the measured motion is averaged with the same windows as the base model's rows, and asked
// how much of the residual it explains that the base parameters cannot. Each time that the trial has become twice as
// long, candidates are made anew for all that it has shown by then, and hear all of it. Pure and blind to the order of
// arrival.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/diagnosis/background_pass.hpp"
#include "common/diagnosis/live_screening.hpp"
#include "common/diagnosis/live_sensor_check.hpp"
#include "common/identification/stream_aligner.hpp"
#include "common/model/vehicle.hpp"
#include "common/samples/estimates.hpp"
#include "common/samples/sensors.hpp"

namespace fathom {
class Config;
}

namespace fathom::diagnosis {

struct LiveSettings {
  double window{2.0};                ///< s, of the integral regressor
  double stride{1.0};                ///< s between rows
  double max_gap{0.35};              ///< s between states beyond which the window starts over
  double warm_up{30.0};              ///< s of motion that tell how large things are
  double block{10.0};                ///< s; blocks count as independent, and a ranking follows each
  int fewest_blocks{6};              ///< before any verdict
  int most_blocks{200};              ///< then pairs are merged
  double accept_log_odds{5.0};       ///< 150 to 1, after paying for parameters and candidates; as offline
  double smallest_reduction{0.005};  ///< of the residual (RMS): less changes no prediction
  double alias_correlation{0.6};     ///< of two effects' signatures: beyond, they may be one
  double alternative_log_odds{3.0};  ///< closer than this, two look-alikes are not told apart
  bool interpolate_input{true};      ///< false: a command holds until the next
  double max_input_gap{0.5};         ///< s
  double max_skew{0.5};              ///< s by which one channel may lag the others without changing the result
  double mounting{0.0};              ///< rad by which the attitude sensor's axes may be turned against the body's
  double largest_ratio{0.0};  ///< of the residual's power in MODEL to the noise's: beyond, nothing is adequate; 0: any

  /// Keys: as the members above in their order, with input (linear or hold) for interpolate_input; mounting and
  /// largest_ratio are optional.
  [[nodiscard]] static LiveSettings from(const Config& config);
};

class LiveDiagnoser {
 public:
  /// `corrections`: those that STATE is made with. `site`: where the tags are, if known.
  LiveDiagnoser(const LiveSettings& settings, const model::Vehicle& vehicle,
                const estimation::Corrections& corrections = {}, const model::Site* site = nullptr);
  LiveDiagnoser(const LiveDiagnoser&) = delete;  // its passes point into it
  LiveDiagnoser& operator=(const LiveDiagnoser&) = delete;

  /// A ranking follows the first state of each new block.
  std::optional<EffectRanking> step(const StateEstimate& state);
  /// The first usable message decides how forces are known: `force`, else the vehicle's curve over `pwm_us`, else
  /// `tau`.
  std::optional<EffectRanking> step(const Thrusters& thrusters);
  std::optional<EffectRanking> step(const Battery& battery);
  /// Compared with STATE: a sensor's fault is no force.
  void hear(const Ahrs& ahrs) { sensors_.hear(ahrs); }
  void hear(const Dvl& dvl) { sensors_.hear(dvl); }
  void hear(const TagPose& tag) { sensors_.hear(tag); }
  void hear(const OpticalFlow& flow) { sensors_.hear(flow); }
  /// What the identifier's model leaves, over the noise that it was told of. Counts by its time stamp.
  void hear(const ModelEstimate& model);
  /// The streams ended: what was waiting is used and judged.
  std::optional<EffectRanking> finish();
  void reset();

  /// Best numbers per form behind the last ranking, best first; names in forms().
  [[nodiscard]] const std::vector<LiveSuspicion>& suspicions() const { return suspicions_; }
  [[nodiscard]] const std::vector<LiveForm>& forms() const;
  /// The first candidate of the last ranking and the one that it cannot be told from, with the numbers of both.
  [[nodiscard]] const std::optional<std::pair<model::ActiveEffect, model::ActiveEffect>>& rivals() const {
    return rivals_;
  }
  /// Samples not used, by reason: "late", "state invalid", "no force", "not finite", "no input".
  [[nodiscard]] const std::map<std::string, std::int64_t>& rejected() const { return rejected_; }

 private:
  enum class Source { kUnknown, kForce, kCurve, kWrench };
  void reject(const char* reason) { ++rejected_[reason]; }
  std::optional<EffectRanking> release(bool all);
  [[nodiscard]] LiveSample sample_of(const identification::StreamAligner::Aligned& aligned);
  [[nodiscard]] double boost(double voltage) const;
  void note_commands(LiveSample& sample);
  void forget_motion();
  [[nodiscard]] std::unique_ptr<LiveScreening> screening() const;
  void keep(const LiveSample& sample);
  void hear_all(LiveScreening& screening) const;
  void look_again();
  void turn_back(const LiveSensorCheck::Turns& turns);
  void catch_up(std::size_t samples);
  [[nodiscard]] EffectRanking rank(Utime utime);
  [[nodiscard]] EffectRanking by_forces(Utime utime);
  struct Left {
    Utime utime{};
    double ratio{};                    // of the residual, for the last half minute or since an effect was adopted
    std::vector<std::string> effects;  // adopted
  };
  struct Named {
    std::string what;
    double explains{};
    int times{};
  };
  [[nodiscard]] const Left* model_before(Utime utime) const;
  [[nodiscard]] bool leaves_much(Utime utime) const;
  void doubt(EffectRanking& ranking);
  void prefer_plain();
  [[nodiscard]] identification::IntegralSettings integral_settings() const;

  LiveSettings settings_;
  std::unique_ptr<const model::Vehicle> vehicle_;
  std::vector<model::BaseParameter> parameters_;
  Source source_{Source::kUnknown};
  identification::StreamAligner aligner_;
  model::Model nominal_;
  identification::ParameterVector prior_mean_;
  SeenTrial seen_;  // all of the trial, as long as another pass may be made; the warm-up at first
  bool all_seen_{true};
  std::unique_ptr<LiveScreening> screening_;
  double shown_{};                         // s of the trial that its candidates were made for
  std::unique_ptr<BackgroundPass> wider_;  // for more of it, still behind
  std::size_t caught_up_{};                // samples of seen_ that it was told
  Utime newest_{};                         // valid state used
  std::optional<Utime> commands_end_;      // next instant on the grid of commands
  std::vector<LiveSuspicion> suspicions_;
  std::optional<std::pair<model::ActiveEffect, model::ActiveEffect>> rivals_;
  LiveSensorCheck sensors_;
  LiveSensorCheck::Turns turned_;  // back, in all of seen_
  bool turning_{false};            // the candidates at hand still rest on sensors that are turned
  struct {
    Utime begin{};
    Vector6d sum{Vector6d::Zero()};
    int count{};
  } ratio_;                // of MODEL's residuals since an effect was adopted, but for the warm-up
  std::deque<Left> left_;  // of MODEL, newest last
  Named named_;            // in the last rankings
  std::map<std::string, std::int64_t> rejected_;
};

}  // namespace fathom::diagnosis
