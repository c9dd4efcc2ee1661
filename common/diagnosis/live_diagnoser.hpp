// The diagnoser on line: STATE, THRUSTERS and BATTERY in, EFFECTS out. A fast screening in a filtered regression: each
// candidate's wrench along the measured motion is averaged with the same windows as the base model's rows, and asked
// how much of the residual it explains that the base parameters cannot. Pure and blind to the order of arrival.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/diagnosis/live_evidence.hpp"
#include "common/diagnosis/places.hpp"
#include "common/identification/integral_regressor.hpp"
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
  double largest_ratio{0.0};  ///< of the residual's power in MODEL to the noise's: beyond, nothing is adequate; 0: any

  /// Keys: as the members above in their order, with input (linear or hold) for interpolate_input; largest_ratio is
  /// optional.
  [[nodiscard]] static LiveSettings from(const Config& config);
};

class LiveDiagnoser {
 public:
  LiveDiagnoser(const LiveSettings& settings, const model::Vehicle& vehicle);

  /// A ranking follows the first state of each new block.
  std::optional<EffectRanking> step(const StateEstimate& state);
  /// The first usable message decides how forces are known: `force`, else the vehicle's curve over `pwm_us`, else
  /// `tau`.
  std::optional<EffectRanking> step(const Thrusters& thrusters);
  std::optional<EffectRanking> step(const Battery& battery);
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
  struct Sample {
    identification::MotionSample motion;
    Eigen::Vector3d p_WB;
    Eigen::Quaterniond q_WB;
    model::ActuatorForces force;
    double boost{1.0};  ///< factor of the voltage on a curve's force
    double voltage{};
    bool has_position{};
  };
  struct Candidates {  // what exists after the warm-up
    Candidates(const model::Model& base, const model::Scene& scene, const Eigen::VectorXd& information,
               std::vector<LiveEvidence::Mass> masses, std::size_t most_blocks)
        : columns{base, scene}, evidence{columns, information, std::move(masses), most_blocks} {}
    LiveCandidates columns;
    LiveEvidence evidence;
    std::vector<WrenchColumns> wrench, momentum;  // ring, beside the regressor's
    std::size_t next{};
    std::size_t filled{};
    WrenchColumns filtered, rate;  // workspace
    Eigen::VectorXd row;
  };
  void reject(const char* reason) { ++rejected_[reason]; }
  std::optional<EffectRanking> release(bool all);
  [[nodiscard]] Sample sample_of(const identification::StreamAligner::Aligned& aligned);
  void record_input(const Sample& sample);
  void forget_motion();
  void prepare();
  void use(const Sample& sample, std::optional<EffectRanking>& ranking);
  void add(const identification::RowBlock& block);
  [[nodiscard]] model::Scene scene() const;
  [[nodiscard]] model::Model base_from_warm_up(Vector6d& sigma);
  [[nodiscard]] EffectRanking rank(Utime utime);
  [[nodiscard]] bool leaves_much(Utime utime);
  [[nodiscard]] identification::IntegralSettings integral_settings() const;

  LiveSettings settings_;
  std::unique_ptr<const model::Vehicle> vehicle_;
  std::vector<model::BaseParameter> parameters_;
  Source source_{Source::kUnknown};
  identification::StreamAligner aligner_;
  model::Model nominal_;
  std::vector<Sample> warm_up_;
  std::optional<Sample> last_;
  std::optional<Utime> origin_;
  Utime newest_{};                     // valid state used
  std::optional<std::int64_t> block_;  // number of the block that is filling
  Vector6d sigma_{Vector6d::Ones()};
  identification::ParameterVector prior_mean_;
  std::vector<Eigen::VectorXd> past_;  // commands on a uniform grid, for delays
  Utime past_begin_{};
  identification::IntegralRegressor regressor_;
  std::unique_ptr<Candidates> candidates_;
  Places places_;
  std::vector<LiveSuspicion> suspicions_;
  std::optional<std::pair<model::ActiveEffect, model::ActiveEffect>> rivals_;
  struct Left {
    Utime utime{};
    double ratio{};
  };
  std::deque<Left> left_;  // of MODEL, newest last
  std::map<std::string, std::int64_t> rejected_;
};

}  // namespace fathom::diagnosis
