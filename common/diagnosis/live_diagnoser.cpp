// Streams to samples to rows. Samples of the warm-up are kept, tell the scene, and are then used like all others.
#include "common/diagnosis/live_diagnoser.hpp"

#include <malloc.h>

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"

namespace fathom::diagnosis {
namespace {

constexpr double kMaxRate = 50.0;             // 1/s: fifty times the bandwidth of a 1 s window
constexpr double kPositionKnown = 5.0;        // m, std: worse than that says nothing about a tether
constexpr double kWarmUpGap = 5.0;            // s without motion after which a warm-up starts over
constexpr double kTurn = 2e-3;                // rad: smaller corrections of a turned sensor are not worth another pass
constexpr Utime kLongestSilence = 2'000'000;  // us: after that the grid of commands begins anew
constexpr double kWider = 2.0;                // times longer, and candidates are made for what was shown by then
constexpr std::size_t kOldPerNew = 8;
constexpr std::size_t kMostSeen = 60'000;  // samples: ten minutes at 100 Hz, some 12 MB; then what there is has to do

}  // namespace

LiveDiagnoser::LiveDiagnoser(const LiveSettings& settings, const model::Vehicle& vehicle,
                             const estimation::Corrections& corrections, const model::Site* site)
    : settings_{settings},
      vehicle_{std::make_unique<const model::Vehicle>(vehicle)},
      parameters_{[&] {
        std::vector<model::BaseParameter> columns;
        for (const std::string& name : vehicle.parameters) {
          const auto parameter = model::parameter_from_name(name);
          if (!parameter) throw InputError("vehicle '" + vehicle.name + "': unknown parameter '" + name + "'");
          columns.push_back(*parameter);
        }
        return columns;
      }()},
      aligner_{{.interpolate = settings.interpolate_input,
                .max_input_gap = settings.max_input_gap,
                .max_skew = settings.max_skew,
                .voltage = true}},
      prior_mean_{[&] {
        identification::ParameterVector mean(static_cast<Eigen::Index>(vehicle.priors.size()));
        for (Eigen::Index i = 0; i < mean.size(); ++i) mean[i] = vehicle.priors[static_cast<std::size_t>(i)].mean;
        return mean;
      }()},
      sensors_{corrections, site == nullptr ? std::optional<consistency::FlowWitnesses>{}
                                            : consistency::FlowWitnesses{vehicle.mounts, *site}} {}

identification::IntegralSettings LiveDiagnoser::integral_settings() const {
  identification::IntegralSettings s;
  s.window = settings_.window;
  s.stride = settings_.stride;
  s.max_gap = settings_.max_gap;
  s.max_rate = kMaxRate;
  s.dof = vehicle_->dof;
  s.parameters = parameters_;
  return s;
}

const std::vector<LiveForm>& LiveDiagnoser::forms() const {
  static const std::vector<LiveForm> kNone;
  return screening_ ? screening_->forms() : kNone;
}

std::optional<EffectRanking> LiveDiagnoser::step(const StateEstimate& state) {
  if (!aligner_.push(state)) {
    reject("late");
    return std::nullopt;
  }
  return release(false);
}

std::optional<EffectRanking> LiveDiagnoser::step(const Thrusters& thrusters) {
  const auto count = static_cast<Eigen::Index>(vehicle_->thrusters.size());
  const auto matches = [count](const std::vector<double>& values) {
    return count > 0 && static_cast<Eigen::Index>(values.size()) == count;
  };
  const bool has_force = matches(thrusters.force);
  const bool has_curve = matches(thrusters.pwm_us) && !vehicle_->curve.empty();
  if (source_ == Source::kUnknown && (has_force || has_curve || thrusters.has_tau)) {
    source_ = has_force ? Source::kForce : has_curve ? Source::kCurve : Source::kWrench;
    nominal_ = model::nominal_model(*vehicle_, source_ == Source::kWrench);
    seen_.begin(nominal_.allocation);
  }
  model::ActuatorForces input;
  if (source_ == Source::kForce && has_force) {
    input = Eigen::Map<const Eigen::VectorXd>(thrusters.force.data(), count);
  } else if (source_ == Source::kCurve && has_curve) {
    input.resize(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto j = static_cast<std::size_t>(i);
      input[i] =
          vehicle_->curve.force_at(thrusters.pwm_us[j], vehicle_->thrusters[j].pwm_sign, vehicle_->curve.voltage);
    }
  } else if (source_ == Source::kWrench && thrusters.has_tau) {
    input = Eigen::Map<const Vector6d>(thrusters.tau.data());
  } else {
    reject("no force");
    return std::nullopt;
  }
  if (!input.allFinite()) {
    reject("not finite");
    return std::nullopt;
  }
  if (!aligner_.push_input(thrusters.utime, input)) {
    reject("late");
    return std::nullopt;
  }
  return release(false);
}

std::optional<EffectRanking> LiveDiagnoser::step(const Battery& battery) {
  if (!(std::isfinite(battery.voltage) && battery.voltage > 0.0)) {
    reject("not finite");
    return std::nullopt;
  }
  if (!aligner_.push_voltage(battery.utime, battery.voltage)) reject("late");
  return release(false);
}

std::optional<EffectRanking> LiveDiagnoser::finish() {
  std::optional<EffectRanking> ranking = release(true);
  if (!screening_ && !seen_.empty()) {
    screening_ = screening();
    hear_all(*screening_);
  }
  sensors_.finish();
  turn_back(sensors_.turns());
  if (wider_) catch_up(seen_.size());
  if (screening_) screening_->close();
  return newest_ > 0 ? std::optional{rank(newest_)} : ranking;
}

std::optional<EffectRanking> LiveDiagnoser::release(bool all) {
  std::optional<EffectRanking> ranking;
  while (const auto aligned = aligner_.next(all)) {
    if (source_ == Source::kUnknown) {  // nothing to explain motion with yet
      reject("no input");
      continue;
    }
    sensors_.step(aligned->state);
    turn_back(sensors_.turns());
    LiveSample sample = sample_of(*aligned);
    const Utime utime = sample.motion.utime;
    if (sample.motion.valid) newest_ = utime;
    if (screening_) {
      if (sample.motion.valid) note_commands(sample);
      if (const auto until = screening_->use(sample)) ranking = rank(*until);
      keep(sample);
      continue;
    }
    if (!sample.motion.valid) continue;
    if (!seen_.empty() && seconds_between(seen_.last(), utime) > kWarmUpGap) forget_motion();
    note_commands(sample);
    seen_.keep(sample);
    shown_ = seconds_between(seen_.first(), utime);
    if (shown_ < settings_.warm_up) continue;
    screening_ = screening();
    hear_all(*screening_);
    ranking = rank(utime);
  }
  return ranking;
}

LiveSample LiveDiagnoser::sample_of(const identification::StreamAligner::Aligned& aligned) {
  const StateEstimate& state = aligned.state;
  LiveSample sample;
  sample.motion.utime = state.utime;
  if (!state.valid) {
    reject("state invalid");
  } else if (!(state.nu.allFinite() && state.q_WB.coeffs().allFinite() && state.p_WB.allFinite())) {
    reject("not finite");
  } else if (!aligned.input) {
    reject("no input");
  } else {
    sample.motion.valid = true;
    sample.motion.nu << turned_.dvl * state.nu.head<3>(), turned_.gyro * state.nu.tail<3>();
    sample.motion.down_B = down_of(state.q_WB);
    sample.p_WB = state.p_WB;
    sample.q_WB = state.q_WB;
    sample.has_position = state.sigma.head<3>().maxCoeff() < kPositionKnown;
    sample.voltage = aligned.voltage;
    sample.force = boost(sample.voltage) * *aligned.input;
    sample.motion.tau = nominal_.allocation * sample.force;
  }
  return sample;
}

/// Factor of the voltage on a curve's force.
double LiveDiagnoser::boost(double voltage) const {
  if (source_ != Source::kCurve || !(voltage > 0.0) || !(vehicle_->curve.voltage > 0.0)) return 1.0;
  return std::pow(voltage / vehicle_->curve.voltage, vehicle_->curve.voltage_exponent);
}

void LiveDiagnoser::note_commands(LiveSample& sample) {
  const Utime now = sample.motion.utime;
  if (!commands_end_ || now - *commands_end_ > kLongestSilence) {
    sample.commands_from = now;
    sample.commands.emplace_back(sample.force);
    commands_end_ = now + kCommandStep;
  }
  for (; *commands_end_ <= now; *commands_end_ += kCommandStep) {
    const auto input = aligner_.input_at(*commands_end_);
    sample.commands.emplace_back(input ? Eigen::VectorXd{boost(sample.voltage) * *input}
                                       : Eigen::VectorXd{sample.force});
  }
}

std::unique_ptr<LiveScreening> LiveDiagnoser::screening() const {
  return std::make_unique<LiveScreening>(LiveBasis{.vehicle = *vehicle_,
                                                   .parameters = parameters_,
                                                   .prior_mean = prior_mean_,
                                                   .nominal = nominal_,
                                                   .input_is_wrench = source_ == Source::kWrench,
                                                   .block = settings_.block,
                                                   .max_gap = settings_.max_gap,
                                                   .most_blocks = static_cast<std::size_t>(settings_.most_blocks),
                                                   .mounting = settings_.mounting,
                                                   .integral = integral_settings()},
                                         seen_, screening_ ? std::optional{screening_->sigma()} : std::nullopt);
}

void LiveDiagnoser::hear_all(LiveScreening& screening) const {
  LiveSample sample;
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    seen_.get(i, sample);
    (void)screening.use(sample);
  }
}

// A pass over all that was seen takes seconds, which nobody has at once: with every new sample it is told a few old
// ones, and hears them beside the trial.
void LiveDiagnoser::keep(const LiveSample& sample) {
  if (!all_seen_) return;
  const bool valid = sample.motion.valid;
  const double shown = seconds_between(seen_.first(), sample.motion.utime);
  seen_.keep(sample);
  if (!wider_ && valid && shown >= kWider * shown_) {
    look_again();
    shown_ = shown;
  }
  if (wider_) catch_up(kOldPerNew);
  if (!wider_ && seen_.size() > kMostSeen) {
    all_seen_ = false;
    seen_.clear();
    malloc_trim(0);  // tens of megabytes in small pieces, which would stay with the process
  }
}

void LiveDiagnoser::look_again() {
  wider_ = std::make_unique<BackgroundPass>(screening());
  caught_up_ = 0;
}

// A sensor whose axes are turned makes motion that forces seem to couple. Nothing is accused until all that was seen
// has been heard again, turned back.
void LiveDiagnoser::turn_back(const LiveSensorCheck::Turns& turns) {
  const Eigen::Matrix3d dvl = turns.dvl * turned_.dvl.transpose(), gyro = turns.gyro * turned_.gyro.transpose();
  const auto matters = [](const Eigen::Matrix3d& R) { return !R.isIdentity(kTurn); };
  if (!matters(dvl) && !matters(gyro)) return;
  turned_ = turns;
  seen_.turn(dvl, gyro);
  if (!screening_ || !all_seen_) return;
  turning_ = true;
  look_again();
}

void LiveDiagnoser::catch_up(std::size_t samples) {
  LiveSample sample;
  for (; samples > 0 && caught_up_ < seen_.size(); --samples) {
    seen_.get(caught_up_++, sample);
    wider_->hear(sample);
  }
  if (caught_up_ < seen_.size()) return;
  screening_ = wider_->finish();
  wider_.reset();
  turning_ = false;
}

}  // namespace fathom::diagnosis
