// The half-scale PAP-104 flown: what the paper's figures show of its circle, and forces that add up.
#include "common/model/manoeuvres.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "common/base/error.hpp"
#include "common/base/spatial.hpp"
#include "test/support/virtual_dive.hpp"

namespace fathom::model {
namespace {

constexpr double kEvery = 0.1;                       // s
constexpr double kSteady = 36.0, kSteadyEnd = 90.0;  // s

Eigen::Vector3d euler(const FlightMoment& m) { return euler_from_rotation(m.q_WB.toRotationMatrix()); }

}  // namespace

TEST_CASE("manoeuvres: a circle to port at half a metre per second, five metres wide, nose down, on its chain") {
  const auto flight = fly(test::vehicle_from_repository("pap104_half"), {.kind = ManoeuvreKind::kCircle}, kEvery);
  double deepest = 0.0, highest = 1e9, speed = 0.0, r = 0.0, v_dot = 0.0, inertial = 0.0, n = 0.0;
  for (const FlightMoment& m : flight) {
    if (m.t < 6.0) CHECK(m.nu.norm() < 5e-3);  // the rest that noises are measured in; it bobs
    if (m.t < kSteady || m.t > kSteadyEnd) continue;
    deepest = std::max(deepest, m.p_WB.z());
    highest = std::min(highest, m.p_WB.z());
    speed += std::hypot(m.nu[0], m.nu[1]);
    r += m.nu[5];
    v_dot += m.nu_dot[1];
    inertial += m.nu_dot[1] + m.nu[5] * m.nu[0] - m.nu[3] * m.nu[2];
    n += 1.0;
  }
  CHECK(deepest - highest < 0.1);  // m: the chain holds the height
  CHECK(flight.front().p_WB.x() == doctest::Approx(3.0));
  CHECK(flight.front().p_WB.y() == doctest::Approx(10.0));
  CHECK(speed / n == doctest::Approx(0.5).epsilon(0.1));
  CHECK(r < 0.0);  // port
  CHECK(speed / -r == doctest::Approx(5.0).epsilon(0.1));
  CHECK(euler(flight.back()).y() == doctest::Approx(-0.2).epsilon(0.1));
  // The paper compares -0.002 with -0.05 m/s^2: the one is the derivative in the body, the other inertial.
  CHECK(std::abs(v_dot / n) < 0.004);
  CHECK(inertial / n == doctest::Approx(-0.05).epsilon(0.1));
}

TEST_CASE("manoeuvres: V is a quarter of a turn ahead of U in a circle to port") {
  const auto flight = fly(test::vehicle_from_repository("pap104_half"), {.kind = ManoeuvreKind::kCircle}, kEvery);
  double peak_U = -1.0, peak_V = -1.0, at_U = 0.0, at_V = 0.0, turned = 0.0;
  for (const FlightMoment& m : flight) {
    if (m.t < kSteady || m.t > kSteady + 60.0) continue;
    const Eigen::Vector3d v_W = m.q_WB * m.nu.head<3>();
    if (v_W.x() > peak_U) peak_U = v_W.x(), at_U = m.t;
    if (v_W.y() > peak_V) peak_V = v_W.y(), at_V = m.t;
    turned = std::min(turned, m.nu[5]);
  }
  CHECK((at_U - at_V) * -turned == doctest::Approx(0.5 * 3.14159).epsilon(0.1));  // rad
}

TEST_CASE("manoeuvres: a line goes straight, and a zigzag turns back where it should") {
  const Vehicle vehicle = test::vehicle_from_repository("pap104_half");
  for (const FlightMoment& m : fly(vehicle, {.kind = ManoeuvreKind::kLine, .heading = 0.7}, kEvery)) {
    CHECK(std::abs(wrap_angle(euler(m).z() - 0.7)) < 1e-6);
  }
  double least = 0.0, most = 0.0;
  for (const FlightMoment& m : fly(vehicle, {.kind = ManoeuvreKind::kZigzag, .swing = 0.3}, kEvery)) {
    least = std::min(least, euler(m).z());
    most = std::max(most, euler(m).z());
  }
  CHECK(least < -0.3);
  CHECK(most > 0.3);
  CHECK(most - least < 0.8);
}

TEST_CASE("manoeuvres: what is known of a flight leaves what the derivatives gave") {
  const Vehicle vehicle = test::vehicle_from_repository("pap104_half");
  const Hydrodynamics& h = *vehicle.hydrodynamics;
  for (const FlightMoment& m : fly(vehicle, {.kind = ManoeuvreKind::kZigzag}, 1.0)) {
    const Vector6d tau = vehicle.allocation * Eigen::Map<const Eigen::Vector2d>(m.thrust.data());
    const Vector6d left = hydrodynamic_wrench(vehicle, m.q_WB, m.nu, m.nu_dot, tau + m.umbilical + m.chain);
    CHECK((left - manoeuvring_wrench(h.coefficients, m.nu, h.lengths(vehicle.water_density))).norm() < 1e-9);
  }
}

TEST_CASE("manoeuvres: an umbilical of twice the length drags twice, and the chain rubs") {
  Vehicle vehicle = test::vehicle_from_repository("pap104_half");
  const FlightMoment once = fly(vehicle, {.kind = ManoeuvreKind::kLine}, kEvery).back();
  vehicle.hydrodynamics->umbilical->paid_out *= 2.0;
  const FlightMoment twice = fly(vehicle, {.kind = ManoeuvreKind::kLine}, kEvery).back();
  const auto share = [](const FlightMoment& m) { return m.F_umbilical_B.x() / (m.nu[0] * m.nu[0]); };
  CHECK(share(twice) / share(once) == doctest::Approx(2.0).epsilon(0.03));
  CHECK(twice.nu[0] < once.nu[0]);
  CHECK(once.chain[0] < 0.0);  // it rubs
}

TEST_CASE("manoeuvres: a vehicle file without derivatives or with other thrusters is refused in one line") {
  CHECK_THROWS_WITH_AS(static_cast<void>(fly(test::vehicle_from_repository("beluga"), {}, kEvery)),
                       "Beluga: a manoeuvre needs mass, inertia, buoyancy and hydrodynamics in the vehicle file",
                       InputError);
  CHECK_THROWS_AS(static_cast<void>(manoeuvre_from("loop")), InputError);
}

}  // namespace fathom::model
