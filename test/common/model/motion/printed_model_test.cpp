// The printing errors of Karras et al. in the matrices of inertia and Coriolis forces, each as an example: of a flow
// that is known the printed form says the wrong thing, and what Fathom computes is right. Those of the rows (1.5) stand
// in regressor_test.cpp, those of the thrusters (1.6, 1.7) in vehicle_test.cpp.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "common/model/derivative_motion.hpp"
#include "common/model/dynamics.hpp"
#include "common/model/sensors/kinematic_point.hpp"
#include "test/support/virtual_dive.hpp"

namespace fathom::model {
namespace {

using Eigen::Vector3d;

constexpr double kDensity = 1000.0;  // kg/m^3
constexpr double kExact = 1e-9;      // N, N m, J: sums of products near 100
constexpr double kStep = 1e-5;       // s, of differences in time
constexpr double kSmall = 1e-6;      // N, N m: what they leave

/// Neutrally buoyant, without drag. `derivatives`: Fossen's X_udot ... N_rdot.
Vehicle neutral(double mass, const Vector3d& inertia, const Vector6d& derivatives) {
  Vehicle vehicle{.name = "ideal", .mass = mass, .inertia = inertia, .water_density = kDensity};
  vehicle.dof.fill(true);
  vehicle.buoyancy = mass * kGravity;
  vehicle.hydrodynamics = Hydrodynamics{.length = 1.0, .added_mass = (-derivatives).asDiagonal()};
  return vehicle;
}

Motion at_rest(const Vehicle& vehicle) {
  Motion motion;
  motion.force = ActuatorForces::Zero(6);
  motion.vehicle = &vehicle;
  return motion;
}

Model with(const Vehicle& vehicle, const BaseTheta& theta) {
  Model model = nominal_model(vehicle, true);
  model.theta = theta;
  return model;
}

double draw(std::mt19937& random) { return std::uniform_real_distribution<double>{-1.0, 1.0}(random); }

/// Moment about down that a body needs which moves with v without turning and carries the water's momentum A v along:
/// that by which the momentum's moment about a fixed point grows.
double moment_of_momentum(const Vector3d& added, const Vector3d& v) {
  const auto about_origin = [&](double t) { return Vector3d{(t * v).cross(added.cwiseProduct(v))}; };
  return ((about_origin(kStep) - about_origin(-kStep)) / (2.0 * kStep)).z();
}

/// C_A(nu) nu as the paper has it, of its alpha_1 to alpha_3 and of three b's.
Vector6d paper_coriolis(const Vector3d& alpha, const Vector3d& b, const Vector6d& nu) {
  Matrix6d C = Matrix6d::Zero();
  C.topRightCorner<3, 3>() = C.bottomLeftCorner<3, 3>() = skew(alpha);
  C.bottomRightCorner<3, 3>() = skew(b);
  return C * nu;
}

}  // namespace

// M_A = -[X_udot ...] is Fossen's, and the paper defines X_udot like him: of the water's force, so that it is negative.
// Then (1.9)'s m + X_udot is not M's first entry.
TEST_CASE("printed 1.9: with m + X_udot a sphere is lighter in water than in vacuum, and its work is not conserved") {
  const double radius = 0.15;
  const double displaced = 4.0 / 3.0 * std::numbers::pi * kDensity * std::pow(radius, 3);
  const double X_udot = -0.5 * displaced;  // Lamb: half the water that a sphere displaces moves with it
  const Vector6d derivatives = (Vector6d{} << X_udot, X_udot, X_udot, 0.0, 0.0, 0.0).finished();
  const Vehicle sphere = neutral(displaced, Vector3d::Constant(0.4 * displaced * radius * radius), derivatives);
  // A second of 10 N: the work must be the energy of sphere and water.
  const double thrust = 10.0, time = 1.0;
  const auto surplus = [&](double u_dot) {
    const double u = u_dot * time, work = thrust * 0.5 * u * time;
    return work - (0.5 * displaced * u * u + 0.5 * 0.5 * displaced * u * u);
  };
  CHECK(surplus(thrust / (displaced + X_udot)) < -5.0);  // J
  Motion motion = at_rest(sphere);
  motion.force[0] = thrust;
  CHECK(std::abs(surplus(derivative_acceleration(nominal_model(sphere, true), motion, {})[0])) < kExact);
  CHECK(std::abs(surplus(acceleration(with(sphere, nearest_base(sphere)), motion)[0])) < kExact);
}

TEST_CASE("printed 1.5: with m + Y_vdot a slender hull turns into the stream; it turns broadside") {
  // Lamb's spheroid, four times as long as thick: .082 and .860 of the displaced water ahead and across.
  const double displaced = 4.0 / 3.0 * std::numbers::pi * kDensity * 0.6 * 0.15 * 0.15;
  const Vector6d derivatives = displaced * (Vector6d{} << -0.082, -0.860, -0.860, 0.0, -0.05, -0.05).finished();
  const Vehicle spheroid = neutral(displaced, displaced * Vector3d{0.009, 0.0765, 0.0765}, derivatives);
  const Vector3d v{0.5, 0.3, 0.0};  // through the water: ahead, and slipping to starboard
  const double truth = -moment_of_momentum(-derivatives.head<3>(), v);
  CHECK(truth < -1.0);  // to port, away from where it goes: broadside
  const auto moment = [&](const BaseTheta& theta, const Vector3d& through, const Vector3d& stream) {
    Motion motion = at_rest(spheroid);
    motion.nu.head<3>() = through;
    motion.v_WF_B = stream;
    Load load;
    return generalised_force(with(spheroid, theta), motion, load)[5];
  };
  BaseTheta printed = nearest_base(spheroid);
  printed.head<3>() = Vector3d::Constant(displaced) + derivatives.head<3>();
  for (const bool held : {false, true}) {  // under way in still water; held in a stream
    const Vector3d own = held ? Vector3d::Zero() : v;
    CHECK(moment(printed, own, own - v) == doctest::Approx(-truth));
    CHECK(moment(nearest_base(spheroid), own, own - v) == doctest::Approx(truth));
  }
}

TEST_CASE("printed C_A: with b_2 twice and no b_3 the water's momentum does not change as the forces say") {
  std::mt19937 random{5};
  Vehicle vehicle = neutral(10.0, Vector3d::Ones(), Vector6d::Zero());
  Scene scene{.vehicle = &vehicle, .position = true, .attitude = true, .velocity = true, .rates = true};
  scene.nu_rms.setOnes();
  scene.tau_rms.setOnes();
  const std::vector<std::string> forms = find_effect("cross_coupling")->variants(scene);
  double printed_error[2]{};
  for (int trial = 0; trial < 10; ++trial) {
    // Any water: the added mass of a hull without symmetry, in Fathom a diagonal and the effect cross_coupling.
    const Matrix6d root = Matrix6d::NullaryExpr([&] { return draw(random); });
    const Matrix6d A = root * root.transpose() + Matrix6d::Identity();
    BaseTheta theta = BaseTheta::Zero();
    theta.head<6>() = A.diagonal();
    Model model = with(vehicle, theta);
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t j = i + 1; j < 6; ++j) {
        const auto form = std::ranges::find(forms, std::string{kAxisNames[i]} + "_" + kVelocityNames[j] + "_dot");
        REQUIRE(form != forms.end());
        const double coupling = A(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
        model.add(test::active("cross_coupling", {coupling}, static_cast<int>(form - forms.begin())));
      }
    }
    Motion motion = at_rest(vehicle);
    motion.nu = Vector6d::NullaryExpr([&] { return draw(random); });
    const Vector6d nu_dot = Vector6d::NullaryExpr([&] { return draw(random); });
    // Kirchhoff: momentum and its moment about a fixed point, in axes at rest, at a time t of a motion of constant
    // nu_dot that begins along them.
    const auto momentum = [&](double t) {
      const Vector6d nu = motion.nu + t * nu_dot, carried = A * nu;
      const Vector3d turn = t * motion.nu.tail<3>() + 0.5 * t * t * nu_dot.tail<3>();
      const Eigen::Matrix3d R = quaternion_from_rotation_vector(turn).toRotationMatrix();
      const Vector3d P = R * carried.head<3>(), p = t * motion.nu.head<3>();
      return Vector6d{(Vector6d{} << P, R * carried.tail<3>() + p.cross(P)).finished()};
    };
    const Vector6d truth = (momentum(kStep) - momentum(-kStep)) / (2.0 * kStep);
    CHECK((residual_wrench(model, motion, nu_dot) - truth).norm() < kSmall);

    const Vector6d sums = -A * motion.nu;  // alpha and b: the paper's derivatives are A's entries, negative
    const Vector3d alpha = sums.head<3>(), b = sums.tail<3>();
    const auto error = [&](const Vector3d& as_read) {
      return (A * nu_dot + paper_coriolis(alpha, as_read, motion.nu) - truth).norm();
    };
    CHECK(error(b) < kSmall);  // nothing else is wrong with it
    printed_error[0] = std::max(printed_error[0], error({b[0], b[1], b[1]}));
    printed_error[1] = std::max(printed_error[1], error({b[0], b[2], 0.0}));  // the last line counts
  }
  CHECK(printed_error[0] > 1.0);  // N m
  CHECK(printed_error[1] > 1.0);
}

}  // namespace fathom::model
