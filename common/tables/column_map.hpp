// What the columns of a table mean: stream, unit and frame of each. Nothing about any one data set is in code.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

namespace fathom::tables {

/// A column of the table and the line of the map that names it.
struct Column {
  std::string name;
  std::string where;  ///< "map.yaml:12", or empty when no map was used
  bool absent{};      ///< there is no such column: zero
  bool negated{};     ///< of a flag: set where the column is zero
};

/// Columns with one factor to SI; `to_house` turns a vector's frame into W (NED) or B (forward-right-down). A map may
/// name fewer than the group has components: complete_groups (absent.hpp) finds their places.
struct ColumnGroup {
  std::vector<Column> columns;
  double factor{1.0};
  Eigen::Matrix3d to_house{Eigen::Matrix3d::Identity()};
};

/// Attitude as a quaternion (columns sorted w x y z) or Euler angles (roll pitch yaw, ZYX), of `body` in `world`.
struct AttitudeColumns {
  ColumnGroup group;
  bool euler{false};
  Eigen::Matrix3d world_to_house{Eigen::Matrix3d::Identity()};
  Eigen::Matrix3d body_to_house{Eigen::Matrix3d::Identity()};
  double heading_sign{1.0}, heading_offset{};  ///< heading := sign * logged + offset [rad], after all turns of axes
  bool world_to_body{};                        ///< the quaternion turns the world's vectors into the body's
};

/// Rows in which a stream says nothing: a flag column is not zero, or (detect) the values repeat those of the row
/// before.
struct HeldRule {
  std::optional<Column> flag;
  bool detect{false};
};

struct PoseColumns {
  std::optional<ColumnGroup> position;
  std::optional<AttitudeColumns> attitude;
  HeldRule held;
  std::vector<Column> invalid_where;
  bool geodetic{};  ///< `position` holds latitude, longitude [factor to rad] and height [m, up; may be absent]
};

struct AhrsColumns {
  std::optional<ColumnGroup> rates;
  std::optional<ColumnGroup> specific_force;
  std::optional<AttitudeColumns> attitude;
  std::vector<Column> invalid_where;
  bool euler_rates{};     ///< rates of roll, pitch and yaw angle
  bool rates_in_world{};  ///< about the world's axes; `rates->to_house` turns them to NED
};

struct DvlColumns {
  ColumnGroup velocity;
  std::optional<ColumnGroup> altitude;  ///< one column
  HeldRule held;
  std::vector<Column> invalid_where;
  bool in_world{};         ///< along the world's axes; `velocity.to_house` turns them to NED
  double course_factor{};  ///< not 0: `velocity` holds course over ground (this factor to rad) and speed
};

/// Thrust of a propeller in still water: f = k n |n|, n its shaft's speed [rad/s].
struct SpeedColumns {
  ColumnGroup speed;         ///< factor to rad/s; order of the vehicle file
  double ahead{}, astern{};  ///< k for positive and negative n, N/(rad/s)^2
};

/// Commands between -1 and 1: pulse = neutral + full * command.
struct CommandColumns {
  ColumnGroup command;       ///< order of the vehicle file
  double neutral{}, full{};  ///< us
};

/// The pilot's sticks as pulses, which ArduSub's mixer turns into those of the motors.
struct StickColumns {
  ColumnGroup pulses;         ///< of its channels 1 to 6: pitch, roll, throttle, yaw, forward, lateral
  std::string frame;          ///< common/drafts/ardusub_frames.hpp
  double coupling{};          ///< MOT_FV_CPLNG_K
  std::vector<int> reversed;  ///< outputs whose direction is -1
  double neutral{}, full{};   ///< us: sticks and motors at neutral + full * command
};

/// Commands of actuators of different kinds, each in its own unit.
struct InputColumns {
  ColumnGroup group;               ///< order of the vehicle file
  std::vector<std::string> units;  ///< as the map states them
  std::vector<double> factors;     ///< to us, rad/s, rad, N, m^3, kg or m
};

struct ThrusterColumns {
  std::optional<ColumnGroup> pwm;  ///< factor to us
  std::optional<StickColumns> sticks;
  std::optional<InputColumns> inputs;
  std::optional<CommandColumns> command;
  std::optional<ColumnGroup> force;  ///< order of the vehicle file
  std::optional<SpeedColumns> speed;
  std::optional<ColumnGroup> wrench_force;  ///< until it is completed: all columns of a short list
  std::optional<ColumnGroup> wrench_moment;
  std::vector<Column> invalid_where;
};

struct ScalarColumn {
  ColumnGroup group;  ///< one column; the sign of its direction is in the factor
  std::vector<Column> invalid_where;
  double offset{};  ///< added: of a pressure, the atmosphere's part
  double weight{};  ///< of a pressure: density times gravity [N/m^3], by which it was divided; else 0
};

/// Fixes of an acoustic positioning system.
struct UsblColumns {
  ColumnGroup position;
  std::optional<ColumnGroup> sigma;  ///< standard deviations along the axes of the position
  double stated_sigma{};             ///< m, where no column says
  std::vector<Column> invalid_where;
};

/// Several numbers of one kind, in the order of the site's transponders or of the vehicle's load cells.
struct ListColumns {
  ColumnGroup group;
  std::vector<Column> invalid_where;
};

/// A column of its own, or one number for all rows.
struct ColumnOrNumber {
  std::optional<ColumnGroup> group;  ///< one column
  std::optional<double> number;
};

/// Poses of tags as a camera saw them, in its frame C (x right, y down, z out).
struct TagColumns {
  std::string camera;  ///< name in the vehicle file
  ColumnOrNumber tag;  ///< number of the tag
  ColumnGroup position;
  ColumnGroup quaternion;  ///< w x y z, of the tag in C
  ColumnOrNumber error;    ///< px
  std::vector<Column> invalid_where;
};

struct FlowColumns {
  std::string camera;
  ColumnGroup flow;         ///< along x and y of C
  ColumnOrNumber interval;  ///< s
  ColumnOrNumber sigma;     ///< rad/s
  ColumnOrNumber tracks;
  std::vector<Column> invalid_where;
};

/// Laser dots, in the frame C of the camera that saw them.
struct LaserColumns {
  std::string camera;
  ColumnGroup position;
  ColumnOrNumber sigma;  ///< m, along the line of sight
  std::vector<Column> invalid_where;
};

/// A column that is carried as it is, to stand in a model later.
struct SignalColumn {
  ColumnGroup group;     ///< one column; factor to `unit`
  std::string written;   ///< unit as the map states it
  std::string unit;      ///< SI, rad; else as written
  std::string quantity;  ///< of lcmtypes/signal_t.lcm; empty where the map does not say
};

struct SignalColumns {
  std::vector<SignalColumn> columns;
  std::vector<Column> invalid_where;
};

struct ColumnMap {
  std::string source;   ///< where the data come from
  std::string licence;  ///< under which terms
  ColumnGroup time;     ///< one column, or several that are added (seconds and nanoseconds, a date and a time of day)
  std::vector<double> time_factors;  ///< per column, to s; 1 for dates
  std::optional<PoseColumns> pose_capture;
  std::optional<AhrsColumns> ahrs;
  std::optional<DvlColumns> dvl;
  std::optional<ScalarColumn> depth;
  std::optional<ThrusterColumns> thrusters;
  std::optional<ScalarColumn> battery;
  std::optional<UsblColumns> usbl;
  std::optional<ListColumns> ranges;
  std::optional<ListColumns> loads;
  std::optional<TagColumns> tag_pose;
  std::optional<FlowColumns> optical_flow;
  std::optional<LaserColumns> laser_range;
  std::optional<SignalColumns> wind;  ///< speed and from where it blows
  std::optional<SignalColumns> signals;

  /// Reads a map; InputError "file:line: what" for an unknown key, unit or frame.
  [[nodiscard]] static ColumnMap load(const std::string& path);
  /// The same for text; `name` stands for the file in messages.
  [[nodiscard]] static ColumnMap parse(const std::string& text, const std::string& name);
};

}  // namespace fathom::tables
