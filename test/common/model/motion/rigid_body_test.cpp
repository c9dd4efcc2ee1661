// A body whose centre of mass is not its origin, with products of inertia and a full added mass: what such a body
// keeps, and that a flight's inverse finds what the flight was made with.
#include <doctest/doctest.h>

#include <cmath>

#include "common/base/error.hpp"
#include "common/base/factors.hpp"
#include "common/model/derivative_motion.hpp"
#include "common/model/manoeuvres.hpp"
#include "common/model/sensors/kinematic_point.hpp"
#include "test/support/scratch.hpp"
#include "test/support/virtual_dive.hpp"

namespace fathom::model {
namespace {

constexpr int kSteps = 4000;
constexpr double kStep = 1e-3, kFor = kSteps * kStep;  // s
constexpr double kKept = 1e-8;  // of energies and momenta near 10: Runge-Kutta's error over that time

/// Weightless: buoyancy at the centre of mass.
Vehicle askew() {
  Vehicle vehicle{.name = "askew", .mass = 12.0, .inertia = {0.4, 0.7, 0.9}, .water_density = 1000.0};
  vehicle.dof.fill(true);
  vehicle.buoyancy = vehicle.mass * kGravity;
  vehicle.hydrodynamics = Hydrodynamics{.length = 1.0};
  vehicle.hydrodynamics->p_BG = vehicle.hydrodynamics->p_BB = {0.2, -0.05, 0.1};
  vehicle.hydrodynamics->products = {0.05, -0.08, 0.03};
  return vehicle;
}

struct Free {
  Eigen::Vector3d p_WB{Eigen::Vector3d::Zero()};
  Eigen::Quaterniond q_WB{Eigen::Quaterniond::Identity()};
  Vector6d nu{Vector6d::Zero()};
};

/// Nothing acts on it but itself.
void step(const Vehicle& vehicle, Free& body) {
  const InertiaFactor M{total_inertia(vehicle)};
  const auto slope = [&](const Vector6d& nu) {
    return M.solve(rigid_wrench(vehicle, Eigen::Vector3d::UnitZ(), nu));  // weightless: down does not matter
  };
  const Vector6d a = slope(body.nu), b = slope(body.nu + 0.5 * kStep * a), c = slope(body.nu + 0.5 * kStep * b),
                 d = slope(body.nu + kStep * c);
  const Vector6d middle = body.nu + 0.25 * kStep * (a + b);
  body.nu += kStep / 6.0 * (a + 2.0 * b + 2.0 * c + d);
  const Eigen::Quaterniond half =
      body.q_WB * quaternion_from_rotation_vector(0.5 * kStep * Eigen::Vector3d(middle.tail<3>()));
  body.p_WB += kStep * (half * Eigen::Vector3d(middle.head<3>()));
  body.q_WB = (body.q_WB * quaternion_from_rotation_vector(kStep * Eigen::Vector3d(middle.tail<3>()))).normalized();
}

std::string complaint(const std::string& lines) {
  const test::Scratch scratch;
  const std::string path = scratch.path("askew.yaml");
  test::write_bytes(path,
                    "name: Askew\nwater_density: 1000 kg/m^3\nmass: 8 kg\nbuoyancy: 78 N\n"
                    "inertia: 0.4 0.7 0.9 kg m^2\nhull: 0.6 0.3 0.3 m\ndof: [surge, sway, heave, roll, pitch, yaw]\n"
                    "hydrodynamics:\n  length: 1 m\n  added_mass: 4 8 8 kg\n  added_inertia: 0.1 0.3 0.3 kg m^2\n" +
                        lines);
  try {
    static_cast<void>(Vehicle::load(path));
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("rigid body: off its centre of mass it keeps its energy and both momenta, and that centre goes straight") {
  const Vehicle vehicle = askew();
  const Eigen::Vector3d p_BG = vehicle.hydrodynamics->p_BG;
  const Matrix6d M = rigid_inertia(vehicle);
  CHECK((M - M.transpose()).norm() < 1e-12);
  Free body;
  body.nu << 0.5, -0.3, 0.2, 0.4, -0.7, 0.9;
  const auto energy = [&] { return 0.5 * body.nu.dot(M * body.nu); };
  const auto linear = [&] { return Eigen::Vector3d(body.q_WB * Eigen::Vector3d((M * body.nu).head<3>())); };
  const auto centre = [&] { return Eigen::Vector3d(body.p_WB + body.q_WB * p_BG); };
  // About the origin of W.
  const auto angular = [&] {
    return Eigen::Vector3d(body.q_WB * Eigen::Vector3d((M * body.nu).tail<3>()) + body.p_WB.cross(linear()));
  };
  const double E = energy();
  const Eigen::Vector3d P = linear(), L = angular(), from = centre();
  for (int i = 0; i < kSteps; ++i) step(vehicle, body);
  CHECK(std::abs(energy() - E) < kKept);
  CHECK((linear() - P).norm() < 1e-5);  // the attitude goes on by midpoints
  CHECK((angular() - L).norm() < 1e-5);
  CHECK((centre() - from - kFor * P / vehicle.mass).norm() < 1e-5);
}

TEST_CASE(
    "rigid body: a flight with all of it stated leaves exactly what the derivatives gave, and more when it is not") {
  Vehicle vehicle = test::vehicle_from_repository("pap104_half");
  Hydrodynamics& h = *vehicle.hydrodynamics;
  h.p_BG = {0.02, 0.01, 0.03};
  h.products = {0.1, -0.2, 0.05};
  h.added_mass(1, 5) = h.added_mass(5, 1) = 1.5;   // -Y_rdot, kg m
  h.added_mass(2, 4) = h.added_mass(4, 2) = -1.0;  // -Z_qdot
  Vehicle unstated = vehicle;
  unstated.hydrodynamics->p_BG.setZero();
  double untold = 0.0;
  for (const FlightMoment& m : fly(vehicle, {.kind = ManoeuvreKind::kZigzag}, 1.0)) {
    const Vector6d tau = vehicle.allocation * Eigen::Map<const Eigen::Vector2d>(m.thrust.data());
    const Vector6d known = tau + m.umbilical + m.chain;
    const Vector6d by_terms = manoeuvring_wrench(h.coefficients, m.nu, h.lengths(vehicle.water_density));
    CHECK((hydrodynamic_wrench(vehicle, m.q_WB, m.nu, m.nu_dot, known) - by_terms).norm() < 1e-9);
    untold = std::max(untold, (hydrodynamic_wrench(unstated, m.q_WB, m.nu, m.nu_dot, known) - by_terms).norm());
  }
  CHECK(untold > 1.0);  // N, N m: the weight alone has a lever of centimetres
}

TEST_CASE("rigid body: couplings of the added mass by name, one side enough, and what no body has is refused") {
  CHECK(complaint("  added_mass_couplings: {Y_rdot: -0.3 kg m}\n  centre_of_mass: 0 0 0.02 m\n").empty());
  CHECK(complaint("  added_mass_couplings: {Y_rdot: -3 kg m}\n").find("the added mass is not positive") !=
        std::string::npos);
  CHECK(complaint("  added_mass_couplings: {Y_vdot: -3 kg}\n").find("no coupling of added mass") != std::string::npos);
  CHECK(complaint("  added_mass_couplings: {Y_rdot: -0.3 kg}\n").find("kg m") != std::string::npos);
  CHECK(complaint("  products_of_inertia: 1 0 0 kg m^2\n").find("about the centre of mass is not positive") !=
        std::string::npos);
  CHECK(complaint("  products_of_inertia: 0.05 0 0 kg m^2\n").empty());
}

}  // namespace fathom::model
