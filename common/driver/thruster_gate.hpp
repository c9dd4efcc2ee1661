// Whether a command may reach the thrusters now. Everything doubtful means zero thrust.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "common/orders/order_check.hpp"
#include "common/samples/commands.hpp"

namespace fathom::driver {

/// Zero until an operator has armed: an order to enable that orders::OrderCheck finds nothing against; so that neither
/// a stray publisher nor a replayed log can do it. An abort needs none of that and holds until the next arming. A
/// command must be signed, and newer than the last one: who copies one is not obeyed, and is named. It dies after its
/// stated life, after half a second without a new one, and when its own time is too old. It must name the order that
/// armed its commander: who has been publishing before, or goes on when the commander has refused, stopped or died, is
/// never obeyed. Of several who heard the order the first is; while another one speaks none is, and the other never
/// without a new arming. An arming that the supervisor refuses is taken back: nothing stays armed for nobody.
class ThrusterGate {
 public:
  static constexpr double kPause = 0.5;     ///< s
  static constexpr double kInVain = 0.25;   ///< s: longer than what is on its way when an operator aborts
  static constexpr double kOrderAge = 5.0;  ///< s that an order's own time may be off
  /// `challenge`: above 0, another one for every life of a driver. Times are those of messages: wall-clock
  /// microseconds, or virtual ones with a simulator.
  explicit ThrusterGate(std::int64_t challenge) { check_.begin(challenge); }

  void hear(const WrenchCommand& command, Utime now);
  /// What became of it; to be said. An order that comes twice, as a console sends it where answers are lost, is
  /// answered again and does nothing.
  Answer hear(const Operator& order, Utime now);
  /// The supervisor's answer to the order that armed: when it refuses and nobody is obeyed by an earlier one, the
  /// arming is taken back. True when it was.
  bool hear(const Answer& said, Utime now);
  /// What the next order must quote.
  [[nodiscard]] Answer answer(Utime now) const;
  [[nodiscard]] std::int64_t challenge() const { return check_.challenge(); }
  [[nodiscard]] std::int64_t accepted() const { return check_.accepted(); }
  /// The wrench to give now; zero whenever reason() says why.
  [[nodiscard]] Vector6d wrench(Utime now) const;
  /// Empty while a command is obeyed.
  [[nodiscard]] std::string_view reason(Utime now) const;
  [[nodiscard]] bool armed() const { return armed_; }
  /// Somebody has been asking for thrust for a while and believes to get it, but nobody has armed: as after a driver's
  /// death, whose successor did not hear the order.
  [[nodiscard]] bool ignores(Utime now) const;
  /// True while somebody whom no order has armed asks for thrust beside, or instead of, the one that was armed.
  [[nodiscard]] bool hears_stranger(Utime now) const;
  static constexpr const char* kStranger =
      "somebody whom no order has armed asks for thrust too, and is ignored: stop it";
  /// True while commands come that were not signed with this vehicle's key, or were heard before.
  [[nodiscard]] bool hears_forgeries(Utime now) const;
  /// How many, of what kind, and who they say they are from; empty while there were none.
  [[nodiscard]] std::string forgeries() const;
  /// Orders that were not believed, and why the last one was not.
  [[nodiscard]] std::int64_t refused() const { return refused_; }
  [[nodiscard]] std::string_view refusal() const { return refusal_; }

 private:
  [[nodiscard]] bool was_armed(const WrenchCommand& command) const;
  void hear_unarmed(const WrenchCommand& command, Utime now);
  void arm(Utime now);
  void disarm();
  void refuse(const WrenchCommand& command, Utime now);

  orders::OrderCheck check_{kOrderAge};
  bool armed_{false};
  bool aborted_{false};
  bool for_another_{false};     // another controller than the supervisor was armed, whose word counts for nothing then
  bool taken_back_{false};      // the supervisor refused what armed
  std::int64_t armed_since_{};  // of the order that armed, while commands went on
  std::optional<Utime> stranger_;  // when thrust was asked for by one whom no order armed
  std::optional<WrenchCommand> command_;
  Utime heard_{};
  std::optional<Utime> contested_;  ///< when another commander was heard last
  std::optional<Utime> asked_;      ///< since when thrust is asked for in vain
  std::optional<Utime> unarmed_;    ///< when it was asked so last
  bool ignores_{false};
  std::int64_t unsigned_{}, replayed_{};
  std::optional<Utime> forged_at_;
  std::string forger_;  // as it calls itself
  std::int64_t refused_{};
  std::string_view refusal_;
};

}  // namespace fathom::driver
