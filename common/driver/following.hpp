// Does the vehicle apply what it is asked for?
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

namespace fathom::driver {

/// Compares forces of the thrusters [N], asked and reported, both through the same low pass, so that the delay of a
/// report is no difference. Of the reported forces the part along the asked ones counts: a vehicle that allocates by
/// itself may distribute otherwise, or weaker, but not elsewhere. Pure: times are passed in, in seconds of any steady
/// clock.
class Following {
 public:
  struct Limits {
    double least{};             ///< N, norm over all thrusters: below nothing is asked, and above something is applied
    double least_share{0.3};    ///< [1] of what is asked: an autopilot's gain may be low, a neutral output gives 0
    double time_constant{0.5};  ///< s of the low pass: reports come 2 to 20 times a second
    double hold{1.5};           ///< s that it must last: a ramp of the autopilot or a lost report does not
    double told{10.0};          ///< s that it stays told: without thrust nothing is asked, and nothing could be seen
  };
  explicit Following(const Limits& limits) : limits_{limits} {}

  /// The line was opened anew: what was reported is of another time.
  void restart() { reported_at_.reset(); }
  /// What is sent now; once per command.
  void asked(const Eigen::VectorXd& force, double now);
  /// What the vehicle reports.
  void applied(const Eigen::VectorXd& force, double now);
  /// One line with the remedy; empty while it follows, or reports nothing.
  [[nodiscard]] std::string trouble(double now) const;
  [[nodiscard]] bool reports(double now) const;

 private:
  Limits limits_;
  Eigen::VectorXd asked_, applied_, latest_;  // N; the first two through the low pass
  std::optional<double> step_at_, reported_at_;
  std::optional<double> weak_since_, unasked_since_;
  double told_until_{-1e9};
  std::string told_;
};

}  // namespace fathom::driver
