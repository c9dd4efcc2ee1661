#include "common/driver/thruster_gate.hpp"

#include <algorithm>

namespace fathom::driver {

void ThrusterGate::hear(const WrenchCommand& command, Utime now) {
  if (!trusted_ && seconds_between(quiet_since_, now) >= kPause) trusted_ = true;
  quiet_since_ = now;
  command_ = command;
  heard_ = now;
}

void ThrusterGate::hear(const Operator& order, Utime now) {
  if (order.abort) {
    aborted_ = true;
    command_.reset();
  } else if (order.enable) {
    if (aborted_) command_.reset();  // what was asked before the abort is not taken up again
    aborted_ = false;
    trusted_ = true;
    quiet_since_ = now;
  }
}

std::string_view ThrusterGate::reason(Utime now) const {
  if (aborted_) return "aborted by the operator; waits for enable";
  if (!command_) return "no command";
  if (!trusted_) return "commands were flowing at the start; waits for a pause or for enable";
  if (seconds_between(heard_, now) > std::min(kPause, command_->life)) return "commands have stopped";
  if (seconds_between(command_->utime, now) > std::max(kPause, command_->life)) return "commands are too old";
  if (!command_->tau.allFinite()) return "the command holds no numbers";
  return {};
}

Vector6d ThrusterGate::wrench(Utime now) const { return reason(now).empty() ? command_->tau : Vector6d::Zero(); }

}  // namespace fathom::driver
