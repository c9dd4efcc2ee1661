// Orders and their answers, as pairs: what an operator's commands share.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/excitation/preflight.hpp"
#include "processes/fathom/operator/console.hpp"

namespace fathom::tool {

struct OperatorOptions {
  std::string url{"udpm://239.255.76.67:7667?ttl=0"};
  std::string operator_file;
  std::string word, segment;
  double seconds{};
  std::vector<std::string> needs = excitation::usual_needs();
  double attend{};                  ///< s between signs of life at most; 0: as the bus says
  bool leave{false};                ///< nobody stays, even over a link
  bool no_supervisor{false};        ///< somebody else commands: only the thrusters' answer counts
  double force{10.0}, moment{1.0};  ///< N, N m at full throw, of steering
  std::string joystick;
  int dead_man{4};
};

/// Gives orders that quote what the vehicle tells, and hears what became of them.
class Orders {
 public:
  static constexpr double kMeet = 2.5;   ///< s in which who moves the thrusters must have been heard
  static constexpr double kReply = 2.0;  ///< s in which an order is answered; it is said again meanwhile

  /// InputError when nobody on the bus moves thrusters, more than one does, or he has another key.
  explicit Orders(Console& console);

  /// Waits for the answers. `supervisor`: the supervisor's counts too. Prints who said what.
  /// InputError, with the reason, when one refused or did not answer. What this order armed is then armed no more, and
  /// that is said too, or that it is NOT CONFIRMED.
  void give(const Operator& order, bool supervisor);
  /// The supervisor's answer to an order that changes nothing; nothing when it did not answer.
  [[nodiscard]] std::optional<Answer> ask(const Operator& order);
  /// Says it once and waits for nothing: signs of life, steering.
  void say(Operator order);

 private:
  [[nodiscard]] Operator numbered(Operator order);
  /// Says it, again where nobody hears, until `enough` was answered or kReply has passed. As it was said last.
  Operator exchange(const Operator& order, const std::function<bool()>& enough);
  [[nodiscard]] const Answer* answer(bool gate) const;
  void see_it_disarmed(const Operator& order, bool was_armed);

  Console& console_;
  std::int64_t given_{};
  std::int64_t challenge_{};
};

/// Told once, who stays or steers, when EXCITATION has ceased for kNobody.
inline constexpr double kNobody = 2.0;  // s
inline constexpr char kNobodySays[] =
    "nothing is heard of the supervisor: is it running, does STATE come? Without its commands there is no thrust";

/// s between signs of life that this operator promises; 0: none. Over a link they are given unless told otherwise.
[[nodiscard]] double promised(const OperatorOptions& options, const Console& console);
/// Stays with a vehicle that was armed: signs of life, and a line whenever the supervisor says something new, or, where
/// one commands (`supervised`), nothing any more. Returns when the trial is done; InputError when it ended otherwise.
/// Ctrl-C aborts.
void attend(Console& console, Orders& orders, double promised, bool supervised);
/// Line by line what must hold before anything moves, of the vehicle alone where no `supervisor` of ours commands;
/// InputError where it does not.
void go_through(Console& console, Orders& orders, const std::vector<std::string>& needs, bool supervisor);
/// Thrusters to zero. InputError "NOT CONFIRMED" unless THRUSTERS says within two seconds that they are.
void abort_now(Console& console, bool checked);
/// Keyboard or joystick to forces, until Ctrl-C.
void steer(const OperatorOptions& options);

}  // namespace fathom::tool
