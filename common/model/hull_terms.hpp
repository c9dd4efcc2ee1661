// What the hull feels in still water, whatever its actuators do, term by term: for who asks what many forces would do
// to one motion.
#pragma once

#include "common/model/dynamics.hpp"

namespace fathom::model {

struct HullTerms {
  HullTerms(const Model& model, const Motion& motion);
  Vector6d coriolis, drag, restoring;  ///< N, N m; the first belongs to the left-hand side
};

[[nodiscard]] inline bool water_moves(const Motion& motion) {
  return !motion.v_WF_B.isZero(0.0) || !motion.a_WF_B.isZero(0.0);
}

/// generalised_force() to the last bit, where the water stands still and `motion` differs from that of `hull` in its
/// actuators' forces and in what effects remember alone.
[[nodiscard]] Vector6d generalised_force(const Model& model, const Motion& motion, const HullTerms& hull, Load& load);

}  // namespace fathom::model
