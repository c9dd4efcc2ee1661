// The answer of `fathom diagnose`: what result.json holds and the report shows. Field names are those of the file.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/samples/correction.hpp"
#include "common/samples/estimates.hpp"

namespace fathom {

/// One disagreement between two sensors (or a statement that a signal is doubtful).
struct ConsistencyFinding {
  std::string run;        ///< recording it was found in; "all" when pooled
  std::string signal;     ///< e.g. "gyro.r", "dvl.u"
  std::string reference;  ///< e.g. "pose_capture"
  std::string finding;    ///< "delay", "scale", "bias", "sign", "axes", "lever_arm", "noise", "gap", ...
  double size{};
  std::string unit;
  std::string evidence;   ///< one sentence with the numbers
  std::string action;     ///< what the fit does about it: "corrected", "trusted pose_capture", "reported only"
  double std{};           ///< of the size; 0 where it is a count or was not estimated
  double freedom{};       ///< degrees of freedom of std
  std::string or_else{};  ///< the other signal that may be wrong in its place; empty: none
};

/// Open-loop prediction error at one horizon. Axis order u v w p q r; NaN where the axis is not simulated.
struct PredictionError {
  double horizon_s{};
  std::array<double, 6> rmse{};  ///< m/s, rad/s
  std::array<double, 6> r2{};
  /// One-sided p-values, over windows, of foretelling half of the motion, and as much of it as its average does. What
  /// the sensors' noise adds is allowed for. 1 where nothing is told.
  std::array<double, 6> p_half{1.0, 1.0, 1.0, 1.0, 1.0, 1.0};
  std::array<double, 6> p_average{1.0, 1.0, 1.0, 1.0, 1.0, 1.0};
};

/// Errors of one model on the validation runs.
struct ModelError {
  std::map<std::string, double> force_rmse;  ///< per axis letter X Y Z K M N, N or N m
  std::vector<PredictionError> prediction;
};

/// How far the runs that judge can be foretold from a measured start.
struct Foretold {
  int windows{};     ///< predictions
  int cut{};         ///< of them, where a small change of the start has grown fivefold: errors count so far only
  double typical{};  ///< s, the middle one of those lengths
};

constexpr double kNoMemory = 0.4;    ///< s: white noise shows half of what a residual is the mean over, .25 to .35 s
constexpr double kNotRandom = 0.01;  ///< p-value below which a residual counts as having a memory

/// What is known to make a residual swing.
constexpr std::string_view kWhatSwings =
    "waves of many frequencies, a tether or a load that hangs, or something that is missing where the vehicle itself "
    "is "
    "driven to and fro";

/// Residual of one degree of freedom.
struct AxisWhiteness {
  std::string axis;  ///< "X" .. "N"
  double p_value{};  ///< of the whiteness test (Ljung-Box on residuals that share no measurement)
  double autocorrelation_time_s{};
  double swing_period_s{std::numeric_limits<double>::quiet_NaN()};  ///< of a residual that swings; NaN: it does not
  double explained{};    ///< share of variance explained, of the applied wrench's axis; NaN where none is applied
  double applied_rms{};  ///< N or N m, of that wrench about its mean
  double noise{};  ///< what the sensors' white noise alone leaves of a residual, over the applied wrench's variance

  [[nodiscard]] bool remembers() const { return p_value < kNotRandom && autocorrelation_time_s >= kNoMemory; }
  [[nodiscard]] bool swings() const { return std::isfinite(swing_period_s); }
};

/// What to fly to tell an effect from another that explains the same.
struct ToldApart {
  std::string name;
  std::string segment;
  double seconds{};
};

/// Another effect that the data cannot rule out in the place of one that was found.
struct Alternative {
  std::string name;
  double log_odds{};  ///< natural, of the effect that was found over this one
};

struct EffectFound {
  std::string name;
  std::string variant;  ///< e.g. "thruster 3"; empty when the effect has one form only
  bool accepted{true};
  std::vector<NamedValue> parameters;
  double log_odds{};  ///< natural, over what is likeliest without it
  /// That the name is right: beside other names, and as often as names of such odds are right on data whose truth is
  /// known (docs/benchmark.md).
  double probability{1.0};
  std::vector<Alternative> alternatives;  ///< other effects that the data cannot rule out
  std::string sentence;
  std::vector<ToldApart> told_apart{};  ///< from some alternatives, by a segment; only where a site was given
};

/// A listed effect that takes up a part of what no listed effect explains. It claims no cause: it is a correction of
/// the numbers, as a learned force is.
struct StandIn {
  std::string name, variant;
  bool in_model{};      ///< it lowers the error on runs that no fit has seen, so the model after has it
  double size{};        ///< share of the applied acceleration, on its worst axis
  double over{};        ///< its force over what is left beside it on that axis; 0: not known
  double modulation{};  ///< rms by which its strength changes, as a share of it, with what else goes on; 0: not
  std::vector<NamedValue> parameters;
};

struct CandidateTried {
  std::string name;
  std::string variant;
  double log_odds{};  ///< natural; NaN where it was not asked
  std::string reason;
};

/// A group of signals that the data lacks: "position", "attitude", "velocity" or "rates".
struct NotMeasured {
  std::string group;
  std::vector<std::string> cannot_be_asked;  ///< effects that have no form without it
  std::string means{};                       ///< a sentence: what is not known without it; empty where nothing is lost
};

/// Thrusters that seem to be others, or to push the other way, than the vehicle's file says.
struct WiringFault {
  std::vector<std::string> readings;  ///< "T1 and T2 exchanged"; more than one where the data cannot tell them apart
  double error_reduction{};           ///< of the base model's error, were the file so
};

struct Interval {
  double value{};
  double low{};  ///< 95 %
  double high{};
};

struct DiagnosisResult {
  std::string vehicle;
  std::vector<std::string> train;
  std::vector<std::string> validate;
  std::vector<ConsistencyFinding> consistency;
  std::string verdict;    ///< "adequate", "effect", "ambiguous", "unexplained"; "unjudged": too short to say "adequate"
  std::string paragraph;  ///< verdict in plain words: how sure, and which manoeuvre would settle what is open
  std::string manoeuvre;  ///< the motion that would settle what is open; empty when nothing is (report only)
  std::vector<EffectFound> effects;
  std::vector<StandIn> stand_ins{};
  std::vector<CandidateTried> candidates;
  std::vector<NotMeasured> not_measured;
  ModelError error_before;
  ModelError error_after;
  std::optional<WiringFault> wiring{};
  Foretold foretold{};
  Interval improvement;  ///< relative reduction of the normalised 5 s prediction error on validation
  std::vector<NamedValue> parameters_before;
  std::vector<NamedValue> parameters_after;
  std::vector<AxisWhiteness> residual_before;
  std::vector<AxisWhiteness> residual_after;
  std::optional<CorrectionGiven> correction{};  ///< a learned force: no cause
};

/// One stretch of validation data with the open-loop predictions laid over it, for the plots.
struct PredictionTrace {
  std::string run;
  std::vector<double> t;                        ///< s
  std::vector<std::array<double, 6>> measured;  ///< u v w p q r
  std::vector<std::array<double, 6>> before;    ///< restarted at each window; NaN where not simulated
  std::vector<std::array<double, 6>> after;
  std::vector<std::array<double, 6>> residual_before;  ///< wrench residual X..N [N, N m]
  std::vector<std::array<double, 6>> residual_after;
  std::vector<std::array<double, 3>> position;  ///< m, NED
  std::vector<double> heading;                  ///< rad
  std::vector<std::array<double, 6>> tau;       ///< applied wrench, N, N m
  std::vector<double> voltage;                  ///< V; empty when not logged
  std::vector<std::size_t> restarts;            ///< indices into t where the predictions start anew, rising
};

/// Everything that the report draws.
/// Something that begins in a run that judges.
struct UnseenEvent {
  std::string run;
  double t{};  ///< s, of the run's clock
};

struct DiagnosisReport {
  DiagnosisResult result;
  std::vector<PredictionTrace> traces;  ///< validation runs
  std::optional<UnseenEvent> unseen_event{};
};

}  // namespace fathom
