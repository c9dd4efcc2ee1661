#include "common/driver/thruster_gate.hpp"

#include <algorithm>
#include <cmath>

namespace fathom::driver {

void ThrusterGate::hear(const WrenchCommand& command, Utime now) {
  // Armed is armed for the one who commands first: another one is never obeyed, and while both speak neither is.
  if (command_ && command.commander != command_->commander) {
    contested_ = now;
    return;
  }
  if (armed_ || seconds_between(heard_, now) > kPause) {
    asked_.reset();
    ignores_ = false;
  }
  command_ = command;
  heard_ = now;
  const bool of_now = std::abs(seconds_between(command.utime, now)) <= kPause;  // a replayed log's are not
  if (armed_ || !of_now) return;
  if (command.tau.isZero()) {  // who is told so asks for nothing meanwhile, and yet is not obeyed
    asked_.reset();
    return;
  }
  if (!asked_) asked_ = now;
  ignores_ = ignores_ || seconds_between(*asked_, now) >= kInVain;
}

bool ThrusterGate::ignores(Utime now) const {
  return ignores_ && !armed_ && command_ && seconds_between(heard_, now) <= kPause;
}

std::string_view ThrusterGate::objection(const Operator& order, Utime now) const {
  if (token_.empty()) return "no token is configured";
  if (order.token != token_) return "wrong token";
  if (order.sequence <= sequence_) return "heard before";
  if (std::abs(seconds_between(order.utime, now)) > kOrderAge)
    return "not of this time: a replayed log or a wrong clock";
  return {};
}

void ThrusterGate::hear(const Operator& order, Utime now) {
  if (order.abort) {
    aborted_ = true;
    armed_ = false;
    command_.reset();
    asked_.reset();
    ignores_ = false;
    return;
  }
  if (const std::string_view why = objection(order, now); !why.empty()) {
    ++refused_;
    refusal_ = why;
    return;
  }
  sequence_ = order.sequence;
  if (!order.enable) return;
  // What was asked before is not taken up; and a commander that has died makes room for its successor.
  if (!armed_ || seconds_between(heard_, now) > kPause) command_.reset();
  armed_ = true;
  asked_.reset();
  ignores_ = false;
  aborted_ = false;
  contested_.reset();
}

std::string_view ThrusterGate::reason(Utime now) const {
  if (aborted_) return "aborted by the operator; waits to be armed";
  if (!armed_) return "not armed";
  if (!command_) return "no command";
  if (contested_ && seconds_between(*contested_, now) <= kPause) return "two commanders; stop one and arm again";
  if (seconds_between(heard_, now) > std::min(kPause, command_->life)) return "commands have stopped";
  if (std::abs(seconds_between(command_->utime, now)) > std::max(kPause, command_->life))
    return "commands are not of now";
  if (!command_->tau.allFinite()) return "the command holds no numbers";
  return {};
}

Vector6d ThrusterGate::wrench(Utime now) const { return reason(now).empty() ? command_->tau : Vector6d::Zero(); }

}  // namespace fathom::driver
