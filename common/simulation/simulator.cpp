#include "common/simulation/simulator.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/model/manoeuvres.hpp"
#include "common/simulation/hidden.hpp"
#include "common/simulation/truth.hpp"

namespace fathom::simulation {
namespace {

constexpr double kFaultMemory = 1.6;  // s: longer than the registry's longest latency

}  // namespace

struct Simulator::Slot {
  std::string name;
  Timing timing;
  std::unique_ptr<Sensor> sensor;
  std::int64_t count{};
  std::vector<Sample> held{};  ///< what it said last, for one that freezes
};

struct Simulator::Pending {
  Utime due{};
  std::uint64_t order{};
  Sample sample;
};

// Velocities of the past at the body's steps, so that a fault of a sensor can look back.
struct Simulator::Faults {
  std::vector<model::ActiveEffect> effects;
  double dt{};
  model::VelocityTrace past, scratch;
  Eigen::Index next{0};

  void remember(const Vector6d& nu) {
    past.col(next) = nu;
    next = (next + 1) % past.cols();
  }
  /// The newest column of the past is what is true now, unless `nu` is a little newer.
  Vector6d seen(const Vector6d& nu) {
    const Eigen::Index count = past.cols();
    for (Eigen::Index i = 0; i < count; ++i) scratch.col(i) = past.col((next + i) % count);
    scratch.col(count - 1) = nu;
    model::VelocityView view{scratch};
    for (const model::ActiveEffect& each : effects) each.effect->measure(view, dt, each.theta, each.variant);
    return scratch.col(count - 1);
  }
};

Simulator::Simulator(const model::Vehicle& vehicle, const model::Site& site, const Config& config, const Setup& setup)
    : vehicle_{vehicle},
      whole_{vehicle},
      site_{site},
      origin_{setup.origin},
      interval_{interval_of(config)},
      largest_{limit_of(config, vehicle)},
      allocation_{vehicle, largest_} {
  whole_.dof.fill(true);
  if (vehicle.hull.isZero()) throw InputError("vehicle " + vehicle.name + ": its file must state 'hull' for contacts");
  const std::optional<DerivativeTruth> derivatives = derivatives_of(config, vehicle_, site_, setup.seed);
  model::Model truth = derivatives ? derivative_model(vehicle_, whole_) : truth_of(config, vehicle_, whole_);
  StartPose start = start_of(config, site_, vehicle.hull);
  if (derivatives) {  // the chain decides how deep it hangs, and how much bow down
    const model::HangingRest rest = model::hanging_rest(vehicle_);
    start.p_WB.z() = rest.depth;
    start.tilt = rest.q_WB;
  }
  const BatteryTruth battery = battery_of(config);
  faults_ = std::make_unique<Faults>();
  const Occasion occasion{.vehicle = &vehicle_,
                          .site = &site_,
                          .start = start.p_WB,
                          .duration = setup.duration,
                          .righting = std::abs(truth.theta[model::index(model::BaseParameter::G_z)]),
                          .voltage = battery.full};
  std::vector<std::string> hide = setup.hide;
  if (!setup.model.empty()) {
    if (derivatives)
      throw InputError(setup.model + ": the truth of this configuration has derivatives in place of these numbers");
    const model::LearnedModel learned = model::read_learned(setup.model, vehicle);
    for (const auto& [name, value] : learned.parameters)
      truth.theta[model::index(*model::parameter_from_name(name))] = value;
    hide.insert(hide.end(), learned.effects.begin(), learned.effects.end());
    learned_ = learned.force;
    if (learned_) truth.add({.effect = learned_.get()});
  }
  for (const std::string& text : hide) {
    model::ActiveEffect effect = hidden_effect(text, occasion, setup.seed);
    if (effect.effect->measures()) {
      faults_->effects.push_back(std::move(effect));
    } else {
      truth.add(std::move(effect));
    }
  }
  const Utime step = microseconds(config, "step");
  faults_->dt = static_cast<double>(step) * 1e-6;
  faults_->past.setZero(6, static_cast<Eigen::Index>(kFaultMemory / faults_->dt));
  faults_->scratch = faults_->past;
  const double mass = truth.theta.head<3>().minCoeff();
  const double weight = vehicle.mass > 0.0 ? vehicle.mass * site.gravity : mass * site.gravity;
  body_ = std::make_unique<Body>(std::move(truth), Hull{site_, vehicle.hull, mass, weight}, battery, start, origin_,
                                 step, derivatives);
  told_voltage_ = battery.full;
  truth_period_ = utime_after(0, 1.0 / config.positive("truth_rate", "Hz"));
  next_truth_ = origin_;
  for (const std::string& text : setup.fail) failures_.push_back(Failure::parse(text));
  const Config sensors = config.section("sensors");
  for (const SensorKind& kind : sensor_kinds()) {
    if (!sensors.has(kind.name)) continue;
    const Config one = sensors.section(kind.name);
    const Timing timing{one, kind.name, setup.seed};
    auto sensor =
        kind.make(one, {.vehicle = &vehicle_, .site = &site_, .seed = setup.seed, .ahrs = &ahrs_, .raw = setup.raw});
    using Pictures = SensorKind::Pictures;
    const bool replaced = kind.pictures == (setup.pictures ? Pictures::kWithout : Pictures::kWith);
    if (!carried_at(one, site_) || replaced) sensor.reset();
    if (sensor) slots_.push_back({kind.name, timing, std::move(sensor)});
  }
  if (setup.pictures && std::none_of(slots_.begin(), slots_.end(), [](const Slot& s) { return s.name == "camera"; })) {
    sensors.fail("camera", "pictures are wanted, and no camera is carried at " + site_.name);
  }
  feedback_ = std::ranges::any_of(slots_, [](const Slot& slot) { return slot.name == kThrusterFeedback; });
  if (!feedback_) slots_.push_back({kThrusterFeedback, Timing{}, nullptr});
  for (const Failure& failure : failures_) {
    if (std::none_of(slots_.begin(), slots_.end(), [&](const Slot& slot) { return slot.name == failure.sensor; })) {
      throw InputError("--fail " + failure.sensor + ": this instrument is not carried at " + site_.name);
    }
  }
}

Simulator::~Simulator() = default;

void Simulator::begin_at(Utime origin) {
  origin_ = next_truth_ = origin;
  body_->begin_at(origin);
}

void Simulator::command(const WrenchCommand& command) { heard_ = command; }

Utime Simulator::now() const { return body_->now(); }
Moment Simulator::moment() const { return body_->at(body_->now()); }
const ContactCounts& Simulator::contacts() const { return body_->contacts(); }

std::vector<std::string> Simulator::sensors() const {
  std::vector<std::string> names;
  names.reserve(slots_.size());
  for (const Slot& slot : slots_) {
    if (slot.sensor) names.push_back(slot.name);
  }
  return names;
}

// What the thrusters are told now: by a driver, or as one would allocate.
model::Allocated Simulator::sent() const {
  if (driven_ && vehicle_.curve.empty()) {
    std::vector<double> force = *driven_;
    for (double& each : force) each = std::clamp(each, -largest_, largest_);
    return allocation_.applied_forces(force);
  }
  if (driven_) return allocation_.applied(*driven_, told_voltage_);
  const bool alive = acting_ && seconds_between(acting_->utime, now()) <= acting_->life && acting_->tau.allFinite();
  return alive ? allocation_.allocate(acting_->tau, told_voltage_) : allocation_.neutral();
}

// What the propellers make of it at the true voltage.
void Simulator::actuate() {
  const Utime utime = now();
  const model::Allocated sent = this->sent();
  complaint_ = allocation_.complaint(sent);
  scale_ = sent.scale;
  told_ = {.utime = utime, .pwm_us = sent.pwm_us, .force = sent.force, .has_tau = true};
  std::copy(sent.tau.begin(), sent.tau.end(), told_.tau.begin());
  if (!feedback_) tell(slots_.back(), utime);
  const double volts = body_->voltage();
  model::ActuatorForces force(static_cast<Eigen::Index>(sent.force.size()));
  for (std::size_t i = 0; i < sent.force.size(); ++i) {
    force[static_cast<Eigen::Index>(i)] = sent.pwm_us.empty()
                                              ? sent.force[i]
                                              : vehicle_.curve.force_at(sent.pwm_us[i], vehicle_.thrusters[i].pwm_sign,
                                                                        volts > 0.0 ? volts : vehicle_.curve.voltage);
  }
  body_->drive(force);
}

void Simulator::take(Slot& slot, Utime until) {
  if (!slot.sensor) return;
  for (Utime utime = slot.timing.taken(origin_, slot.count); utime <= until;
       utime = slot.timing.taken(origin_, ++slot.count)) {
    if (!slot.timing.works(utime)) continue;
    Moment moment = body_->at(utime);
    if (!faults_->effects.empty()) moment.nu_seen = faults_->seen(moment.nu);
    moment.told = &told_;
    taken_.clear();
    slot.sensor->measure(moment, taken_);
    for (const Sample& sample : taken_) {
      if (const auto* ahrs = std::get_if<Ahrs>(&sample)) ahrs_.hear(*ahrs, moment);
      if (const auto* battery = std::get_if<Battery>(&sample)) told_voltage_ = battery->voltage;
    }
    const Utime due = utime + slot.timing.latency() + (failures_.empty() ? 0 : spoil(slot, utime));
    for (Sample& sample : taken_) pending_.push_back({due, order_++, std::move(sample)});
  }
}

// What the thrusters' driver says of what it sends, unless it fails.
void Simulator::tell(Slot& driver, Utime utime) {
  taken_.assign(1, told_);
  const Utime due = utime + (failures_.empty() ? 0 : spoil(driver, utime));
  for (Sample& sample : taken_) pending_.push_back({due, order_++, std::move(sample)});
}

// Failures of this instrument, applied to what it just said; what they add to its latency.
Utime Simulator::spoil(Slot& slot, Utime utime) {
  Utime later = 0;
  bool frozen = false;
  for (const Failure& failure : failures_) {
    if (failure.sensor != slot.name || !failure.acts(seconds_between(origin_, utime))) continue;
    simulation::fail(failure, utime, taken_, slot.held);
    frozen = frozen || failure.kind == Failure::Kind::kFrozen;
    if (failure.kind == Failure::Kind::kDelay) later += utime_after(0, failure.by);
  }
  if (!frozen && !taken_.empty()) slot.held = taken_;
  return later;
}

void Simulator::deliver(Utime until) {
  out_.clear();
  due_.clear();
  std::sort(pending_.begin(), pending_.end(),
            [](const Pending& a, const Pending& b) { return a.due != b.due ? a.due < b.due : a.order < b.order; });
  std::size_t due = 0;
  for (; due < pending_.size() && pending_[due].due <= until; ++due) {
    out_.push_back(std::move(pending_[due].sample));
    due_.push_back(pending_[due].due);
  }
  pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(due));
}

const std::vector<Sample>& Simulator::step() {
  actuate();
  const Utime end = now() + interval_;
  if (now() == origin_) {
    for (Slot& slot : slots_) take(slot, origin_);
  }
  while (now() < end) {
    body_->step();
    if (!faults_->effects.empty()) faults_->remember(body_->at(now()).nu);
    for (Slot& slot : slots_) {
      // A drive that is read as its command changes tells the new one, which comes with the next interval.
      const bool of_commands = slot.name == kThrusterFeedback;
      take(slot, of_commands ? now() - 1 : now());
    }
    for (; next_truth_ <= now(); next_truth_ += truth_period_) {
      const Moment moment = body_->at(std::max(next_truth_, now() - body_->step_length()));
      pending_.push_back({moment.utime, order_++,
                          Truth{.utime = moment.utime,
                                .p_WB = moment.p_WB,
                                .q_WB = moment.q_WB,
                                .nu = moment.nu,
                                .nu_dot = moment.nu_dot,
                                .v_WF = moment.v_WF,
                                .tau_felt = moment.tau_felt}});
    }
  }
  deliver(end);
  acting_ = heard_;
  return out_;
}

Secrets Simulator::secrets() const {
  Secrets secrets{.theta = body_->model().theta, .effects = body_->model().effects, .contacts = body_->contacts()};
  secrets.effects.insert(secrets.effects.end(), faults_->effects.begin(), faults_->effects.end());
  for (const Slot& slot : slots_) {
    if (!slot.sensor) continue;
    for (const auto& [name, value] : slot.sensor->drawn()) secrets.drawn.emplace_back(slot.name + "." + name, value);
  }
  return secrets;
}

}  // namespace fathom::simulation
