// What one step of the joint estimate costs: 13 parameters of the LBV150 and 20 numbers of the motion, one attitude
// sample of a tank trial with all that comes with it (a prediction, rates, specific force; every third one flow, tags
// and laser).
#include <benchmark/benchmark.h>

#include <algorithm>

#include "common/joint/joint_rows.hpp"

namespace {

using namespace fathom;
using namespace fathom::joint;

JointFilter moving(const model::Vehicle& vehicle) {
  const auto n = static_cast<Eigen::Index>(vehicle.parameters.size());
  std::vector<model::BaseParameter> columns;
  ParameterVector mean(n);
  for (std::size_t k = 0; k < vehicle.parameters.size(); ++k) {
    columns.push_back(*model::parameter_from_name(vehicle.parameters[k]));
    mean(static_cast<Eigen::Index>(k)) = vehicle.priors[k].mean;
  }
  const ParameterVector sigma = 0.05 * mean.cwiseAbs();
  JointFilter filter{Normalised{vehicle, columns, ParameterVector{20.0 * mean.cwiseAbs()}}, {}, mean, sigma};
  const ParameterMatrix covariance = sigma.cwiseAbs2().asDiagonal();
  for (int axis = 0; axis < 6; ++axis) {
    if (filter.model().simulated(axis)) filter.teach(axis, mean, covariance);
  }
  filter.start({0.0, 0.0, 0.7}, Vector6d::Constant(0.1), Vector6d::Constant(0.02), 0.01);
  return filter;
}

void joint_step(benchmark::State& state) {
  const model::Vehicle vehicle = model::Vehicle::load(FATHOM_SOURCE_DIR "/config/vehicles/seabotix_lbv150.yaml");
  const JointFilter begin = moving(vehicle);
  JointFilter filter = begin;
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
  const Eigen::Vector3d p_BI{0.03, 0.01, -0.02}, none = Eigen::Vector3d::Zero();
  const estimation::CameraMount camera{.p_BC = {0.1, 0.0, 0.12}};
  std::array<JointRow, 3> rows;
  const auto use = [&](std::size_t count, double variance) {
    for (std::size_t i = 0; i < count; ++i) {
      rows[i].innovation = 1e-3;  // what is measured does not matter here
      rows[i].variance = variance;
    }
    benchmark::DoNotOptimize(filter.update(std::span{rows}.first(count), 1e9));
  };
  int n = 0;
  for (auto _ : state) {
    Vector6d tau;
    tau << (n / 100 % 2 == 0 ? 8.0 : -8.0), (n / 70 % 2 == 0 ? 6.0 : -6.0), 1.0, 0.0, 0.0,
        (n / 60 % 2 == 0 ? 0.5 : -0.5);
    filter.predict(0.01, I, I, I, tau);
    see_rates(filter.state(), {0.1, 0.1, 0.1}, rows);
    use(3, 1e-5);
    const std::size_t felt =
        feel_force(filter.model(), filter.state(),
                   {.told = I, .carried = I, .tau = tau, .w_dot = none, .p_BI = p_BI, .gravity = 9.81}, none, rows);
    use(felt, 1e-3);
    if (n % 3 == 0) {
      see_point(filter.state(), I, {0.0, 0.0, 1.5}, {0.1, 0.0, 0.8}, rows);
      use(3, 1e-4);
      see_flow(filter.state(), I, 1.5, camera, {0.1, 0.1, 0.1}, rows);
      use(3, 1e-4);
      see_floor(filter.state(), I, 1.5, {0.1, 0.0, 0.8}, rows[0]);
      use(1, 1e-4);
    }
    if (++n % 1000 == 0) filter = begin;
  }
}
BENCHMARK(joint_step);

}  // namespace
