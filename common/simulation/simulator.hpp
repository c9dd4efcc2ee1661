// A vehicle in water at a site: commands in, what its instruments and its thrusters' driver would say out. Stands in
// for every driver. All times are virtual and begin at Setup::origin; the same inputs give the same bits.
//
//   Simulator simulator{vehicle, site, config.section("simulator"), {.seed = 7}};
//   for (;;) {
//     for (const Sample& sample : simulator.step()) std::visit(..., sample);   // one control interval
//     simulator.command(...);                                                   // acts from the end of the next step
//     on
//   }
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/model/learned/learned_file.hpp"
#include "common/model/thruster_allocation.hpp"
#include "common/samples/commands.hpp"
#include "common/simulation/body.hpp"
#include "common/simulation/failure.hpp"
#include "common/simulation/sensor.hpp"

namespace fathom::simulation {

struct Setup {
  std::uint64_t seed{1};
  std::vector<std::string> hide{};      ///< as hidden_effect() reads them
  std::string model{};                  ///< result.json of fathom diagnose, whose model is the truth; empty: the file's
  std::vector<std::string> fail{};      ///< as Failure::parse() reads them
  bool pictures{false};                 ///< the camera's exposures in place of tags, flow and laser range
  bool raw{false};                      ///< drivers follow: instruments speak for their own places
  double duration{330.0};               ///< s, planned: only moments of hidden effects depend on it
  Utime origin{1'700'000'000'000'000};  ///< us, of the run's start
};

/// Everything that is hidden from the other processes.
struct Secrets {
  model::BaseTheta theta;
  std::vector<model::ActiveEffect> effects;
  std::vector<std::pair<std::string, double>> drawn;  ///< "sensor.number"
  ContactCounts contacts;
};

class Simulator {
 public:
  /// `config`: the section `simulator` of config/simulation/*.yaml. InputError names file and line.
  Simulator(const model::Vehicle& vehicle, const model::Site& site, const Config& config, const Setup& setup);
  ~Simulator();
  Simulator(const Simulator&) = delete;
  Simulator& operator=(const Simulator&) = delete;

  /// Heard now, acts from the end of the next step on: a command that answers the samples of one step acts one control
  /// interval after they came out, whether the answer took no time or nearly the whole interval. The last one counts.
  void command(const WrenchCommand& command);
  /// What the thrusters are told directly from the next step on, in place of allocated wrenches: pulse widths [us] of a
  /// vehicle with a thrust curve, else forces [N].
  void drive(const std::vector<double>& told) { driven_ = told; }
  /// The run begins at this time; before the first step only.
  void begin_at(Utime origin);
  /// Advances by one control interval. The samples that have come out by its end, in the order of their arrival; valid
  /// until the next call.
  const std::vector<Sample>& step();
  /// When each of them came out [us], after the instrument's latency.
  [[nodiscard]] const std::vector<Utime>& due() const { return due_; }

  [[nodiscard]] Utime origin() const { return origin_; }
  [[nodiscard]] Utime now() const;
  [[nodiscard]] Utime interval() const { return interval_; }  ///< us
  [[nodiscard]] Moment moment() const;                        ///< the truth now
  [[nodiscard]] Secrets secrets() const;
  [[nodiscard]] const ContactCounts& contacts() const;
  /// Names of the instruments that are carried here.
  [[nodiscard]] std::vector<std::string> sensors() const;
  /// One line about a command that the thrusters cannot follow; empty when they can. Of the last step.
  [[nodiscard]] const std::string& complaint() const { return complaint_; }
  /// < 1: a thruster was at its limit in the last step.
  [[nodiscard]] double scale() const { return scale_; }

 private:
  struct Slot;
  struct Pending;
  struct Faults;
  void actuate();
  [[nodiscard]] model::Allocated sent() const;
  void take(Slot& slot, Utime until);
  void tell(Slot& driver, Utime utime);
  [[nodiscard]] Utime spoil(Slot& slot, Utime utime);
  void deliver(Utime until);

  model::Vehicle vehicle_;  ///< as the others know it
  model::Vehicle whole_;    ///< with all six degrees of freedom
  model::Site site_;
  Utime origin_, interval_;
  double largest_;  ///< N, of one thruster
  model::ThrusterAllocation allocation_;
  std::shared_ptr<const model::LearnedForce> learned_;  ///< of the truth
  std::unique_ptr<Body> body_;
  std::unique_ptr<Faults> faults_;  ///< hidden effects that alter what sensors say
  AhrsTold ahrs_{};
  double told_voltage_{};  ///< V, newest BATTERY sample taken
  Utime truth_period_{}, next_truth_{};
  std::vector<Slot> slots_;
  Thrusters told_{};      ///< to the thrusters, last
  bool feedback_{false};  ///< an instrument of its own tells what they do; else their driver does
  std::vector<Pending> pending_;
  std::vector<Failure> failures_;
  std::vector<Sample> taken_, out_;
  std::vector<Utime> due_;
  std::uint64_t order_{};
  std::optional<WrenchCommand> heard_, acting_;
  std::optional<std::vector<double>> driven_;
  std::string complaint_;
  double scale_{1.0};
};

}  // namespace fathom::simulation
