#include "common/driver/thruster_gate.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/printable.hpp"
#include "common/orders/words.hpp"

namespace fathom::driver {
namespace {

constexpr std::string_view kTakenBack = "not armed: the supervisor refused";

}  // namespace

bool ThrusterGate::was_armed(const WrenchCommand& command) const {
  return armed_ && command.challenge == check_.challenge() && command.armed_by >= armed_since_ &&
         command.armed_by <= check_.accepted();
}

void ThrusterGate::refuse(const WrenchCommand& command, Utime now) {
  constexpr std::size_t kLongest = 40;  // characters of a name
  ++(command.authentic ? replayed_ : unsigned_);
  forged_at_ = now;
  forger_ = printable(command.commander, kLongest);
}

bool ThrusterGate::hears_forgeries(Utime now) const {
  return forged_at_ && std::abs(seconds_between(*forged_at_, now)) <= kPause;
}

std::string ThrusterGate::forgeries() const {
  std::string text;
  if (unsigned_ > 0) text = std::to_string(unsigned_) + " not signed with this vehicle's key";
  if (replayed_ > 0) text += (text.empty() ? "" : ", ") + std::to_string(replayed_) + " replayed";
  return text.empty() ? "" : "forged commands refused: " + text + ", the last in the name of '" + forger_ + "'";
}

/// It may be the commander of a driver that has died: then it must learn that nobody obeys it.
void ThrusterGate::hear_unarmed(const WrenchCommand& command, Utime now) {
  const bool asks = !command.tau.isZero();
  if (armed_) {
    if (asks) stranger_ = now;
    return;
  }
  if (unarmed_ && seconds_between(*unarmed_, now) > kPause) {
    asked_.reset();
    ignores_ = false;
  }
  unarmed_ = now;
  const bool of_now = std::abs(seconds_between(command.utime, now)) <= kPause;  // a replayed log's are not
  if (!of_now) return;
  if (!asks) {  // who is told so asks for nothing meanwhile, and yet is not obeyed
    asked_.reset();
    return;
  }
  if (!asked_) asked_ = now;
  ignores_ = ignores_ || seconds_between(*asked_, now) >= kInVain;
}

void ThrusterGate::hear(const WrenchCommand& command, Utime now) {
  if (!command.authentic) {
    refuse(command, now);
    return;
  }
  if (!was_armed(command)) {
    hear_unarmed(command, now);
    return;
  }
  // Armed is armed for the one who commands first: another one is never obeyed, and while both speak neither is.
  if (command_ && command.commander != command_->commander) {
    contested_ = now;
    return;
  }
  if (command_ && command.sequence <= command_->sequence) {
    refuse(command, now);
    return;
  }
  command_ = command;
  heard_ = now;
}

bool ThrusterGate::ignores(Utime now) const {
  return ignores_ && !armed_ && unarmed_ && seconds_between(*unarmed_, now) <= kPause;
}

bool ThrusterGate::hears_stranger(Utime now) const {
  return armed_ && stranger_ && seconds_between(*stranger_, now) <= kPause;
}

Answer ThrusterGate::answer(Utime now) const {
  return {.utime = now, .gate = true, .challenge = check_.challenge(), .accepted = check_.accepted(), .armed = armed_};
}

Answer ThrusterGate::hear(const Operator& order, Utime now) {
  const auto said = [&](bool done, std::string_view text) {
    Answer answer = this->answer(now);
    answer.sequence = order.sequence;
    answer.done = done;
    answer.text = text;
    return answer;
  };
  if (order.abort) {
    check_.abort(now);
    aborted_ = true;
    taken_back_ = false;
    disarm();
    return said(true, "thrust is zero until it is armed again");
  }
  if (!check_.again(order)) {
    if (const std::string_view why = check_.objection(order, now); !why.empty()) {
      ++refused_;
      refusal_ = why;
      return said(false, why);
    }
    check_.accept(order);
    if (order.enable) {
      arm(now);
      for_another_ = order.order == orders::kOther;
    }
  }
  if (!order.enable) return said(true, armed_ ? "heard" : "heard; not armed");
  return said(armed_, armed_ ? "armed" : taken_back_ ? kTakenBack : "aborted since");
}

bool ThrusterGate::hear(const Answer& said, Utime now) {
  const bool refused = said.authentic && !said.gate && !said.done && !said.armed;
  const bool of_what_armed = said.challenge == check_.challenge() && said.sequence == check_.accepted();
  if (!armed_ || for_another_ || !refused || !of_what_armed) return false;
  if (command_ && seconds_between(heard_, now) <= kPause) return false;
  disarm();
  taken_back_ = true;
  return true;
}

void ThrusterGate::disarm() {
  armed_ = false;
  command_.reset();
  asked_.reset();
  ignores_ = false;
}

void ThrusterGate::arm(Utime now) {
  // What was asked before is not taken up; and a commander that has died makes room for its successor.
  if (!armed_ || !command_ || seconds_between(heard_, now) > kPause) {
    command_.reset();
    armed_since_ = check_.accepted();
  }
  armed_ = true;
  stranger_.reset();
  asked_.reset();
  ignores_ = false;
  aborted_ = false;
  taken_back_ = false;
  contested_.reset();
}

std::string_view ThrusterGate::reason(Utime now) const {
  if (aborted_) return "aborted by the operator; waits to be armed";
  if (!armed_) return taken_back_ ? kTakenBack : "not armed";
  if (!command_) {
    return hears_stranger(now) ? "who commands was not armed; stop it" : "no command";
  }
  if (contested_ && seconds_between(*contested_, now) <= kPause) return "two commanders; stop one and arm again";
  if (seconds_between(heard_, now) > std::min(kPause, command_->life)) return "commands have stopped";
  if (std::abs(seconds_between(command_->utime, now)) > std::max(kPause, command_->life))
    return "commands are not of now";
  if (!command_->tau.allFinite()) return "the command holds no numbers";
  return {};
}

Vector6d ThrusterGate::wrench(Utime now) const { return reason(now).empty() ? command_->tau : Vector6d::Zero(); }

}  // namespace fathom::driver
