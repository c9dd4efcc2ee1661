// What the bus has said, as the page of the board needs it: samples in, one JSON text out.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/board/chronicle.hpp"
#include "common/board/history.hpp"
#include "common/board/place.hpp"
#include "common/board/roll.hpp"
#include "common/board/thinned.hpp"
#include "common/samples/commands.hpp"
#include "common/samples/estimates.hpp"
#include "common/samples/health.hpp"
#include "common/samples/sensors.hpp"
#include "common/samples/vehicle_condition.hpp"

namespace fathom::board {

/// Pure: times are passed in, in seconds of any steady clock. It keeps the newest of everything, of bounded size
/// whatever is said on the bus.
class Board {
 public:
  /// Who shows the board: its own words are no sign of life of the bus.
  struct Self {
    std::string host;
    std::int32_t pid{};
    std::string bus;  ///< for people
  };
  explicit Board(Self self) : self_{std::move(self)} {}

  void hear(const Health& sample, double now);
  void hear(const Excitation& sample, double now);
  void hear(const Thrusters& sample, double now) { take(thrusters_, sample, now); }
  void hear(const WrenchCommand& sample, double now) { take(command_, sample, now); }
  void hear(const Battery& sample, double now) { take(battery_, sample, now); }
  void hear(const StateEstimate& sample, double now);
  void hear(const ModelEstimate& sample, double now);
  void hear(const EffectRanking& sample, double now);
  void hear(const LearnedTold& sample, double now);
  void hear(const Residual& sample, double now);
  void hear(const VehicleCondition& sample, double now);
  void hear(const Answer& sample, double now) { chronicle_.hear(sample, now); }
  /// Its files say where the trial takes place. No sign of life: the board says its own.
  void hear(const ProcessInfo& sample, double now);
  /// What files say of the place; InputError as their readers throw it.
  void take(const Config& file) { place_.take(file); }
  /// To be called now and then: who has fallen silent is noted.
  void watch(double now);

  /// What became of an abort that was asked for on the page: "asked", "confirmed", "not confirmed".
  void tell_abort(const std::string& state, const std::string& words, double now);
  /// A log is played: where it is [s] of its whole length [s].
  struct Replay {
    double at{}, length{};
    bool over{false};
  };
  void tell_replay(const Replay& replay) { replay_ = replay; }

  /// One object; numbers that are not finite are null, and text is made valid. `number` tells one text from the next.
  [[nodiscard]] std::string json(double now, std::int64_t number) const;

  template <class Sample>
  struct Heard {
    Sample sample;
    double at{};
  };

 private:
  template <class Sample>
  void take(std::optional<Heard<Sample>>& to, const Sample& sample, double now) {
    to = Heard<Sample>{sample, now};
    heard_ = now;
  }

  Self self_;
  std::optional<double> heard_;  ///< when anybody else last said anything
  Roll roll_;
  Chronicle chronicle_;
  Place place_;
  std::map<std::string, std::string> told_;  ///< configuration that each process told of last
  History<MotionRow> history_;
  History<WrenchRow> residuals_;
  Thinned<std::array<double, 2>> track_{800, 0.25};                   ///< x, y [m in W] of the whole trial
  Thinned<std::vector<std::array<double, 3>>> converging_{100, 1.0};  ///< value, low, high of each parameter
  std::vector<std::string> names_;                                    ///< of these parameters
  std::optional<Heard<Excitation>> excitation_;
  std::optional<Heard<Thrusters>> thrusters_;
  std::optional<Heard<WrenchCommand>> command_;
  std::optional<Heard<Battery>> battery_;
  std::optional<Heard<StateEstimate>> state_;
  std::optional<Heard<ModelEstimate>> model_;
  std::optional<Heard<EffectRanking>> ranking_;
  std::optional<Heard<LearnedTold>> learned_;
  std::optional<Heard<Residual>> residual_;
  std::optional<Heard<VehicleCondition>> vehicle_;
  struct Abort {
    std::string state, text;
  };
  std::optional<Heard<Abort>> abort_;
  std::optional<Replay> replay_;
};

}  // namespace fathom::board
