// How the processes are that a trial needs: by what they say of themselves in HEALTH, and in real time by whether they
// say anything.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/samples/health.hpp"

namespace fathom::excitation {

/// "A or B" to its names.
[[nodiscard]] std::vector<std::string> alternatives(const std::string& need);

class Needs {
 public:
  /// `needs`: names of processes. "A or B": where A has never spoken, B stands in for it; it must be there, but what it
  /// says of its own condition stops nothing (a simulator on a busy machine is late and says so).
  /// `silence` [s] without HEALTH after which a process counts as gone.
  Needs(const std::vector<std::string>& needs, double silence);

  void hear(const Health& health);
  /// Time passes, in seconds of any steady clock: in real time alone, and some ten times a second. In lockstep and from
  /// a log HEALTH has another clock than everything else, and nobody is called silent.
  void watch(double now);

  struct Trouble {
    std::string process;
    std::string what;    ///< "is unhealthy: ..."
    std::string remedy;  ///< what the operator should do
  };
  /// The worst of them; none when all is well.
  [[nodiscard]] std::optional<Trouble> trouble() const;
  /// Who fell silent, by the clocks of HEALTH itself; empty: nobody.
  [[nodiscard]] std::string behind() const;

 private:
  struct Word {
    Health health;
    bool fresh{true};            ///< came since the clock was looked at
    std::optional<double> at{};  ///< s of that clock
  };
  struct Need {
    std::string text;
    std::vector<std::string> names;  ///< itself, then those who may stand in
  };
  /// The name by which the need is met, if anybody has spoken yet.
  [[nodiscard]] const std::string* met_by(const Need& need) const;
  [[nodiscard]] std::optional<Trouble> gone(const Need& need) const;

  std::vector<Need> needs_;
  double silence_;
  std::map<std::string, Word> words_;
  std::optional<double> now_{}, since_{};
};

}  // namespace fathom::excitation
