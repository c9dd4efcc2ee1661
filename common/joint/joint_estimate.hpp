// State and parameters estimated together: the instruments' messages and the thrusters' forces in, the base model's
// parameters out. Samples are taken in the order of their own times, `lag` behind the newest attitude, so that neither
// lateness nor the order of arrival changes a number.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/estimation/online/navigator.hpp"
#include "common/identification/identifier.hpp"
#include "common/joint/innovation_colour.hpp"
#include "common/joint/joint_filter.hpp"

namespace fathom {
class Config;
}

namespace fathom::joint {

/// What the joint estimate needs beside the settings of estimator and identifier.
struct JointSettings {
  double acceleration{3e-3};     ///< m/s^2, mean over a second of what the model lacks along X Y Z
  double turning{1e-2};          ///< rad/s^2, likewise about K M N
  double attitude_memory{30.0};  ///< s for which an attitude's error goes on
  double inertial_scale{0.0};    ///< share by which accelerometers and gyros may be off in proportion
  double mounting{0.0};          ///< rad by which their axes may be turned against the body's
  /// Keys: unmodelled_acceleration, unmodelled_turning, attitude_memory, inertial_scale; mounting, if it is known.
  [[nodiscard]] static JointSettings from(const Config& config);
};

class JointEstimate {
 public:
  /// InputError when the vehicle moves along an axis whose inertia is no parameter.
  JointEstimate(const JointSettings& settings, const identification::IdentifierSettings& identifier,
                const estimation::NavigatorSettings& navigator, const estimation::NavigatorPlaces& places,
                const model::Vehicle& vehicle);

  /// Samples, in any order between channels.
  void hear(const Ahrs& sample);
  void hear(const TagPose& sample);
  void hear(const OpticalFlow& sample);
  void hear(const LaserRange& sample);
  void hear(const Dvl& sample);
  void hear(const Usbl& sample);
  void hear(const Depth& sample);
  /// Where the motion begins, and which attitudes can be trusted: those of valid states.
  void hear(const StateEstimate& state);
  /// tau [N, N m] from then on.
  void hear(Utime utime, const Vector6d& tau);
  /// From then on, by their number, these are not learnt.
  void hear(Utime utime, std::vector<int> held);

  /// Goes on to the next attitude that nothing can come before any more; its time, or nothing when there is none.
  [[nodiscard]] std::optional<Utime> next();

  /// What somebody else knows of the parameters, in SI, at the time that next() has reached. Taken on for every axis
  /// whose inertia it knows well enough and that has not begun: from there on this axis is learnt here.
  void offer(const ParameterVector& mean, const ParameterMatrix& covariance);
  /// Every axis is learnt here.
  [[nodiscard]] bool started() const { return started_; }
  /// s by which it waits for the latest of its instruments.
  [[nodiscard]] double lag() const { return lag_; }
  [[nodiscard]] std::int64_t rows() const { return rows_; }
  [[nodiscard]] const JointFilter& filter() const { return filter_; }
  /// In SI, unconstrained.
  [[nodiscard]] ParameterVector estimate() const { return filter_.model().physical(filter_.parameters()); }
  [[nodiscard]] ParameterMatrix covariance() const;
  [[nodiscard]] std::map<std::string, std::int64_t> rejected() const { return rejected_; }
  bool restore(const ParameterVector& mean, const ParameterMatrix& covariance);

 private:
  enum class Kind : std::uint8_t { kInput, kAttitude, kTag, kFlow, kLaser, kDvl, kUsbl, kDepth };
  /// A sample that waits for its turn.
  struct Event {
    Utime utime{};
    Kind kind{};
    Vector6d tau{Vector6d::Zero()};
    Eigen::Quaterniond q_WB{Eigen::Quaterniond::Identity()};
    Eigen::Vector3d a{Eigen::Vector3d::Zero()};  // rates; position, velocity or p_WT of a tag
    Eigen::Vector3d b{Eigen::Vector3d::Zero()};  // specific force; vector from body to tag; what a fix says of itself
    double sigma{};
    const estimation::CameraMount* camera{};
  };
  struct Seen {
    Eigen::Vector3d a{Eigen::Vector3d::Zero()}, b{Eigen::Vector3d::Zero()};
    int repeated{};
    Utime utime{};
  };
  struct Wish {
    Utime utime{};
    std::vector<int> held;
  };

  void wait(const Event& event);
  void go_to(Utime utime);
  void take_attitude(const Event& event);
  void follow_attitude(const Event& event);
  void begin(const Event& event);
  void lose(const char* why);
  void obey(Utime utime);
  [[nodiscard]] Eigen::Matrix3d told(Utime utime) const;
  [[nodiscard]] const StateEstimate* state_at(Utime utime) const;
  [[nodiscard]] bool frozen(const Event& event);
  [[nodiscard]] double lasting(Kind kind, Utime utime, double systematic);
  void use(std::size_t first, std::size_t last);
  void use_tags(std::size_t first, std::size_t last);
  void use_flow(const Event& event);
  void use_laser(const Event& event);
  void use_others(const Event& event);
  void use_inertial(const Event& event, double dt);
  [[nodiscard]] bool of_floor(const Eigen::Vector3d& p_B, const Eigen::Matrix3d& R_WB) const;
  void add_systematic(ParameterMatrix& covariance) const;
  void begin_anew(const char* why);
  void correct(std::size_t count, const char* refused);

  JointSettings settings_;
  estimation::NavigatorSettings navigator_;
  estimation::NavigatorPlaces places_;
  double max_input_gap_, freeze_delay_, attitude_offset_, lag_;
  JointFilter filter_;
  const JointFilter prior_;
  std::vector<Event> waiting_;  // in the order of time, then kind; the first done_ are used up
  std::size_t done_{};
  std::vector<StateEstimate> states_;  // a ring
  std::size_t newest_state_{};
  std::vector<Wish> wishes_;
  std::optional<Utime> newest_, now_;    // newest attitude heard; where the filter is
  std::optional<Event> before_, ahead_;  // attitudes around now_
  std::array<Event, 4> lately_{};        // last attitudes, for the derivative of rates that no model moves
  int attitudes_{};
  std::optional<Utime> input_at_;
  Vector6d tau_{Vector6d::Zero()};
  std::array<Seen, 8> seen_{};
  std::array<InnovationColour, 6> colour_{};  ///< of accelerations and rates
  std::vector<int> held_;
  std::array<JointRow, 3> at_once_;
  bool running_{false}, started_{false};
  int refused_in_a_row_{};
  std::int64_t rows_{};
  std::map<std::string, std::int64_t> rejected_;
};

}  // namespace fathom::joint
