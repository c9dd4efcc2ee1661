#include "processes/simulator/stage.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fathom_lcm/answer_t.hpp>
#include <fathom_lcm/operator_t.hpp>

#include "common/base/error.hpp"
#include "common/runtime/self.hpp"
#include "common/wire/channels.hpp"
#include "common/wire/minds.hpp"
#include "common/wire/signature.hpp"
#include "processes/simulator/speech.hpp"

namespace fathom::simulator {
namespace {

constexpr double kLook = 0.3;                        // s in which another simulator answers
constexpr double kPatience = 600.0;                  // s without an answer: a diagnoser searches all of a trial
constexpr double kComplain = 5.0;                    // s between two lines about who is missing
constexpr double kAfterwards = 2.0;                  // s of virtual time after the supervisor's end
constexpr double kToArm = 5.0;                       // s that a supervisor may take to obey
constexpr std::chrono::milliseconds kLinesPause{1};  // between two looks at the instruments' lines
constexpr double kAnswer = 0.5;                      // s between two words about what an order must quote
constexpr double kTooLate = 0.5;                     // intervals behind the wall's clock that count as late

void poll_for(std::span<const int> descriptors, double seconds) {
  std::vector<pollfd> watched;
  watched.reserve(descriptors.size());
  for (const int each : descriptors) watched.push_back({.fd = each, .events = POLLIN, .revents = 0});
  const timespec limit{.tv_sec = static_cast<time_t>(seconds),
                       .tv_nsec = static_cast<long>(1e9 * (seconds - std::floor(seconds)))};
  ppoll(watched.data(), watched.size(), &limit, nullptr);
}

Utime wall_utime() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

double seconds(std::chrono::steady_clock::duration duration) { return std::chrono::duration<double>(duration).count(); }

}  // namespace

Stage::Stage(runtime::Process& process, simulation::Simulator& simulator, Darkroom& darkroom, const Options& options,
             Instruments* instruments, const std::optional<model::ManoeuvrePilot>& pilot)
    : process_{process},
      simulator_{simulator},
      darkroom_{darkroom},
      options_{options},
      instruments_{instruments},
      schedule_{options.schedule()},
      gate_{static_cast<std::int64_t>(options.setup.seed % 1'000'000'000U) + 1},  // the same run gives the same log
      pilot_{pilot} {
  if (options.wait_for.empty()) return;
  conductor_.emplace(options.wait_for);
  process_.overhears([this](const std::string& channel, std::span<const std::uint8_t> bytes) {
    const bool own_order = channel == wire::kOperator;  // which keeps its place, unlike an operator's
    if (channel != runtime::kLockstep && (own_order || !runtime::is_free_channel(channel))) said_.add(channel, bytes);
  });
}

void Stage::hear(const WrenchCommand& command) { gate_.hear(command, simulator_.now()); }

// It ends as an operator would end it: some seconds after the last word, so that the log shows the vehicle at rest.
void Stage::hear(const Excitation& excitation) {
  ++excitations_;
  if (!options_.until_done || over_since_) return;
  bool over = excitation.phase == "done" || excitation.phase == "aborted" || excitation.phase == "lost";
  if (excitation.phase == "disarmed" && next_order_ > 0 && next_order_ == schedule_.size()) {
    over = seconds_between(schedule_.back().utime, simulator_.now()) > kToArm;  // it refused, and says why
  }
  if (over && excitation.mode.empty()) over_since_ = simulator_.now();
}

void Stage::hear(const Operator& order) {
  if (own_orders_ > 0 && next_order_ > 0 && order.utime == schedule_[next_order_ - 1].utime) {
    --own_orders_;
    return;
  }
  answers_.push_back(gate_.hear(order, simulator_.now()));
  if (order.abort) schedule_.resize(next_order_);  // nobody's schedule arms again what an operator has stopped
}

void Stage::hear(const Answer& answer) {
  if (answer.gate && answer.authentic && answer.process != "simulator") driver_ = answer;
  gate_.hear(answer, simulator_.now());
}

void Stage::say(Answer answer) {
  answer.process = "simulator";
  process_.publish(wire::kAnswer, wire::encode_signed(answer, options_.keys.answer));
}

void Stage::answer() {
  if (driven()) return answers_.clear();  // its driver answers
  const Utime now = simulator_.now();
  if (!answered_ || seconds_between(*answered_, now) >= kAnswer - 1e-9) {
    answered_ = now;
    say(gate_.answer(now));
  }
  for (Answer& each : answers_) say(std::exchange(each, {}));
  answers_.clear();
}

void Stage::hear(const fathom_lcm::lockstep_ack_t& ack) {
  if (!conductor_) return;
  conductor_->hear(ack);
  last_answer_ = Clock::now();
}

void Stage::hear(const fathom_lcm::process_info_t& info) {
  if (info.process != "simulator") return;
  if (++introductions_ == 1) return;  // our own
  if (state_ == State::kLooking) {
    throw InputError(
        "a second simulator was started on this bus at the same time; start one, or give each its own --in");
  }
  process_.tell_health();  // the newcomer hears that the bus is taken
}

void Stage::hear(const fathom_lcm::health_t& health) {
  const bool alive = health.state == "running" || health.state == "unhealthy";
  if (state_ != State::kLooking || health.process != "simulator" || !alive) return;
  if (health.pid == getpid() && health.host == runtime::host_name()) return;  // our own
  throw InputError("another simulator is already running on this bus; stop it, or give each its own --in");
}

void Stage::wait(std::span<const int> descriptors, int milliseconds) {
  if (state_ == State::kRunning || state_ == State::kEnding) {
    if (milliseconds == 0) return;  // messages are here already
    if (has_lines()) {
      run_lines(descriptors, milliseconds);
    } else if (conductor_) {
      conduct(descriptors, milliseconds);
    } else {
      run(descriptors, milliseconds);
    }
    return;
  }
  poll_for(descriptors, std::min(1e-3 * milliseconds, 0.01));
  const auto now = Clock::now();
  if (state_ == State::kLooking) {
    if (seconds(now - began_) < kLook) return;
    state_ = State::kGathering;
    last_complaint_ = now;
  }
  if (instruments_ != nullptr) instruments_->serve(seconds(now.time_since_epoch()));
  const std::string names = missing();
  if (names.empty()) {
    begin();
  } else if (seconds(now - last_complaint_) > kComplain) {  // others keep saying hello meanwhile
    last_complaint_ = now;
    process_.log_warning("waits for " + names + (conductor_ ? "; start them with --lockstep" : ""));
  }
}

std::string Stage::missing() const {
  if (instruments_ != nullptr) return instruments_->absent();
  std::string names;
  if (!conductor_) return names;
  for (const std::string& each : conductor_->absent()) names += (names.empty() ? "" : ", ") + each;
  return names;
}

// Virtual time is the wall's where drivers stamp what they hear with it.
void Stage::begin() {
  state_ = State::kRunning;
  first_tick_ = last_answer_ = Clock::now();
  if (has_lines()) {
    const Utime planned = simulator_.origin(), origin = wall_utime();
    gate_ = driver::ThrusterGate{unforeseeable()};  // a successor must not be taken for this one
    simulator_.begin_at(origin);
    darkroom_.begin_at(origin);
    if (instruments_ != nullptr) instruments_->begin_at(origin);
    for (Operator& order : schedule_) order.utime += origin - planned;
  }
  advance();
}

Stage::Clock::time_point Stage::wall(Utime utime) const {
  if (options_.speed <= 0.0) return first_tick_;
  const double elapsed = seconds_between(simulator_.origin(), utime) / options_.speed;
  return first_tick_ + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(elapsed));
}

void Stage::speak_when_due() {
  for (; !waiting_.empty() && wall(waiting_.front().due) <= Clock::now(); waiting_.pop_front()) {
    const simulation::Sample& sample = waiting_.front().sample;
    if (instruments_ == nullptr || !instruments_->say(sample)) speak(process_, darkroom_, sample);
  }
}

// As run(), but everything at its own time: drivers stamp what arrives.
void Stage::run_lines(std::span<const int> descriptors, int milliseconds) {
  const auto now = Clock::now();
  if (instruments_ != nullptr) instruments_->serve(seconds(now.time_since_epoch()));
  speak_when_due();
  if (due() <= now) {
    if (seconds(now - due()) > kTooLate * static_cast<double>(simulator_.interval()) * 1e-6) ++late_;
    advance();
    return speak_when_due();
  }
  auto next = std::min(due(), now + kLinesPause);
  if (!waiting_.empty()) next = std::min(next, wall(waiting_.front().due));
  const double left = std::min(1e-3 * milliseconds, seconds(next - now));
  if (left > 0.0) poll_for(descriptors, left);
}

void Stage::run(std::span<const int> descriptors, int milliseconds) {
  const double left = seconds(due() - Clock::now());
  // Sleeping is for whole milliseconds; what is left of the last one is waited out with open eyes.
  if (left > 1e-3) return poll_for(descriptors, std::min(1e-3 * milliseconds, 1e-3 * std::floor(left * 1e3)));
  if (left > 0.0) return;
  if (-left > kTooLate * static_cast<double>(simulator_.interval()) * 1e-6 / options_.speed) ++late_;
  advance();
}

// An interval is over when nobody has anything left to handle and what was said to us is here.
bool Stage::interval_over() const {
  return conductor_->over() && commands_ >= conductor_->said(wire::kWrenchCommand) &&
         excitations_ >= conductor_->said(wire::kExcitation);
}

void Stage::conduct(std::span<const int> descriptors, int milliseconds) {
  if (const auto phase = conductor_->next()) {
    process_.publish(runtime::kLockstep, *phase);
    return;
  }
  if (!interval_over()) {
    poll_for(descriptors, 1e-3 * milliseconds);
    if (seconds(Clock::now() - last_answer_) > kPatience) {
      throw InputError("lockstep: no answer from " + conductor_->waiting_for() + " for ten minutes; see what it says");
    }
    return;
  }
  if (state_ == State::kEnding) {
    if (const auto last = conductor_->finish(simulator_.now())) {
      process_.publish(runtime::kLockstep, *last);
    } else {
      process_.stop();
    }
    return;
  }
  if (options_.speed > 0.0) return run(descriptors, milliseconds);
  advance();
}

void Stage::give_orders() {
  while (next_order_ < schedule_.size() && schedule_[next_order_].utime <= simulator_.now()) {
    if (driven() && !driver_) return;  // until it has told what an order must quote
    Operator order = schedule_[next_order_++];
    order.utime = schedule_[next_order_ - 1].utime = simulator_.now();
    order.challenge = driven() ? driver_->challenge : gate_.challenge();
    order.sequence = (driven() ? driver_->accepted : gate_.accepted()) + 1;
    answers_.push_back(gate_.hear(order, simulator_.now()));
    ++own_orders_;
    process_.publish(wire::kOperator, wire::encode_signed(order, options_.keys.order));
    process_.log_info("operator: " + (order.abort ? std::string{"abort"} : order.order));
    if (order.abort) schedule_.resize(next_order_);
  }
}

void Stage::advance() {
  const double flown = seconds_between(simulator_.origin(), simulator_.now());
  const bool over = (pilot_ && flown >= pilot_->manoeuvre().duration - 1e-9) ||
                    (over_since_ && seconds_between(*over_since_, simulator_.now()) >= kAfterwards);
  if (over || flown >= options_.setup.duration - 1e-9) {
    state_ = State::kEnding;
    if (!conductor_) process_.stop();
    return;
  }
  const Utime utime = simulator_.now();
  if (driven()) simulator_.drive(instruments_->told());
  if (pilot_) {
    const double yaw = euler_from_rotation(simulator_.moment().R_WB).z();
    simulator_.drive(pilot_->thrust(flown, yaw));
  }
  simulator_.command(
      {.utime = utime, .tau = gate_.wrench(utime), .life = 2.0 * static_cast<double>(simulator_.interval()) * 1e-6});
  const std::vector<simulation::Sample>& samples = simulator_.step();
  said_ = {};
  answer();
  give_orders();
  if (has_lines()) {
    for (std::size_t i = 0; i < samples.size(); ++i) waiting_.push_back({simulator_.due()[i], samples[i]});
    return tell_changes();
  }
  for (const simulation::Sample& sample : samples) speak(process_, darkroom_, sample);
  if (conductor_) process_.publish(runtime::kLockstep, conductor_->begin(simulator_.now(), std::move(said_)));
  tell_changes();
}

runtime::Process::Condition Stage::condition() const {
  const simulation::ContactCounts& contacts = simulator_.contacts();
  const std::string_view reason = !commanded() ? "" : gate_.reason(simulator_.now());
  char text[160];
  std::snprintf(text, sizeof text, "t %.1f s, contacts: walls %d, floor %d, surface %d, %s%s",
                seconds_between(simulator_.origin(), simulator_.now()), contacts.walls, contacts.floor,
                contacts.surface,
                driven()         ? "thrust by thruster_driver"
                : pilot_         ? "thrust by a manoeuvre"
                : reason.empty() ? "thrust as commanded"
                                 : "zero thrust: ",
                std::string{reason}.c_str());
  std::string detail = text;
  if (const std::string forged = gate_.forgeries(); !forged.empty()) detail += ", " + forged;
  if (gate_.hears_stranger(simulator_.now())) detail += std::string(", ") + driver::ThrusterGate::kStranger;
  std::string unhealthy = simulator_.complaint();
  if (unhealthy.empty() && late_ > 0) {
    unhealthy = std::to_string(late_) + " control intervals came late; " +
                (has_lines() ? "this machine has too much else to do" : "lower --speed");
  }
  return {.unhealthy = unhealthy, .detail = detail};
}

// A change of what reaches the thrusters is said at once.
void Stage::tell_changes() {
  const std::string kind = (!commanded() ? "" : std::string{gate_.reason(simulator_.now())}) +
                           (gate_.hears_stranger(simulator_.now()) ? "|and a stranger|" : "|") +
                           (gate_.hears_forgeries(simulator_.now()) ? "forged|" : "|") + simulator_.complaint();
  if (kind == told_) return;
  told_ = kind;
  if (!simulator_.complaint().empty()) process_.log_warning(simulator_.complaint());
  process_.tell_health();
}

void Stage::end() {
  if (conductor_ && state_ == State::kRunning) {
    process_.publish(runtime::kLockstep, conductor_->end(simulator_.now()));
  }
}

}  // namespace fathom::simulator
