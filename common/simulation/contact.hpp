// The hull as a box that meets walls, floor and surface. Solid planes push its corners by a spring with damping that
// only resists (Hunt and Crossley 1975: F = k d (1 + b d_dot), never below zero) and a little friction, so that a
// bounce gives back less than it took. At the surface what emerges no longer displaces water, and making waves takes
// energy.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "common/base/spatial.hpp"
#include "common/model/site.hpp"
#include "common/simulation/boundaries.hpp"

namespace fathom::simulation {

/// Touches since the start. One that is taken up again within a quarter of a second counts once.
struct ContactCounts {
  int walls{}, floor{}, surface{};
};

class Hull {
 public:
  /// `size` [m]: length, width, height about Bo; `mass` [kg] sets how stiff contacts are; `weight` [N] what it
  /// displaces.
  Hull(const model::Site& site, const Eigen::Vector3d& size, double mass, double weight);

  /// Wrench at Bo in B of all contacts.
  [[nodiscard]] Vector6d wrench(const Eigen::Vector3d& p_WB, const Eigen::Matrix3d& R_WB, const Vector6d& nu) const;
  /// Energy held by the springs of the solid planes and by the emerged part [J].
  [[nodiscard]] double energy(const Eigen::Vector3d& p_WB, const Eigen::Matrix3d& R_WB) const;
  /// Counts what touches now; once per step.
  void count(const Eigen::Vector3d& p_WB, const Eigen::Matrix3d& R_WB, double t);
  [[nodiscard]] const ContactCounts& counts() const { return counts_; }

 private:
  void solids(const Eigen::Vector3d& p_WB, const Eigen::Matrix3d& R_WB, const Vector6d& nu, Vector6d& wrench) const;
  void surface(const Eigen::Vector3d& p_WB, const Eigen::Matrix3d& R_WB, const Vector6d& nu, Vector6d& wrench) const;

  double surface_;
  Eigen::Vector3d half_;
  double reach_;           ///< m, from Bo to a corner
  double stiffness_;       ///< N/m of one corner
  double column_weight_;   ///< N/m, displaced by one quarter of the hull per metre of height
  double column_damping_;  ///< N/(m/s) of one quarter
  std::vector<Plane> planes_;
  std::vector<double> last_touch_;  ///< s, per plane, then the surface
  ContactCounts counts_;
};

}  // namespace fathom::simulation
