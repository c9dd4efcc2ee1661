// A bus of a test's own, and programs in the background that end with the test.
#pragma once

#include <doctest/doctest.h>
#include <unistd.h>

#include <fathom_lcm/answer_t.hpp>
#include <fathom_lcm/health_t.hpp>
#include <fathom_lcm/operator_t.hpp>
#include <fathom_lcm/thrusters_t.hpp>
#include <fathom_lcm/vehicle_condition_t.hpp>
#include <fathom_lcm/wrench_command_t.hpp>
#include <lcm/lcm-cpp.hpp>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/link/server.hpp"
#include "test/support/scratch.hpp"
#include "test/support/shell.hpp"

namespace fathom::test {

/// Listens to a bus of its own in this thread.
class Bus {
 public:
  Bus() : url{"udpm://239.255.76.67:" + std::to_string(31000 + getpid() % 9000) + "?ttl=0"}, lcm_{url} {
    REQUIRE(lcm_.good());
    lcm_.subscribeFunction("HEALTH", &Bus::on_health, this);
    lcm_.subscribeFunction("THRUSTERS", &Bus::on_thrusters, this);
    lcm_.subscribeFunction("ANSWER", &Bus::on_answer, this);
    lcm_.subscribeFunction("OPERATOR", &Bus::on_order, this);
    lcm_.subscribeFunction("WRENCH_COMMAND", &Bus::on_command, this);
    lcm_.subscribeFunction("VEHICLE", &Bus::on_vehicle, this);
  }
  void listen(double seconds) {
    const double end = link::wall_seconds() + seconds;
    while (link::wall_seconds() < end) lcm_.handleTimeout(10);
  }
  /// Listens until `enough`, for so long [s] at most, since machines are slow at times; whether it came to that.
  template <class Enough>
  bool until(const Enough& enough, double longest = 30.0) {
    for (const double end = link::wall_seconds() + longest; !enough(); listen(0.02)) {
      if (link::wall_seconds() > end) return false;
    }
    return true;
  }
  template <class Message>
  void publish(const std::string& channel, const Message& message) {
    lcm_.publish(channel, &message);
  }
  std::string url;
  std::vector<fathom_lcm::health_t> health;
  std::vector<fathom_lcm::thrusters_t> thrusters;
  std::vector<fathom_lcm::answer_t> answers;
  std::vector<fathom_lcm::operator_t> orders;
  std::vector<fathom_lcm::wrench_command_t> commands;

  /// The newest word of who moves the thrusters.
  [[nodiscard]] const fathom_lcm::answer_t* gate() const {
    for (auto each = answers.rbegin(); each != answers.rend(); ++each) {
      if (each->gate != 0) return &*each;
    }
    return nullptr;
  }
  /// The newest that a process said of itself.
  [[nodiscard]] std::string said_of(const std::string& process) const {
    for (auto each = health.rbegin(); each != health.rend(); ++each) {
      if (each->process == process) return each->state + ": " + each->detail;
    }
    return {};
  }
  std::vector<fathom_lcm::vehicle_condition_t> vehicle;

 private:
  // Functions, not members: GCC 12's undefined-behaviour sanitizer miscompiles LCM's call of a member that is not
  // virtual (the object's address is read before it is stored).
  static void on_health(const lcm::ReceiveBuffer*, const std::string&, const fathom_lcm::health_t* message, Bus* bus) {
    bus->health.push_back(*message);
  }
  static void on_thrusters(const lcm::ReceiveBuffer*, const std::string&, const fathom_lcm::thrusters_t* message,
                           Bus* bus) {
    bus->thrusters.push_back(*message);
  }
  static void on_answer(const lcm::ReceiveBuffer*, const std::string&, const fathom_lcm::answer_t* message, Bus* bus) {
    bus->answers.push_back(*message);
  }
  static void on_order(const lcm::ReceiveBuffer*, const std::string&, const fathom_lcm::operator_t* message, Bus* bus) {
    bus->orders.push_back(*message);
  }
  static void on_command(const lcm::ReceiveBuffer*, const std::string&, const fathom_lcm::wrench_command_t* message,
                         Bus* bus) {
    bus->commands.push_back(*message);
  }
  static void on_vehicle(const lcm::ReceiveBuffer*, const std::string&, const fathom_lcm::vehicle_condition_t* message,
                         Bus* bus) {
    bus->vehicle.push_back(*message);
  }
  lcm::LCM lcm_;
};

/// A program in the background that ends with the object.
class Background {
 public:
  Background(const Scratch& scratch, const std::string& name, const std::string& command)
      : pid_{scratch.path(name + ".pid")} {
    shell(command + " > " + scratch.path(name + ".text") + " 2>&1 & echo $! > " + pid_);
  }
  ~Background() { stop(); }
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;
  /// TERM, because a shell lets its background jobs ignore INT; returns when the program has gone.
  void stop() const {
    shell("pid=$(cat " + pid_ + "); kill -TERM $pid 2>/dev/null; for i in $(seq 100); do kill -0 $pid 2>/dev/null || " +
          "exit 0; sleep 0.05; done; kill -KILL $pid");
  }

 private:
  std::string pid_;
};

inline Utime now() { return static_cast<Utime>(1e6 * link::wall_seconds()); }

/// HEALTH of a process on a host of its own, numbered as a process numbers its words.
inline fathom_lcm::health_t word_of(const std::string& process, const std::string& state = "running") {
  static std::int64_t words = 0;
  fathom_lcm::health_t message{};
  message.utime = now();
  message.process = process;
  message.host = "vehicle";
  message.sequence = ++words;
  message.state = state;
  return message;
}

}  // namespace fathom::test
