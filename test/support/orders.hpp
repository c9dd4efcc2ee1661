// An operator and a commander of a test: they have the simulated key and quote what the bus says.
#pragma once

#include <algorithm>
#include <string>

#include "common/base/operator_key.hpp"
#include "common/wire/signature.hpp"
#include "test/support/bus.hpp"

namespace fathom::test {

inline OperatorKeys simulated_keys() {
  return operator_keys(std::string{FATHOM_SOURCE_DIR} + "/config/operators/simulated.yaml");
}

/// Gives the order now, by the newest word of who moves the thrusters; returns what was said, to be said again.
inline fathom_lcm::operator_t give(Bus& bus, Operator order, const OperatorKeys& keys = simulated_keys()) {
  const auto* gate = bus.gate();
  order.utime = now();
  if (!order.abort) {
    order.challenge = gate != nullptr ? gate->challenge : 0;
    order.sequence = (gate != nullptr ? gate->accepted : 0) + 1;
  }
  const auto message = wire::encode_signed(order, keys.order);
  bus.publish("OPERATOR", message);
  return message;
}

/// Commands under `order`, signed, each with its number.
struct Commander {
  Bus& bus;
  std::int64_t armed_by{}, challenge{}, sequence{};
  OperatorKeys keys{simulated_keys()};

  void obey(const fathom_lcm::operator_t& order) {
    armed_by = order.sequence;
    challenge = order.challenge;
  }
  fathom_lcm::wrench_command_t say(const Vector6d& tau) {
    const WrenchCommand command{.utime = now(),
                                .tau = tau,
                                .life = 0.5,
                                .commander = "commander of a test",
                                .armed_by = armed_by,
                                .challenge = challenge,
                                .sequence = ++sequence};
    const auto message = wire::encode_signed(command, keys.command);
    bus.publish("WRENCH_COMMAND", message);
    return message;
  }
};

inline Vector6d ahead(double force) {
  Vector6d tau = Vector6d::Zero();
  tau[0] = force;
  return tau;
}

}  // namespace fathom::test
