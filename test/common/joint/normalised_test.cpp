// The normalised model against the room `model`, and its derivatives against differences.
#include "common/joint/normalised.hpp"

#include <doctest/doctest.h>

#include "common/base/error.hpp"
#include "common/base/spatial.hpp"
#include "test/common/joint/joint_vehicle.hpp"

using namespace fathom;
using namespace fathom::joint;

namespace {

const Vector6d kNu = (Vector6d{} << 0.3, -0.2, 0.15, 0.1, -0.15, 0.4).finished();
const Vector6d kTau = (Vector6d{} << 8.0, -5.0, 3.0, 0.2, 0.1, 0.7).finished();
const Eigen::Matrix3d kR = rotation_from_euler({0.2, -0.15, 0.7});

}  // namespace

TEST_CASE("normalised: the accelerations are those of the dynamics, and numbers come back as they went") {
  for (const char* name : {"seabotix_lbv150", "bluerov2", "beluga"}) {
    CAPTURE(name);
    const model::Vehicle vehicle = fathom::test::vehicle_from_repository(name);
    const Normalised model = example::moving(vehicle);
    const ParameterVector theta = example::numbers(vehicle), phi = example::normalised(model, theta);
    CHECK((model.physical(phi) - theta).norm() < 1e-12 * theta.norm());
    model::Model forward = model::nominal_model(vehicle, true);
    model::Motion motion{.R_WB = kR, .nu = kNu, .force = kTau, .vehicle = &vehicle};
    const Vector6d expected = model::acceleration(forward, motion);
    CHECK((model.acceleration(phi, kNu, kR, kTau) - expected).norm() < 1e-9 * expected.norm());
  }
}

TEST_CASE("normalised: derivatives by attitude, motion and parameters are those of differences") {
  for (const char* name : {"seabotix_lbv150", "bluerov2", "beluga"}) {
    CAPTURE(name);
    const model::Vehicle vehicle = fathom::test::vehicle_from_repository(name);
    const Normalised model = example::moving(vehicle);
    const ParameterVector phi = example::normalised(model, example::numbers(vehicle));
    AccelerationSlope slope;
    (void)model.acceleration(phi, kNu, kR, kTau, &slope);
    constexpr double kStep = 1e-6;
    for (Eigen::Index i = 0; i < 9; ++i) {
      const auto at = [&](double by) {
        Eigen::Vector3d e = Eigen::Vector3d::Zero();
        Vector6d nu = kNu;
        (i < 3 ? e[i] : nu[i - 3]) += by;
        return model.acceleration(phi, nu, kR * quaternion_from_rotation_vector(e).toRotationMatrix(), kTau);
      };
      const Vector6d differences = (at(kStep) - at(-kStep)) / (2.0 * kStep);
      CHECK((slope.by_motion.col(i) - differences).norm() < 1e-6 * (1.0 + differences.norm()));
    }
    for (Eigen::Index k = 0; k < phi.size(); ++k) {
      CAPTURE(vehicle.parameters[static_cast<std::size_t>(k)]);
      const double step = 1e-5 * (std::abs(phi(k)) + 1e-3);
      const auto at = [&](double by) {
        ParameterVector moved = phi;
        moved(k) += by;
        return Vector6d{model.acceleration(moved, kNu, kR, kTau)};
      };
      const Vector6d differences = (at(step) - at(-step)) / (2.0 * step);
      CHECK((slope.by_parameters.col(k) - differences).norm() < 1e-6 * (1.0 + differences.norm()));
    }
    const ParameterMatrix back = model.physical_slope(phi);
    for (Eigen::Index k = 0; k < phi.size(); ++k) {
      const double step = 1e-5 * (std::abs(phi(k)) + 1e-3);
      ParameterVector above = phi, below = phi;
      above(k) += step;
      below(k) -= step;
      const ParameterVector differences = (model.physical(above) - model.physical(below)) / (2.0 * step);
      CHECK((back.col(k) - differences).norm() < 1e-5 * (1.0 + differences.norm()));
    }
  }
}

TEST_CASE("normalised: an axis without inertia among the parameters is refused with a remedy") {
  model::Vehicle vehicle = fathom::test::vehicle_from_repository("seabotix_lbv150");
  std::vector<model::BaseParameter> columns = example::columns(vehicle);
  columns.erase(columns.begin());
  CHECK_THROWS_WITH_AS((Normalised{vehicle, columns, ParameterVector::Ones(12)}),
                       doctest::Contains("needs m_X among the parameters"), InputError);
}
