// The supervisor as a process on a bus in real time: whom it misses, and whose clock it does not believe.
#include <doctest/doctest.h>

#include <fathom_lcm/state_t.hpp>
#include <limits>

#include "common/runtime/self.hpp"
#include "common/wire/minds.hpp"
#include "test/support/orders.hpp"
#include "test/support/sleeper.hpp"

namespace fathom {
namespace {

using test::Background;
using test::Bus;
using test::now;
using test::program;
using test::Scratch;

/// Estimator, identifier and vehicle as far as the supervisor sees them: states in the tank's middle, HEALTH of each.
struct Beside {
  Bus bus;
  Scratch scratch;
  Background supervisor{scratch, "supervisor",
                        program("supervisor") + " --config " + test::file("config/pipelines/tank.yaml") + " --config " +
                            test::file("config/vehicles/seabotix_lbv150.yaml") + " --config " +
                            test::file("config/sites/tank.yaml") + " --config " +
                            test::file("config/operators/simulated.yaml") + " --in '" + bus.url + "'"};
  bool vehicle{true};             // its driver says HEALTH
  const test::Sleeper* driver{};  // of this host, stands for the vehicle's driver; without it, of another host
  std::int64_t accepted{};

  void health(const std::string& process, Utime utime, const test::Sleeper* here = nullptr) {
    auto message = test::word_of(process);
    message.utime = utime;
    if (here != nullptr) {
      message.host = runtime::host_name();
      message.pid = here->pid;
      message.start = here->start;
    }
    bus.publish("HEALTH", message);
  }
  void answer() {
    const Answer gate{.utime = now(), .process = "thruster_driver", .gate = true, .challenge = 7, .accepted = accepted};
    bus.publish("ANSWER", wire::encode_signed(gate, test::simulated_keys().answer));
  }
  void order(Utime utime, const OperatorKeys& keys = test::simulated_keys()) {
    const Operator arm{.utime = utime, .sequence = ++accepted, .challenge = 7, .enable = true};
    bus.publish("OPERATOR", wire::encode_signed(arm, keys.order));
  }
  void run(double seconds) {
    for (int i = 0; i < static_cast<int>(20.0 * seconds); ++i) {
      if (i % 20 == 0) {
        for (const char* process : {"estimator", "identifier", "recorder"}) health(process, now());
        if (vehicle) health("thruster_driver", now(), driver);
        answer();
      }
      StateEstimate state{.utime = now(), .valid = true};
      state.p_WB = {0.0, 0.0, 0.75};
      bus.publish("STATE", wire::encode(state));
      bus.listen(0.05);
    }
  }
  /// As long as a busy machine may take until `enough`; whether it came to that.
  template <class Enough>
  bool until(const Enough& enough, double longest = 30.0) {
    for (double waited = 0.0; !enough(); waited += 1.0) {
      if (waited > longest) return false;
      run(1.0);
    }
    return true;
  }
  /// Armed, with the trial under way.
  void begin() {
    REQUIRE(until([&] { return !said().empty(); }));
    run(1.0);
    order(now());
    REQUIRE_MESSAGE(until([&] { return goes_on(); }), said());
  }
  /// The newest that the supervisor said of itself.
  [[nodiscard]] std::string said() const {
    for (auto each = bus.health.rbegin(); each != bus.health.rend(); ++each) {
      if (each->process == "supervisor") return each->detail;
    }
    return {};
  }
  /// What it said of itself, behind what it has refused.
  [[nodiscard]] bool says(const std::string& words) const { return said().find(words) != std::string::npos; }
  [[nodiscard]] bool goes_on() const { return says("approach: ") || says("excite: "); }
};

}  // namespace

TEST_CASE("supervisor: messages with another clock's time, and orders that nobody may give, leave a trial as it is") {
  Beside beside;
  beside.begin();
  constexpr Utime kMinute = 60'000'000;
  for (int i = 0; i < 5; ++i) {  // a host whose clock is late, and somebody who tries
    beside.health("board", now() - kMinute);
    beside.order(now() - kMinute, keys_from(Key{}));
    beside.run(0.2);
    CHECK_MESSAGE(beside.goes_on(), beside.said());
  }
}

TEST_CASE("supervisor: a STATE refused for its numbers moves nothing, whatever its time stamp") {
  Beside beside;
  beside.begin();
  constexpr Utime kHour = 3'600'000'000;
  for (const Utime offset : {-kHour, kHour}) {  // it would start over, and wait to be armed
    StateEstimate state{.utime = now() + offset, .valid = true};
    state.p_WB = {0.0, std::numeric_limits<double>::quiet_NaN(), 0.75};
    beside.bus.publish("STATE", wire::encode(state));
    beside.run(1.5);
    CHECK_MESSAGE(beside.goes_on(), beside.said());
  }
}

TEST_CASE("supervisor: HEALTH said in the name of a dead process hides it from nobody") {
  Beside beside;
  test::Sleeper driver;
  REQUIRE(driver.start > 0);
  beside.driver = &driver;
  beside.begin();
  driver.end();
  const auto aborted = [&] {  // its words go on, as numbered as ever, from here and from elsewhere
    beside.health("thruster_driver", now());
    return beside.says("aborted: thruster_driver is silent: no HEALTH for 1");
  };
  CHECK_MESSAGE(beside.until(aborted), beside.said());
}

TEST_CASE(
    "supervisor: a thruster driver that fell silent ends the trial, and it is not armed again before one speaks") {
  Beside beside;
  beside.begin();
  beside.vehicle = false;
  const auto says = [&](const char* words) { return [&beside, words] { return beside.says(words); }; };
  CHECK_MESSAGE(beside.until(says("aborted: thruster_driver is silent: no HEALTH for 1")), beside.said());
  beside.order(now());
  CHECK_MESSAGE(beside.until(says("not armed: thruster_driver is silent: no HEALTH for 1"), 5.0), beside.said());
  beside.vehicle = true;
  beside.run(1.0);
  beside.order(now());
  CHECK_MESSAGE(beside.until([&] { return beside.goes_on(); }), beside.said());
}

}  // namespace fathom
