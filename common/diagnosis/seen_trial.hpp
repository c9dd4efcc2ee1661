// What a live diagnoser has seen of a trial, kept for later passes over all of it: two hundred bytes an instant instead
// of five hundred. What follows from the rest is made again, to the same bits.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "common/base/time.hpp"
#include "common/identification/integral_regressor.hpp"
#include "common/model/motion.hpp"

namespace fathom::diagnosis {

/// One instant of the streams, ready to be asked.
struct LiveSample {
  identification::MotionSample motion;
  Eigen::Vector3d p_WB{Eigen::Vector3d::Zero()};
  Eigen::Quaterniond q_WB{Eigen::Quaterniond::Identity()};
  model::ActuatorForces force;
  double voltage{};
  bool has_position{};
  std::optional<Utime> commands_from;     ///< the grid of commands begins anew here
  std::vector<Eigen::VectorXd> commands;  ///< on that grid since the sample before
};

/// R_WB^T e_z of an attitude.
[[nodiscard]] inline Eigen::Vector3d down_of(const Eigen::Quaterniond& q_WB) {
  return q_WB.conjugate() * Eigen::Vector3d::UnitZ();
}

class SeenTrial {
 public:
  /// Nothing is seen yet; wrenches [N, N m] are `allocation` times forces.
  void begin(const model::Allocation& allocation);
  /// Every sample's wrench must be the allocation times its force, and its down_B that of q_WB.
  void keep(const LiveSample& sample);
  /// All of the i-th sample; `sample` keeps its storage, for those who walk through many.
  void get(std::size_t i, LiveSample& sample) const;
  /// Velocities and rates of all samples, turned.
  void turn(const Eigen::Matrix3d& velocities, const Eigen::Matrix3d& rates);
  void clear();
  [[nodiscard]] bool empty() const { return kept_.empty(); }
  [[nodiscard]] std::size_t size() const { return kept_.size(); }
  [[nodiscard]] Utime first() const { return kept_.front().utime; }
  [[nodiscard]] Utime last() const { return kept_.back().utime; }

 private:
  struct Kept {
    Utime utime{};
    Utime commands_from{};
    Vector6d nu;
    Eigen::Vector3d p_WB;
    double voltage{};
    Eigen::Quaterniond q_WB;
    std::uint32_t first_command{};
    std::uint16_t commands{};
    bool valid{}, has_position{}, grid_begins{};
  };
  model::Allocation allocation_;
  std::deque<Kept> kept_;
  std::deque<double> forces_, commands_;  // so many to a sample, to a command, as there are actuators
};

}  // namespace fathom::diagnosis
