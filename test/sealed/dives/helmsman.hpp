// Who drives a craft that steers by its flow: speed steps, zigzags, turning circles, sines on the rudder, steps of
// depth and saw-teeth, and a course home where the area ends.
#pragma once

#include "test/sealed/mechanisms/mechanism.hpp"

namespace fathom::sealed {

class Helmsman {
 public:
  Helmsman(const Craft& craft, const Site& site, double from, double to, Random& random);
  /// Told forces for time `t` (Drive), from what the instruments show (called every `dt`).
  [[nodiscard]] Eigen::VectorXd command(double t, double dt, const Eigen::Vector3d& position,
                                        const Eigen::Vector3d& euler, const Vector6& nu);

 private:
  enum class Style { kSpeedSteps, kZigzag, kCircle, kSine, kNoise };
  struct Segment {
    double from{}, to{};
    Style style{};
    double turn{};                    ///< rad, heading that is held at first, from that at the start
    double amplitude{};               ///< of full helm
    double angle{};                   ///< rad, of a zigzag
    double slow{}, fast{};            // Hz, of a sine
    std::vector<double> drive, helm;  // of full, held one after the other
    double hold{};                    // s
    std::vector<double> depth;        // of the box
    double depth_hold{};              // s
    double wobble{}, wobble_rate{};   // of full planes; rad/s
  };
  [[nodiscard]] Segment draw(double from, double to, Random& random) const;
  [[nodiscard]] double helm_for(const Segment& segment, double t, const Eigen::Vector3d& position, double heading,
                                double turning);
  [[nodiscard]] double planes_for(const Segment& segment, double t, double depth, double pitch, double pitching);
  [[nodiscard]] Eigen::VectorXd glide(double t, double dt, double depth);

  const Craft& craft_;
  Site site_;
  std::vector<Segment> segments_;
  const Segment* now_{};
  double course_{}, side_{1.0};
  bool homeward_{};
  double smooth_turning_{}, smooth_pitching_{};
  double sinks_{1.0}, engine_{}, battery_{};
};

}  // namespace fathom::sealed
