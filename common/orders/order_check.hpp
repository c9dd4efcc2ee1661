// Whether an order may be obeyed: signed, to this life of the thruster driver, not heard before, of now, and given
// after the last abort. The thruster driver and the supervisor judge by the same rules, each for itself.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "common/samples/commands.hpp"

namespace fathom::orders {

/// A challenge is drawn by chance whenever a gate (who moves the thrusters) starts, and ANSWER tells it. An order
/// quotes it, so that no order to a driver that has died can arm its successor, without anything being kept on a disk.
/// Within a life numbers rise; they come from ANSWER, and so does the time: an operator's clock counts for nothing.
class OrderCheck {
 public:
  static constexpr std::int64_t kAhead = 1000;  ///< numbers that may be left out: so no order can lock out all others

  /// `age` [s] that an order's time may be off.
  explicit OrderCheck(double age) : age_{age} {}

  /// A gate's life begins, or is heard of: its challenge, and the number that was accepted last. Once more: nothing.
  void begin(std::int64_t challenge, std::int64_t accepted = 0);
  /// Why it may not be obeyed; empty: it may. Not asked about an abort, which everybody may order.
  [[nodiscard]] std::string_view objection(const Operator& order, Utime now) const;
  void accept(const Operator& order) {
    accepted_ = order.sequence;
    last_ = order.utime;
  }
  /// An order that was given before an abort, and comes after it, is not meant any more: it was on its way, or is said
  /// again, or somebody kept it back.
  void abort(Utime now) { aborted_ = now; }
  /// The order that was accepted last has come once more, as a console sends it where answers are lost.
  [[nodiscard]] bool again(const Operator& order) const {
    return order.authentic && last_ && order.challenge == challenge_ && order.sequence == accepted_ &&
           order.utime == *last_;
  }

  [[nodiscard]] std::int64_t challenge() const { return challenge_; }
  [[nodiscard]] std::int64_t accepted() const { return accepted_; }

 private:
  double age_;
  std::int64_t challenge_{};  // 0: no gate was heard
  std::int64_t accepted_{};
  std::optional<Utime> last_{};     // time of the order that was accepted last
  std::optional<Utime> aborted_{};  // when an abort was heard last
};

}  // namespace fathom::orders
