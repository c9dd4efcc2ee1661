// What an effect adds along a measured motion, and how it changes with its numbers and with the base parameters.
#include "common/model/effect_wrench.hpp"

#include <doctest/doctest.h>

#include <array>

#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::model;

namespace {

constexpr double kRounding = 1e-9;
constexpr int kDrag = 1, kExponentialDrag = 3;
constexpr std::array kAsked{BaseParameter::X_u, BaseParameter::Y_vv, BaseParameter::Z_w, BaseParameter::N_r,
                            BaseParameter::m_X};

struct Case {
  Vehicle vehicle = test::vehicle_from_repository("beluga");
  Model base = nominal_model(vehicle, false);
  Motion motion;

  Case() {
    motion.p_WB = {0.5, -0.2, 1.5};
    motion.nu << 0.3, -0.2, 0.1, 0.2, -0.1, 0.4;
    motion.force = ActuatorForces::Zero(base.allocation.cols());
    motion.vehicle = &vehicle;
  }
  [[nodiscard]] EffectColumns columns(const Model& of, const ActiveEffect& effect) const {
    EffectWrench wrench{of, effect, kAsked};
    EffectColumns added = EffectColumns::Zero(6, wrench.columns()), momentum = added;
    wrench.step(motion, motion.force, 0.02, added, momentum);
    return added;
  }
};

}  // namespace

TEST_CASE("effect wrench: what multiplies the hull's drag moves with the numbers of the drag, and with no others") {
  const Case c;
  for (const auto& [effect, numbers] :
       {std::pair{test::active("bottom_effect", {0.8, 2.0}, kDrag), 4},
        std::pair{test::active("wall_effect", {1.2, 0.3, 0.0, 0.4, 0.7}, kExponentialDrag), 5}}) {
    CAPTURE(effect.effect->name());
    const EffectColumns at = c.columns(c.base, effect);
    REQUIRE(at.cols() == 1 + numbers + static_cast<Eigen::Index>(kAsked.size()));
    CHECK(at.col(0).head<3>().norm() > 0.1);
    for (std::size_t i = 0; i < kAsked.size(); ++i) {
      Model moved = c.base;
      moved.theta[index(kAsked[i])] += 0.5;
      const Vector6d change = c.columns(moved, effect).col(0) - at.col(0);
      const Vector6d column = at.col(1 + numbers + static_cast<Eigen::Index>(i));
      CHECK((change - 0.5 * column).norm() < kRounding);
      const bool of_forces = i < 3;
      CHECK((column.norm() > 1e-3) == of_forces);
    }
  }
}

TEST_CASE("effect wrench: a push asks no base parameter") {
  const Case c;
  EffectWrench push{c.base, test::active("bottom_effect", {8.0, 2.0}), kAsked};
  CHECK_FALSE(push.felt());
  CHECK(push.columns() == 1 + 4);
}
