// The fence: far inside it does nothing, near a wall it bends, and whatever is asked for, nothing is touched.
#include "common/excitation/fence.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "test/common/excitation/tank_run.hpp"

namespace fathom::excitation {
namespace {

FenceSettings tank() {
  FenceSettings f;
  f.low = {-2.0, -1.0, 0.3};
  f.high = {2.0, 1.0, 1.2};
  return f;
}

Vector6d largest() { return (Vector6d{} << 12.0, 12.0, 10.0, 0.0, 0.0, 1.2).finished(); }

StateEstimate at(const Eigen::Vector3d& p, const Eigen::Vector3d& v = Eigen::Vector3d::Zero(), double heading = 0.0) {
  StateEstimate state{.p_WB = p, .q_WB = Eigen::Quaterniond{rotation_from_euler({0.0, 0.0, heading})}, .valid = true};
  state.nu.head<3>() = state.q_WB.conjugate() * v;
  return state;
}

}  // namespace

TEST_CASE("fence: far inside nothing is altered") {
  const Fence fence{tank()};
  Vector6d tau;
  tau << 12.0, -12.0, 10.0, 0.0, 0.0, 1.2;
  const auto bent = fence.bend(tau, at({0.0, 0.0, 0.75}), 0.0, 11.0, 0.2, largest());
  CHECK(bent.tau == tau);
  CHECK_FALSE(bent.bent);
  for (const bool turn : bent.turn) CHECK_FALSE(turn);
}

TEST_CASE(
    "fence: near a wall the push toward it ends and the axis turns, along the wall it stays, whatever the heading") {
  const Fence fence{tank()};
  for (const double heading : {0.0, 0.5 * std::numbers::pi, std::numbers::pi}) {
    const StateEstimate state = at({1.98, 0.0, 0.75}, {0.3, 0.0, 0.0}, heading);
    const Eigen::Matrix3d R = state.q_WB.toRotationMatrix();
    Vector6d tau = Vector6d::Zero();
    tau.head<3>() = R.transpose() * Eigen::Vector3d{8.0, 3.0, 0.0};
    const auto bent = fence.bend(tau, state, 0.0, 11.0, 0.2, largest());
    const Eigen::Vector3d force = R * bent.tau.head<3>();
    CHECK(bent.bent);
    CHECK(force.x() < 0.0);
    CHECK(force.y() == doctest::Approx(3.0));
    const std::size_t axis = std::abs(R(0, 0)) > 0.5 ? 0 : 1;  // which of surge and sway leads outwards
    CHECK(bent.turn[axis]);
    CHECK_FALSE(bent.turn[1 - axis]);
    CHECK_FALSE(bent.turn[2]);
  }
}

TEST_CASE("fence: a tilted hull reaches farther up, and is kept farther from the surface") {
  FenceSettings settings = tank();
  const Eigen::Vector3d p{0.0, 0.0, 0.62};  // 7 cm inside the band of a level hull
  StateEstimate state = at(p);
  state.q_WB = Eigen::Quaterniond{rotation_from_euler({0.0, 0.35, 0.0})};
  const Eigen::Vector3d up_B = state.q_WB.conjugate() * Eigen::Vector3d{0.0, 0.0, -5.0};
  Vector6d tau = Vector6d::Zero();
  tau.head<3>() = up_B;
  const auto up = [&](const Fence& fence) {
    return -(state.q_WB * fence.bend(tau, state, 0.0, 11.0, 0.2, largest()).tau.head<3>()).z();
  };
  const double level = up(Fence{settings});
  settings.half_length = 0.25;  // its bow is 8.6 cm above where a level one's is
  CHECK(up(Fence{settings}) < level - 0.2);
  // Level, nothing changes.
  const StateEstimate upright = at(p);
  CHECK(Fence{settings}.bend(tau, upright, 0.0, 11.0, 0.2, largest()).tau ==
        Fence{tank()}.bend(tau, upright, 0.0, 11.0, 0.2, largest()).tau);
}

TEST_CASE("supervisor settings: a heavier vehicle brakes as its thrust allows, and P* grows with its mass squared") {
  const std::string root = FATHOM_SOURCE_DIR;
  const model::Site site = model::Site::load(root + "/config/sites/tank.yaml");
  const Config pipeline = Config::load(root + "/config/pipelines/tank.yaml");
  const auto of = [&](const std::string& name) {
    return SupervisorSettings::from(pipeline.section("supervisor"), test::vehicle_from_repository(name), site);
  };
  const SupervisorSettings paper = of("seabotix_lbv150"), heavy = of("bluerov2");
  CHECK(paper.fence.braking == doctest::Approx(0.85 * 10.0 / 10.898));  // just below the 0.8 that is stated
  CHECK(heavy.fence.braking == doctest::Approx(0.85 * 10.0 / 26.1));
  REQUIRE(paper.schedule.size() == 5);
  const std::array printed{0.08, 0.25, 0.25, 0.5, 0.3};  // yaw, surge, sway, heave, total
  for (std::size_t i = 0; i < 5; ++i) CHECK(paper.schedule[i].threshold == doctest::Approx(printed[i]));
  const double X = 17.0 / 9.7532, Y = 24.2 / 8.6636, Z = 26.1 / 10.898;
  CHECK(heavy.schedule[0].threshold == doctest::Approx(0.08));
  CHECK(heavy.schedule[1].threshold == doctest::Approx(0.25 * X * X));
  CHECK(heavy.schedule[3].threshold == doctest::Approx(0.5 * Z * Z));
  CHECK(heavy.schedule[4].threshold ==
        doctest::Approx(0.3 * (0.08 + 0.25 * X * X + 0.25 * Y * Y + 0.5 * Z * Z) / 1.08));
}

TEST_CASE("fence: the tether is not wound up beyond its turns") {
  const Fence fence{tank()};
  StateEstimate state = at({0.0, 0.0, 0.75});
  state.nu[5] = 0.4;
  Vector6d tau = Vector6d::Zero();
  tau[5] = 1.0;
  const double limit = 2.0 * std::numbers::pi * tank().turns;
  CHECK(fence.bend(tau, state, 0.0, 11.0, 0.2, largest()).tau[5] == 1.0);
  const auto bent = fence.bend(tau, state, limit - 0.05, 11.0, 0.2, largest());
  CHECK(bent.tau[5] < 0.0);
  CHECK(bent.turn[5]);
  CHECK(fence.bend(-tau, state, limit - 0.05, 11.0, 0.2, largest()).tau[5] <= -1.0);  // back is free
}

TEST_CASE("fence: a hull that tilts is pushed sideways no more, and its rolling and pitching is braked") {
  const Fence fence{tank()};
  const double limit = tank().largest_tilt;
  Vector6d tau, limits;
  tau << 5.0, -5.0, 3.0, 0.3, 0.3, 0.5;
  limits << 12.0, 12.0, 10.0, 0.5, 0.5, 1.2;
  const auto bend = [&](double roll, double rate) {
    StateEstimate state = at({0.0, 0.0, 0.75});
    state.q_WB = Eigen::Quaterniond{rotation_from_euler({roll, 0.0, 0.0})};
    state.nu[3] = rate;
    return fence.bend(tau, state, 0.0, 11.0, 0.2, limits);
  };
  CHECK((bend(0.3 * limit, 0.0).tau - tau).norm() < 1e-12);  // rounding of the rotations
  CHECK(bend(0.3 * limit, -2.0).bent == false);              // on its way back
  CHECK(bend(0.3 * limit, 1.0).bent);                        // on its way out
  const auto far = bend(limit, 0.5);
  for (const int axis : {0, 1, 4, 5}) CHECK(std::abs(far.tau[axis]) < 1e-12);
  CHECK(far.tau[2] == doctest::Approx(3.0));
  CHECK(far.tau[3] == doctest::Approx(-0.2 / 0.4 * 0.5));  // inertia times rate, taken away in 0.4 s
  CHECK(bend(limit, 3.0).tau[3] == -0.5);                  // what the axis may have at most
}

TEST_CASE("fence: outside of the envelope it says why") {
  const Fence fence{tank()};
  CHECK(fence.outside(at({0.0, 0.0, 0.75}), 0.0).empty());
  CHECK(fence.outside(at({2.2, 0.0, 0.75}), 0.0) == "too far north");
  CHECK(fence.outside(at({0.0, -1.2, 0.75}), 0.0) == "too far west");
  CHECK(fence.outside(at({0.0, 0.0, 0.1}), 0.0) == "too far up");
  CHECK(fence.outside(at({0.0, 0.0, 0.75}, {2.0, 0.0, 0.0}), 0.0) == "too fast");
  CHECK(fence.outside(at({0.0, 0.0, 0.75}), 100.0) == "the tether is wound up");
  StateEstimate tilted = at({0.0, 0.0, 0.75});
  tilted.q_WB = Eigen::Quaterniond{rotation_from_euler({1.2, 0.0, 0.0})};
  CHECK(fence.outside(tilted, 0.0) == "tilted too far");
}

TEST_CASE("fence: who begins afloat is outside only when lifted, until he has been below the upper bound") {
  FenceSettings settings = tank();
  const auto outside = [](const Fence& fence, double z) { return fence.outside(at({0.0, 0.0, z}), 0.0); };
  Fence none{settings};
  none.begin({0.0, 0.0, 0.1}, true);
  CHECK(outside(none, 0.1) == "too far up");  // no water's surface is known
  settings.waterline = 0.0;
  Fence fence{settings};
  fence.begin({0.0, 0.0, 0.05}, true);
  CHECK(fence.afloat());
  CHECK(outside(fence, 0.05).empty());
  CHECK(outside(fence, -0.04).empty());
  CHECK(outside(fence, -0.06) == "too far up");
  CHECK(fence.outside(at({2.2, 0.0, 0.05}), 0.0) == "too far north");
  fence.follow({0.0, 0.0, 0.29});
  CHECK(fence.afloat());
  fence.follow({0.0, 0.0, 0.31});
  fence.follow({0.0, 0.0, 0.1});
  CHECK_FALSE(fence.afloat());
  CHECK(outside(fence, 0.1) == "too far up");
  Fence carried{settings};
  carried.begin({0.0, 0.0, -0.2}, true);
  CHECK(outside(carried, -0.2) == "too far up");
  Fence boat{settings};
  boat.begin({0.0, 0.0, 0.05}, false);
  CHECK_FALSE(boat.afloat());
  CHECK_FALSE(boat.bend(largest(), at({0.0, 0.0, 0.05}), 0.0, 11.0, 0.2, largest()).bent);
  CHECK(outside(boat, -0.6) == "too far up");
}

TEST_CASE("fence: where the vehicle is, is told with the water above it and the room to the nearest bound") {
  FenceSettings settings;
  settings.low = {-2.0, -1.0, 0.3};
  settings.high = {2.0, 1.0, 1.2};
  constexpr double kSurface = 0.15;  // m, z of Bo with the hull's top at the surface
  CHECK(Fence{settings}.place(at({1.5, -0.9, 0.75}), kSurface) ==
        "at 1.50 m north, -0.90 m east, the hull's top 0.60 m below the surface, 0.10 m from the bound: west");
  CHECK(Fence{settings}.place(at({2.5, 0.0, 0.1}), kSurface) ==
        "at 2.50 m north, 0.00 m east, the hull's top 0.05 m above the surface, 0.50 m beyond the bound: north");
  settings.low.setConstant(-std::numeric_limits<double>::infinity());
  settings.high.setConstant(std::numeric_limits<double>::infinity());
  CHECK(Fence{settings}.place(at({0.0, 0.0, 5.15}), kSurface) ==
        "at 0.00 m north, 0.00 m east, the hull's top 5.00 m below the surface");
}

TEST_CASE("fence: the largest thrust held against every side, in every heading, touches nothing") {
  const auto settings = test::tank_settings();
  const Fence fence{settings.supervisor.fence};
  for (int direction = 0; direction < 16; ++direction) {
    test::TankPlant plant{settings.vehicle, {}};
    plant.place({0.0, 0.0, 0.75});
    const double angle = direction * std::numbers::pi / 8.0;
    const Eigen::Vector3d push{std::cos(angle), std::sin(angle), direction % 3 - 1.0};
    double turned = 0.0, least = 1e9;
    for (int k = 0; k < 3000; ++k) {
      const StateEstimate state = plant.state();
      Vector6d tau = Vector6d::Zero();
      tau.head<3>() = state.q_WB.conjugate() * Eigen::Vector3d{12.0 * push};
      tau[5] = direction % 2 == 0 ? 0.4 : 0.0;
      turned += 0.01 * plant.nu()[5];
      if (k % 5 == 0) {
        const auto bent = fence.bend(tau, state, turned, settings.supervisor.hold.mass,
                                     settings.supervisor.hold.inertia, settings.supervisor.largest);
        plant.command({.utime = plant.utime(), .tau = bent.tau, .life = 0.3});
      }
      plant.step();
      least = std::min(least, plant.room(settings.site));
    }
    CAPTURE(direction);
    CHECK(least > 0.02);  // m
  }
}

}  // namespace fathom::excitation
