// Input design: the information it counts, what it chooses, and that it stays inside.
#include "common/excitation/design.hpp"

#include <doctest/doctest.h>

#include <Eigen/Cholesky>

#include "test/common/excitation/tank_run.hpp"

namespace fathom::excitation {

TEST_CASE("information: one row by hand") {
  const auto vehicle = test::vehicle_from_repository("seabotix_lbv150");
  Information information{vehicle, Vector6d::Constant(0.5)};
  Vector6d nu = Vector6d::Zero(), nu_dot = Vector6d::Zero();
  nu[0] = 0.3;
  nu_dot[0] = 0.2;
  information.add(nu_dot, nu, Eigen::Matrix3d::Identity(), 2.0);
  const auto column = [&](const char* name) {
    const auto& all = vehicle.parameters;
    return static_cast<Eigen::Index>(std::find(all.begin(), all.end(), name) - all.begin());
  };
  const Eigen::MatrixXd& M = information.matrix();
  CHECK(M(column("m_X"), column("m_X")) == doctest::Approx(2.0 * 0.2 * 0.2 / 0.25));
  CHECK(M(column("m_X"), column("X_u")) == doctest::Approx(2.0 * 0.2 * -0.3 / 0.25));
  CHECK(M(column("X_u|u|"), column("X_u|u|")) == doctest::Approx(2.0 * 0.09 * 0.09 / 0.25));
  CHECK(M(column("W-B"), column("W-B")) == doctest::Approx(2.0 / 0.25));
  CHECK(M(column("Y_v"), column("Y_v")) == 0.0);
}

TEST_CASE("design: it excites what is not known yet") {
  auto settings = test::tank_settings(true);
  const auto& vehicle = settings.vehicle;
  const Fence fence{settings.supervisor.fence};
  const StateEstimate state{.p_WB = {0.0, 0.0, 0.75}, .valid = true};
  const auto n = vehicle.parameters.size();
  for (const std::size_t axis : {0U, 2U, 5U}) {
    ModelEstimate model;
    model.covariance.assign(n * n, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
      const double size = std::abs(vehicle.priors[i].mean);
      model.parameters.push_back({vehicle.parameters[i], vehicle.priors[i].mean, 0.0, ""});
      const auto own = static_cast<std::size_t>(model::axis(*model::parameter_from_name(vehicle.parameters[i])));
      const double sigma = (own == axis ? 1.0 : 1e-3) * size;
      model.covariance[i * n + i] = sigma * sigma;
    }
    double asked = 0.0, samples = 0.0;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      Designer designer{settings.supervisor.design, vehicle, settings.supervisor.largest, seed};
      const Segment segment = designer.next(state, 0.0, model, fence, Eigen::Vector3d::Zero());
      CHECK(designer.gain() > 0.0);
      for (double t = 0.0; t < segment.duration; t += 0.05) {
        const Vector6d share = segment.at(t);
        CHECK(share.cwiseAbs().maxCoeff() <= 1.0);
        asked += std::abs(share[static_cast<Eigen::Index>(axis)]);
        samples += 1.0;
      }
    }
    CAPTURE(axis);
    CHECK(asked / samples > 0.5);  // a draw at random asks for a third
  }
}

TEST_CASE("design: in a corner, moving toward it, it still finds something or holds") {
  auto settings = test::tank_settings(true);
  const Fence fence{settings.supervisor.fence};
  Designer designer{settings.supervisor.design, settings.vehicle, settings.supervisor.largest, 1};
  StateEstimate state{.p_WB = settings.supervisor.fence.high, .valid = true};
  state.nu[0] = 0.5;
  const Segment segment = designer.next(state, 0.0, ModelEstimate{}, fence, Eigen::Vector3d::Zero());
  CHECK(segment.duration > 0.0);
}

TEST_CASE("design: one seed, one choice") {
  auto settings = test::tank_settings(true);
  const Fence fence{settings.supervisor.fence};
  const StateEstimate state{.p_WB = {0.0, 0.0, 0.75}, .valid = true};
  Designer a{settings.supervisor.design, settings.vehicle, settings.supervisor.largest, 4};
  Designer b{settings.supervisor.design, settings.vehicle, settings.supervisor.largest, 4};
  for (int i = 0; i < 3; ++i) {
    const Segment x = a.next(state, 0.0, ModelEstimate{}, fence, Eigen::Vector3d::Zero());
    const Segment y = b.next(state, 0.0, ModelEstimate{}, fence, Eigen::Vector3d::Zero());
    CHECK(x.at(1.3) == y.at(1.3));
  }
}

}  // namespace fathom::excitation
