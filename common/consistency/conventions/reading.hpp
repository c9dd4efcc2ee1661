// Hypotheses about how the streams of a recording were meant: each is a transformation of one stream (or of streams
// that one slip changes together), with a name, the line of a map that says it, and a prior penalty. Named conventions
// come before turns, turns before reflections, one cause before two.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/estimation/corrections.hpp"

namespace fathom::consistency {

/// What is done to the streams: R_WB := Rz(heading) attitude_world R_read attitude_axes and so on.
struct Reading {
  estimation::QuaternionForm quaternion{estimation::QuaternionForm::kAsRead};
  estimation::HeadingSense sense{estimation::HeadingSense::kAsRead};
  Eigen::Matrix3d attitude_world{Eigen::Matrix3d::Identity()}, attitude_axes{Eigen::Matrix3d::Identity()};
  Eigen::Matrix3d position{Eigen::Matrix3d::Identity()};
  Eigen::Matrix3d velocity{Eigen::Matrix3d::Identity()}, rates{Eigen::Matrix3d::Identity()},
      force{Eigen::Matrix3d::Identity()};  ///< true := matrix logged, along `*_frame`
  estimation::VectorFrame velocity_frame{estimation::VectorFrame::kBody}, rates_frame{estimation::VectorFrame::kBody};
  bool free_heading{};  ///< the attitude is turned about the vertical by an angle that each run has for itself
  double heading{};     ///< rad, that angle
};

/// Prior penalties in nats (a factor e^-penalty of odds against "as read"): what people do wrong how often. A named
/// convention must be e^4 times as likely by the data before it counts, a mirror e^14 times.
struct PriorPenalties {
  double named{4.0};        ///< conventions that have a name
  double heading{5.0};      ///< a heading frame turned by some angle
  double turn{9.0};         ///< any other of the 24 turns of axes
  double reflection{14.0};  ///< any of the 24 mirrored axes: no rigid mount makes one
  double second{4.0};       ///< a second cause beside the first
  double body_axes{2.0};  ///< more for turned axes of the attitude: an instrument is sooner mounted turned than a pose
};

enum class Kind { kNamed, kHeading, kTurn, kReflection };

struct Hypothesis {
  std::string finding;  ///< "in_world_axes"
  std::string signal;   ///< "dvl", "gyro", "position", "attitude", "accelerometer", "pose", "twist"
  std::string words;    ///< one sentence
  std::string map;      ///< what to write in the map
  Kind kind{Kind::kNamed};
  Reading change;
  /// A sensor's own axes: the comparison of pairs names and corrects them, axis by axis.
  bool of_sensor_axes{};
  double size{1.0};
};

[[nodiscard]] double penalty(Kind kind);
/// All of them, the likelier kinds first.
[[nodiscard]] const std::vector<Hypothesis>& hypotheses();
/// `change` after `first`; nothing where both concern the same stream.
[[nodiscard]] bool compose(const Reading& first, const Reading& change, Reading& both);

/// "x = +y, y = +x, z = -z"
[[nodiscard]] std::string describe_axes(const Eigen::Matrix3d& axes, const char* letters = "xyz");

}  // namespace fathom::consistency
