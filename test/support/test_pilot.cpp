// A commander for tests of the simulator: answers every second AHRS sample with a wrench that depends on what it heard,
// so that a command which comes a tick early or late changes everything after it.
#include <cmath>
#include <cstdint>
#include <fathom_lcm/ahrs_t.hpp>
#include <fathom_lcm/operator_t.hpp>
#include <fathom_lcm/wrench_command_t.hpp>

#include "common/base/operator_key.hpp"
#include "common/runtime/process.hpp"
#include "common/wire/channels.hpp"
#include "common/wire/decode.hpp"
#include "common/wire/minds.hpp"
#include "common/wire/sensors.hpp"
#include "common/wire/signature.hpp"

using namespace fathom;

int main(int argc, char** argv) {
  return runtime::main("test_pilot", argc, argv, [](runtime::Process& process) {
    process.publishes<fathom_lcm::wrench_command_t>(wire::kWrenchCommand);
    const OperatorKeys keys = operator_keys(std::string{FATHOM_SOURCE_DIR} + "/config/operators/simulated.yaml");
    int count = 0;
    std::int64_t armed_by = 0, challenge = 0;
    process.listens_to<fathom_lcm::operator_t>(wire::kOperator, [&](const auto& message) {
      const auto order = wire::open(message, keys.order);
      if (!order || !order->authentic || !order->enable) return;
      armed_by = order->sequence;
      challenge = order->challenge;
    });
    process.on<fathom_lcm::ahrs_t>(wire::kAhrs, wire::kDecode, [&](const Ahrs& ahrs) {
      if (++count % 2 != 0) return;
      const double t = seconds_between(1'700'000'000'000'000, ahrs.utime);
      WrenchCommand command{
          .utime = ahrs.utime, .life = 0.3, .armed_by = armed_by, .challenge = challenge, .sequence = count};
      command.tau << 5.0 * std::sin(2.0 * t), 3.0 * std::cos(1.7 * t), 1.2, 0.0, 0.0,
          0.3 * std::sin(1.1 * t) - 0.5 * ahrs.w_WB_B.z();
      process.publish(wire::kWrenchCommand, wire::encode_signed(command, keys.command));
    });
    process.run();
  });
}
