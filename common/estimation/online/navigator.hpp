// The estimator of a trial (Karras et al., sec. 1.3.2): an attitude sensor as input; tags, optical flow and a laser's
// dot in shallow water, acoustic position, velocity log and depth in deep water. STATE leaves with every attitude
// sample. A measurement counts from its stated delay after its own time on; it is then put in at its own time and
// everything since is computed anew, so that neither lateness nor the order of arrival changes a number.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/estimation/online/camera_geometry.hpp"
#include "common/estimation/online/clock_check.hpp"
#include "common/estimation/online/complementary_filter.hpp"
#include "common/estimation/online/navigation_filter.hpp"
#include "common/samples/estimates.hpp"
#include "common/samples/sensors.hpp"
#include "common/samples/vision.hpp"

namespace fathom {
class Config;
}
namespace fathom::model {
struct Mounts;
struct Site;
}  // namespace fathom::model

namespace fathom::estimation {

/// How one kind of measurement is used. Cut-offs are where the measurement ends and the accelerometer begins.
struct AidSettings {
  bool used{false};
  double cutoff{};           ///< rad/s, horizontal
  double vertical_cutoff{};  ///< rad/s
  double damping{1.0};
  double vertical_damping{1.0};
  double noise{};       ///< m or m/s; what the sample itself states is added
  double systematic{};  ///< m or m/s that no averaging removes: part of what is stated, not of the gains
  double delay{};       ///< s after its time that it counts: at least its latency and the channel's jitter
  double max_age{};     ///< s; older than that it is said to be silent
  Eigen::Vector3d scale{Eigen::Vector3d::Ones()};  ///< of a velocity: true over what is read, along B
  double vertical_noise{};  ///< m, of tags, which an attitude's error moves across alone; zero: as `noise`
};

struct NavigatorSettings {
  bool published_gains{false};  ///< the numbers of the paper instead of gains from cut-off, damping and interval
  double gate{6.0};             ///< standard deviations beyond which a measurement is refused
  double max_gap{0.25};         ///< s without attitude sample after which the motion in between is unknown
  double attitude_noise{};      ///< rad
  /// rad by which roll and pitch, and the heading, wander for minutes, as their maker states: part of what is stated,
  /// not of the gains.
  double attitude_systematic{}, heading_systematic{};
  double rate_noise{};          ///< rad/s
  double acceleration_noise{};  ///< m/s in one second, across: accelerometer and what the attitude turns of gravity
  double vertical_acceleration_noise{};  ///< m/s in one second, level: the accelerometer alone; zero: as across
  double bias_walk{};                    ///< m/s^2 in one second
  double bias_prior{};                   ///< m/s^2
  double unknown_acceleration{0.5};      ///< m/s^2 that may have acted in a gap
  double largest_position_sigma{};       ///< m; beyond it the state is not valid
  double largest_velocity_sigma{};       ///< m/s
  AidSettings tags, flow, laser, dvl, usbl, depth;

  /// Keys as above, with units; one section for each aid that is used.
  [[nodiscard]] static NavigatorSettings from(const Config& config);
  /// rad, about north, east and down: all that an attitude is off by.
  [[nodiscard]] Eigen::Vector3d attitude_sigma() const {
    const double tilt = std::hypot(attitude_noise, attitude_systematic);
    return {tilt, tilt, std::hypot(attitude_noise, heading_systematic)};
  }
};

/// Where things are: on the vehicle and at the site.
struct NavigatorPlaces {
  [[nodiscard]] static NavigatorPlaces of(const model::Mounts& mounts, const model::Site& site);
  std::map<std::string, CameraMount> cameras{};
  std::map<int, Eigen::Vector3d> tags{};  ///< m, p_WT
  std::optional<double> floor{};          ///< m, z of a level floor
  Eigen::AlignedBox2d walls{Eigen::Vector2d::Constant(-HUGE_VAL), Eigen::Vector2d::Constant(HUGE_VAL)};  ///< m, x and y
  Eigen::Vector3d p_BI{Eigen::Vector3d::Zero()};  ///< m, accelerometer in the body
  double gravity{9.81};                           ///< m/s^2
};

/// The paper's gains, made for one interval at 30 Hz; zero for an aid that it has none for.
[[nodiscard]] AxisGains published_gains(Source source);

class Navigator {
 public:
  using Output = std::vector<StateEstimate>;

  /// InputError when an aid is used that its places do not allow (flow without floor, tags without a map).
  Navigator(const NavigatorSettings& settings, const NavigatorPlaces& places);

  /// One state per attitude sample, none for the rest. The reference is good until the next call.
  const Output& step(const Ahrs& sample);
  const Output& step(const TagPose& sample);
  const Output& step(const OpticalFlow& sample);
  const Output& step(const LaserRange& sample);
  const Output& step(const Dvl& sample);
  const Output& step(const Usbl& sample);
  const Output& step(const Depth& sample);
  void reset();

  /// Samples not used, by reason: "AHRS frozen", "tag unknown", "DVL gated", "USBL later than stated" (that one is
  /// used).
  [[nodiscard]] std::map<std::string, std::int64_t> rejected() const;
  /// Why STATE cannot be trusted now, or what it lacks; empty when all is well. For HEALTH.
  [[nodiscard]] std::string complaint() const;
  /// What is odd and can be lived with; empty when nothing is.
  [[nodiscard]] std::string remark() const;

 private:
  static constexpr std::size_t kHistory = 512;  // attitude samples: 5 s at 100 Hz
  static constexpr int kRepeats = 4;            // bit by bit the same: no noisy sensor does that while moving
  enum Reason { kGated, kFrozen, kWall, kLate, kOverdue, kMalformed, kReasons };
  struct Input {
    Eigen::Quaterniond q_WB{Eigen::Quaterniond::Identity()};
    Eigen::Vector3d w_B{Eigen::Vector3d::Zero()};
    Eigen::Vector3d f_B{Eigen::Vector3d::Zero()};
  };
  struct Measurement {
    Utime utime{};
    Source source{};
    bool counts{false};
    Eigen::Vector3d a{Eigen::Vector3d::Zero()};  // position, velocity, or p_WT of a tag
    Eigen::Vector3d b{Eigen::Vector3d::Zero()};  // vector from body to tag, or variances that the sample states
    double sigma{};
    const CameraMount* camera{};
  };
  /// What is remembered of one source.
  struct Track {
    std::optional<Utime> last;
    int accepted{};
    int refused{};
    int repeated{}, moved{};  // in a row; so many of them under way, all if the first was
    [[nodiscard]] bool repeats() const { return repeated >= kRepeats && moved >= kRepeats; }
    bool walled{};  // the newest was of a wall
    Eigen::Vector3d a{Eigen::Vector3d::Zero()}, b{Eigen::Vector3d::Zero()};
    std::array<std::int64_t, kReasons> rejected{};
  };
  /// Everything that rewinding brings back.
  struct Memory {
    NavigationFilter filter;
    std::array<Track, kSources> tracks{};
    bool started{false};
  };
  struct Node {
    Utime utime{};
    Input input;
    Memory after;
  };

  const Output& wait(const Measurement& measurement);
  [[nodiscard]] bool usable(const Ahrs& sample);
  bool refuse(const Ahrs& sample, const char* why);
  void without_ahrs(Source source, Utime utime);
  [[nodiscard]] Input input_of(const Ahrs& sample);
  void run(std::size_t from, Utime since);
  void advance(Memory& memory, const Node& before, const Node& after, Utime from, Utime to) const;
  [[nodiscard]] static Input between(const Node& before, const Node& after, Utime utime);
  void use(Memory& memory, std::size_t first, std::size_t last, const Input& input) const;
  void use_position(Memory& memory, const Measurement& m, const Eigen::Vector3d& p_WB, const Eigen::Vector3d& axes,
                    const Eigen::Vector3d& variance, const Input& input) const;
  void use_velocity(Memory& memory, const Measurement& m, const Eigen::Vector3d& v_B, const Eigen::Vector3d& axes,
                    const Eigen::Vector3d& variance, const Input& input) const;
  void use_tags(Memory& memory, std::size_t first, std::size_t last, const Input& input) const;
  void use_flow(Memory& memory, const Measurement& m, const Input& input) const;
  [[nodiscard]] bool of_floor(Memory& memory, const Measurement& m, const Eigen::Vector3d& p_B,
                              const Eigen::Matrix3d& R_WB) const;
  void use_laser(Memory& memory, const Measurement& m, const Input& input) const;
  [[nodiscard]] AxisGains gains(Source source, double interval, bool velocity_is_measured_vertically) const;
  [[nodiscard]] double share_of_laser(const Memory& memory, const Measurement& m, double variance) const;
  [[nodiscard]] bool passes(Track& track, double worst) const;
  /// True when so many were refused in a row that the estimate must be the one that is wrong.
  [[nodiscard]] static bool outvoted(const Track& track);
  [[nodiscard]] bool frozen(Memory& memory, const Measurement& m, const Input& input) const;
  [[nodiscard]] const AidSettings& aid(Source source) const;
  [[nodiscard]] const Node& newest() const { return nodes_[(first_ + count_ - 1) % kHistory]; }
  void say(const Node& node);
  void forget();

  NavigatorSettings settings_;
  NavigatorPlaces places_;
  bool vertical_velocity_;   // some aid measures it; else it is learnt from depth
  std::vector<Node> nodes_;  // a ring, oldest at first_
  std::size_t first_{}, count_{};
  std::vector<Measurement> waiting_;  // in the order of time, then kind
  ClockCheck clocks_;                 // of the aids, beside AHRS
  std::array<std::int64_t, kSources> late_{}, overdue_{}, malformed_{};
  std::map<std::string, std::int64_t> other_;
  std::optional<Ahrs> last_ahrs_;
  int ahrs_repeated_{};
  int attitude_jumps_{};
  /// Of each source the first sample since the last attitude that was used, and how long any of them has gone on since:
  /// nobody else's clock tells whether the attitude sensor is away.
  std::array<std::optional<Utime>, kSources> first_without_{};
  double without_ahrs_{};
  const char* refused_ahrs_{};  ///< why the last attitude was not used; null: none came since
  Output output_;
};

}  // namespace fathom::estimation
