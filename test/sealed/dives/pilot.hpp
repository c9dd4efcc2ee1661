// Who drives: an excitation that is drawn anew for every file, and a soft hand that keeps the vehicle in its box.
#pragma once

#include "test/sealed/mechanisms/mechanism.hpp"

namespace fathom::sealed {

class Pilot {
 public:
  Pilot(const Craft& craft, const Site& site, double from, double to, Random& random);
  /// Thruster forces [N] for time `t`, from what the instruments show (called every `dt`).
  [[nodiscard]] Eigen::VectorXd command(double t, double dt, const Eigen::Vector3d& position,
                                        const Eigen::Vector3d& euler, const Vector6& nu);

 private:
  enum class Style { kSweep, kMultisine, kNoise, kStopAndGo };
  struct Tone {
    double amplitude, omega, phase;
  };
  struct Segment {
    double from{}, to{};
    Style style{};
    int axis{};
    double slow{}, fast{};                      // Hz, of a sweep
    std::array<std::vector<Tone>, 6> tones;     // of a multisine
    std::array<std::vector<double>, 6> levels;  // N, N m: held one after the other by stop-and-go, shaped by noise
    double hold{};                              // s, of a level
  };
  [[nodiscard]] Segment draw(double from, double to, Random& random) const;
  [[nodiscard]] Vector6 excitation(double t) const;
  [[nodiscard]] Vector6 keeping(double dt, const Eigen::Vector3d& position, const Eigen::Vector3d& euler,
                                const Vector6& nu);

  const Craft& craft_;
  Site site_;
  Vector6 strength_;  // N, N m, of the excitation
  Vector6 inertia_;
  Eigen::MatrixXd from_wrench_;
  Eigen::VectorXd limit_;
  std::vector<Segment> segments_;
  Vector6 smooth_nu_{Vector6::Zero()};
  Eigen::Vector3d smooth_offset_{Eigen::Vector3d::Zero()}, drift_{Eigen::Vector3d::Zero()};
};

}  // namespace fathom::sealed
