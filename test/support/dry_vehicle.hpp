// A vehicle on a bus of its own whose thrusters are none: real driver and supervisor, and commands of the operator's
// tool against them.
#pragma once

#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>
#include <fathom_lcm/state_t.hpp>
#include <fstream>
#include <functional>
#include <memory>

#include "common/link/server.hpp"
#include "test/support/orders.hpp"

namespace fathom::test {

inline std::string operator_file() { return file("config/operators/simulated.yaml"); }

/// A thruster driver that moves nothing, and, where a test wants one, a supervisor in the middle of the tank.
struct DryVehicle {
  Bus bus;
  Scratch scratch;
  std::unique_ptr<Background> driver, supervisor;
  std::function<void()> meanwhile;  ///< every 5 ms
  std::string identifier{"running"};
  bool deaf_supervisor{false};  ///< one says HEALTH and hears nothing
  double north{}, down{0.75};   ///< m, where STATE sees it

  DryVehicle() { start_driver(); }
  void start_driver() {
    std::ofstream{scratch.path("x.yaml")}
        << "thruster_driver: {protocol: dry_run, rate: 20 Hz, largest_thrust: 30 N}\n";
    driver = std::make_unique<Background>(scratch, "driver",
                                          program("thruster_driver") + " --config " + scratch.path("x.yaml") +
                                              " --config " + file("config/vehicles/bluerov2.yaml") + " --config " +
                                              operator_file() + " --in '" + bus.url + "'");
    bus.answers.clear();
    for (int i = 0; i < 100 && bus.gate() == nullptr; ++i) bus.listen(0.1);
    REQUIRE_MESSAGE(bus.gate() != nullptr, read_bytes(scratch.path("driver.text")));
  }
  void start_supervisor() {
    supervisor = std::make_unique<Background>(
        scratch, "supervisor",
        program("supervisor") + " --config " + file("config/pipelines/tank.yaml") + " --config " +
            file("config/vehicles/bluerov2.yaml") + " --config " + file("config/sites/tank.yaml") + " --config " +
            operator_file() + " --in '" + bus.url + "'");
    until([&] { return !bus.said_of("supervisor").empty(); });
    run(1.0);  // until it has heard its neighbours
  }
  /// Estimator and identifier as far as a supervisor sees them.
  void run(double seconds) {
    const double end = link::wall_seconds() + seconds;
    for (int i = 0; link::wall_seconds() < end; ++i) {
      if (i % 100 == 0) {
        std::vector<std::string> neighbours{"estimator", "identifier", "recorder"};
        if (deaf_supervisor) neighbours.emplace_back("supervisor");
        for (const std::string& process : neighbours) {
          bus.publish("HEALTH", word_of(process, process == "identifier" ? identifier : "running"));
        }
      }
      if (i % 10 == 0) {
        StateEstimate state{.utime = now(), .valid = true};
        state.p_WB = {north, 0.0, down};
        bus.publish("STATE", wire::encode(state));
      }
      if (meanwhile) meanwhile();
      bus.listen(0.005);
    }
  }
  /// As long as a busy machine may take until `enough`; whether it came to that.
  template <class Enough>
  bool until(const Enough& enough, double longest = 30.0) {
    for (const double end = link::wall_seconds() + longest; !enough(); run(0.05)) {
      if (link::wall_seconds() > end) return false;
    }
    return true;
  }
  [[nodiscard]] bool supervisor_says(const std::string& words) const {
    return bus.said_of("supervisor").find(words) != std::string::npos;
  }
  /// A command of the operator's tool, while everything else goes on.
  Ran tool(const std::string& words, double longest = 30.0) {
    std::remove(scratch.path("code").c_str());
    const Background one{scratch, "tool",
                         "sh -c \"" + program("fathom") + " " + words + " --bus '" + bus.url + "' < /dev/null > " +
                             scratch.path("said") + " 2>&1; echo \\$? > " + scratch.path("code") + "\""};
    const double end = link::wall_seconds() + longest;
    while (link::wall_seconds() < end && read_bytes(scratch.path("code")).empty()) run(0.1);
    const std::string code = read_bytes(scratch.path("code"));
    return {.code = code.empty() ? -1 : std::stoi(code), .text = read_bytes(scratch.path("said"))};
  }
  [[nodiscard]] double strongest_since(std::size_t first) const {
    double most = 0.0;
    for (std::size_t i = first; i < bus.thrusters.size(); ++i) {
      for (const double each : bus.thrusters[i].tau) most = std::max(most, std::abs(each));
    }
    return most;
  }
  /// Of the newest command.
  [[nodiscard]] double commanded_ahead() const { return bus.commands.empty() ? 0.0 : bus.commands.back().tau[0]; }
  [[nodiscard]] bool pushes_ahead(double force) const { return std::abs(commanded_ahead() - force) < 0.1 * force; }
};

}  // namespace fathom::test
