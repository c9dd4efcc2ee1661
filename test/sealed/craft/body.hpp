// Fossen's equation of motion in mass-matrix form, integrated by the classical Runge-Kutta scheme.
#pragma once

#include "test/sealed/mechanisms/mechanism.hpp"

namespace fathom::sealed {

/// What a log's rows say of the time between them: straight lines, each force until the next row, or since the last.
enum class Hold { kLine, kAfter, kBefore };
constexpr std::array<const char*, 3> kHoldNames{"line", "held", "told afterwards"};

/// Forces asked of the thrusters at 100 Hz; held before the first and after the last.
struct Commands {
  double begin{}, dt{0.01};  ///< s
  Hold hold{Hold::kLine};
  std::vector<Eigen::VectorXd> force;
  void at(double t, Eigen::VectorXd& out) const;
};

/// Position and Euler angles, then nu, then the mechanisms' memory.
using State = Eigen::VectorXd;
constexpr Eigen::Index kPose = 0, kSpeed = 6, kMemory = 12;

class Body {
 public:
  Body(const Craft& craft, const Mechanisms& mechanisms);
  Hull hull;  ///< may be changed between steps

  [[nodiscard]] State at_rest(const Eigen::Vector3d& position, double heading) const;
  /// d state / dt; `t` in s.
  void rate(double t, const State& state, const Commands& commands, State& out);
  void step(double t, double h, const Commands& commands, State& state);
  /// Mechanical energy of rigid body and added mass in still water [J], and the potential of weight, buoyancy and
  /// first moment.
  [[nodiscard]] double energy(const State& state) const;

 private:
  const Craft& craft_;
  const Mechanisms& mechanisms_;
  Eigen::VectorXd acting_;
  Eigen::Matrix<double, 6, Eigen::Dynamic> allocation_;
  double delay_{};
  Eigen::VectorXd own_delay_, late_;  // of single jets, beside the others; their forces
  std::vector<int> place_;            // of each mechanism's memory
  int memory_{};
  Eigen::VectorXd force_;
  State k1_, k2_, k3_, k4_, trial_;
};

/// Body to world, z-y-x (Fossen 2011, eq. 2.18).
[[nodiscard]] Eigen::Matrix3d turn_of(const Eigen::Vector3d& euler);

}  // namespace fathom::sealed
