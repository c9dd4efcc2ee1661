// The supervisor's mind: STATE, MODEL and the operator's orders in; WRENCH_COMMAND and EXCITATION out. It runs the
// schedule of Karras et al. (Fig. 1.3) or a designed experiment, holds and trims the axes that are not excited, keeps
// the vehicle inside its fence, and gives no thrust whenever something is doubtful. Time is that of STATE.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/excitation/depth_action.hpp"
#include "common/excitation/design.hpp"
#include "common/excitation/fence.hpp"
#include "common/excitation/hold.hpp"
#include "common/excitation/leaving.hpp"
#include "common/excitation/needs.hpp"
#include "common/excitation/paper_signal.hpp"
#include "common/model/manoeuvres.hpp"
#include "common/model/vehicle.hpp"
#include "common/orders/order_check.hpp"
#include "common/samples/commands.hpp"
#include "common/samples/estimates.hpp"
#include "common/samples/health.hpp"
#include "common/samples/vehicle_condition.hpp"

namespace fathom {
class Config;
}
namespace fathom::model {
struct Site;
}

namespace fathom::excitation {

struct SupervisorSettings {
  std::uint64_t seed{1};
  bool optimal{false};                 ///< designed segments on all axes instead of the paper's schedule
  double rate{20.0};                   ///< Hz of commands, STATE permitting
  double life{0.3};                    ///< s of a command
  Vector6d largest{Vector6d::Zero()};  ///< N, N m per axis: of excitation and holding together
  std::vector<Mode> schedule;
  double low_share{0.4};
  double highest_frequency{0.3};  ///< Hz
  double submode_time{12.0};      ///< s
  double interval_time{3.0};      ///< s between draws
  bool random_amplitude{false};
  double least_dwell{10.0};  ///< s in a mode before it may be left
  double most_dwell{120.0};  ///< s after which it is tried again
  int retries{1};
  double approach_time{15.0};  ///< s at most to the place where a mode begins
  double closing_time{2.0};    ///< s of holding still at the end
  double patience{3.0};        ///< s without a valid state after which the operator must arm again
  double model_patience{0.0};  ///< s of valid states without a MODEL after which nothing is excited; 0: for ever
  double order_age{5.0};       ///< s that an order may be old
  double manual_life{0.5};     ///< s after which an order to steer has aged out: the dead man
  bool holds_without_operator{false};  ///< it stays where it is when the operator is lost; else it aborts
  bool wants_operator{false};          ///< who arms must stay, and give signs of life
  int flights{0};                      ///< proposed segments that may be flown at the end without an order
  double open_range{8.0};              ///< m around the place of arming, where walls, floor and surface are farther
  std::vector<std::string> needs;      ///< processes that must be well
  model::AfterAbort after_abort;       ///< of the vehicle file
  double surface{};                    ///< m, z of Bo with the vehicle's top at the water's surface
  double silence{5.0};                 ///< s without HEALTH after which one of them counts as gone, in real time
  HoldSettings hold;
  FenceSettings fence;
  LeavingSettings leaving;
  DesignSettings design;

  /// Keys as in docs/configuration.md; the fence from site and hull.
  [[nodiscard]] static SupervisorSettings from(const Config& config, const model::Vehicle& vehicle,
                                               const model::Site& site);
};

/// With these words EXCITATION says that a segment could not be flown.
inline constexpr char kNotFlown[] = "not flown: ";

/// What an operator may want to see at any time.
enum class Phase { kDisarmed, kApproach, kExcite, kHold, kManual, kDone, kAborted, kLost };
[[nodiscard]] const char* name(Phase phase);

class Supervisor {
 public:
  struct Output {
    std::optional<WrenchCommand> command;
    std::optional<Excitation> excitation;
  };
  /// How a mode ended.
  struct Visit {
    std::string mode;
    double begun{}, ended{};  ///< s since arming
    bool left{false};         ///< all tests agreed; else given up or skipped
    std::string missing;
  };

  /// InputError when the schedule asks for a motion that the vehicle does not have.
  Supervisor(const SupervisorSettings& settings, const model::Vehicle& vehicle);

  /// The reference is good until the next call.
  const Output& step(const StateEstimate& state);
  void hear(const ModelEstimate& model);
  /// What became of it; to be said.
  Answer hear(const Operator& order);
  /// Of who moves the thrusters: what orders must quote. Others' answers are none of its business.
  void hear(const Answer& answer);
  void hear(const Health& health);
  /// A grave condition of the vehicle (a leak, a failsafe, an empty battery) ends a trial at once.
  void hear(const VehicleCondition& vehicle);
  /// In real time alone, some ten times a second, by any steady clock [s]: what has ceased to come is missed here.
  void watch(double now);
  /// What the diagnoser suspects is named beside a residual that does not fit; what it proposes may be flown.
  void hear(const EffectRanking& ranking);
  /// A log started over: disarmed, nothing known.
  void reset();

  [[nodiscard]] Phase phase() const { return phase_; }
  [[nodiscard]] const std::string& reason() const { return reason_; }
  /// The reason, and what a vehicle that still floats may do meanwhile.
  [[nodiscard]] std::string doing() const;
  [[nodiscard]] const std::vector<Visit>& visits() const { return visits_; }
  [[nodiscard]] const Fence& fence() const { return fence_; }

 private:
  static constexpr double kRounding = 1e-4;  // s: stamps are whole microseconds

  /// A segment that is flown by its name, whatever the schedule says.
  struct Flight {
    Segment segment;
    double duration{};    // s
    std::string purpose;  // "to tell ... from ..."
    Phase before{};       // what goes on afterwards; kDone: nothing
    std::optional<model::ManoeuvrePilot>
        pilot{};           // of a preset: flies in place of the segment, in shares of the largest
    bool one_turn{false};  // over when it has come round once: a tether is no coil
    double turned{};       // rad, at its begin
  };
  struct Proposal {
    std::string segment;
    double duration{};
    std::string purpose;
  };
  [[nodiscard]] std::string order(const Operator& order);
  [[nodiscard]] std::string obey(const Operator& order);
  /// Why it does not arm where the vehicle is, or cannot know it; empty: nothing speaks against the place.
  [[nodiscard]] std::string against_the_place() const;
  [[nodiscard]] std::string place() const;
  void miss_operator();
  [[nodiscard]] bool arm();
  void fly(const Operator& order);
  void refuse(const std::string& why);
  void stay(const std::string& why);
  /// From the surface into the room, `dt` [s] since the last; false: it is there, and what was ordered may go on.
  [[nodiscard]] bool descend(double dt);
  void resume();
  void take_off();
  void land(const std::string& how);
  void finish(const std::string& reason);
  enum class Then { kAsTheVehicleFileSays, kZero };
  void stop(Phase phase, const std::string& reason, Then then = Then::kAsTheVehicleFileSays);
  void enter(std::size_t mode);
  void begin();
  void finish_mode(bool left, const std::string& missing);
  void judge(double now);
  [[nodiscard]] Vector6d probe(double dt);
  void turn(const std::array<bool, 6>& axes);
  [[nodiscard]] Place place_for(const Mode& mode) const;
  [[nodiscard]] double turned_towards(double heading) const;
  [[nodiscard]] bool arrived() const;
  void say(const Vector6d& tau, const Vector6d& probe, bool bent);
  [[nodiscard]] const Mode& mode() const { return settings_.schedule[mode_]; }
  [[nodiscard]] double now() const { return seconds_between(armed_at_, state_.utime); }
  [[nodiscard]] bool excites(int axis) const;

  SupervisorSettings settings_;
  model::Vehicle vehicle_;
  orders::OrderCheck check_;
  Fence fence_;
  Hold hold_;
  Designer designer_;
  std::vector<std::optional<PaperSignal>> signals_;  // by axis
  std::optional<Segment> segment_;
  double segment_since_{};
  std::optional<Flight> flight_;
  std::optional<Proposal> proposal_;  // of the newest EFFECTS
  int flights_{};                     // without an order, since arming
  std::string closing_;               // the schedule's last words; empty: it did not come to its end
  std::string refused_;               // what could not be flown, and why
  Phase phase_{Phase::kDisarmed};
  std::string reason_{"waits for the operator to arm"};
  bool armed_{false};
  Answer answered_;                              // to the order that was accepted last
  std::int64_t armed_by_{}, armed_challenge_{};  // kept after a stop: the zeros that follow it must be obeyed
  std::int64_t commands_{};                      // number of the last one
  double attends_{};                             // s between the operator's signs of life; 0: nobody stays
  Utime sign_of_life_{};
  bool operator_is_lost_{false};
  Needs needs_;
  DepthAction after_;
  std::string grave_;                // what speaks against any trial, by the vehicle's own words
  std::string ended_;                // why the last trial ended
  bool taken_{false};                // the vehicle says that it is disarmed
  std::optional<double> watched_{};  // s
  double state_came_{};              // s, as far as watch() has seen
  Utime state_seen_{};
  StateEstimate state_;
  bool has_state_{false};
  double turned_{}, last_heading_{};
  double descending_{};  // s
  std::optional<ModelEstimate> model_;
  bool model_is_new_{false};
  double since_model_{};  // s of valid states
  LeavingVerdict verdict_;
  std::string suspect_;
  Utime armed_at_{}, last_command_{}, lost_since_{};
  std::size_t mode_{};
  int attempt_{};
  double phase_since_{}, dwell_{}, mode_since_{};
  Place place_;
  Eigen::Vector3d middle_{Eigen::Vector3d::Zero()};
  Vector6d manual_{Vector6d::Zero()};
  Utime manual_at_{};
  std::vector<std::string> frozen_;
  std::vector<Visit> visits_;
  Output output_;
};

}  // namespace fathom::excitation
