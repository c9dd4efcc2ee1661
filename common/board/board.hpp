// What the bus has said, as the page of the board needs it: samples in, one JSON text out.
#pragma once

#include <optional>
#include <string>

#include "common/board/history.hpp"
#include "common/board/roll.hpp"
#include "common/samples/commands.hpp"
#include "common/samples/estimates.hpp"
#include "common/samples/health.hpp"
#include "common/samples/sensors.hpp"

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
  void hear(const Excitation& sample, double now) { take(excitation_, sample, now); }
  void hear(const Thrusters& sample, double now) { take(thrusters_, sample, now); }
  void hear(const WrenchCommand& sample, double now) { take(command_, sample, now); }
  void hear(const Battery& sample, double now) { take(battery_, sample, now); }
  void hear(const StateEstimate& sample, double now);
  void hear(const ModelEstimate& sample, double now) { take(model_, sample, now); }
  void hear(const EffectRanking& sample, double now) { take(ranking_, sample, now); }

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
  History history_;
  std::optional<Heard<Excitation>> excitation_;
  std::optional<Heard<Thrusters>> thrusters_;
  std::optional<Heard<WrenchCommand>> command_;
  std::optional<Heard<Battery>> battery_;
  std::optional<Heard<StateEstimate>> state_;
  std::optional<Heard<ModelEstimate>> model_;
  std::optional<Heard<EffectRanking>> ranking_;
};

}  // namespace fathom::board
