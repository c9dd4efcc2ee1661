// The simulator on the bus: looks whether it is alone, gathers its followers, and hands out one control interval after
// the other, at the wall's pace, faster, or as fast as they are answered.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <fathom_lcm/health_t.hpp>
#include <fathom_lcm/lockstep_ack_t.hpp>
#include <fathom_lcm/process_info_t.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/driver/thruster_gate.hpp"
#include "common/model/manoeuvres.hpp"
#include "common/runtime/lockstep.hpp"
#include "common/runtime/process.hpp"
#include "common/simulation/simulator.hpp"
#include "processes/simulator/darkroom.hpp"
#include "processes/simulator/instruments.hpp"
#include "processes/simulator/options.hpp"

namespace fathom::simulator {

class Stage {
 public:
  /// `instruments`: null when the channels of all instruments are spoken on here.
  Stage(runtime::Process& process, simulation::Simulator& simulator, Darkroom& darkroom, const Options& options,
        Instruments* instruments, const std::optional<model::ManoeuvrePilot>& pilot);

  /// A command has arrived, good or not.
  void count_command() { ++commands_; }
  void hear(const WrenchCommand& command);
  void hear(const Excitation& excitation);
  void hear(const Operator& order);
  /// Of a thruster driver, where one moves the thrusters: what our own orders must quote.
  void hear(const Answer& answer);
  void hear(const fathom_lcm::lockstep_ack_t& ack);
  /// Another simulator on the same bus is refused: the newcomer goes.
  void hear(const fathom_lcm::process_info_t& info);
  void hear(const fathom_lcm::health_t& health);

  /// In place of the runtime's waiting.
  void wait(std::span<const int> descriptors, int milliseconds);
  [[nodiscard]] runtime::Process::Condition condition() const;
  void end();

 private:
  using Clock = std::chrono::steady_clock;
  enum class State { kLooking, kGathering, kRunning, kEnding };

  void run(std::span<const int> descriptors, int milliseconds);
  void run_lines(std::span<const int> descriptors, int milliseconds);
  void speak_when_due();
  void conduct(std::span<const int> descriptors, int milliseconds);
  void advance();
  void give_orders();
  void say(Answer answer);
  /// Once in a while, and after an order, what became of it: within an interval, where lockstep keeps its place.
  void answer();
  void tell_changes();
  [[nodiscard]] bool interval_over() const;
  /// Drivers hear it, and stamp what they hear with the wall's time.
  [[nodiscard]] bool has_lines() const { return instruments_ != nullptr || darkroom_.has_line(); }
  /// Whether thrust is what WRENCH_COMMAND asks for.
  [[nodiscard]] bool commanded() const { return !driven() && !pilot_; }
  [[nodiscard]] bool driven() const { return instruments_ != nullptr && instruments_->driven(); }
  /// Who must be here before the run begins, and is not; empty when all are.
  [[nodiscard]] std::string missing() const;
  void begin();
  [[nodiscard]] Clock::time_point due() const { return wall(simulator_.now()); }
  /// When a virtual time has come by the wall's clock.
  [[nodiscard]] Clock::time_point wall(Utime utime) const;

  runtime::Process& process_;
  simulation::Simulator& simulator_;
  Darkroom& darkroom_;
  Options options_;
  Instruments* instruments_;
  std::vector<Operator> schedule_;
  std::size_t next_order_{};
  int own_orders_{};  ///< said by ourselves and still to come back
  driver::ThrusterGate gate_;
  std::optional<Answer> driver_;  ///< the thruster driver's last word
  std::vector<Answer> answers_;   ///< to orders of others, still to be said
  std::optional<Utime> answered_;
  std::optional<model::ManoeuvrePilot> pilot_;  ///< flies in place of commands
  std::optional<runtime::Conductor> conductor_;
  State state_{State::kLooking};
  Clock::time_point began_{Clock::now()}, first_tick_{}, last_answer_{}, last_complaint_{};
  int introductions_{};
  std::int64_t commands_{}, excitations_{};
  std::optional<Utime> over_since_;  ///< when the supervisor said that the trial is over
  runtime::Said said_;               ///< in this interval
  struct Waiting {
    Utime due{};
    simulation::Sample sample;
  };
  std::deque<Waiting> waiting_;  ///< with instruments: what is said when it is due, not before
  std::int64_t late_{};
  std::string told_{"?"};
};

}  // namespace fathom::simulator
