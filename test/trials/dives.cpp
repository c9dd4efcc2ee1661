// Simulated runs of a small vehicle with motion capture, gyro and velocity log, as noisy as
// config/pipelines/beluga.yaml says, for `fathom methods --truth`.
#include <algorithm>
#include <cstdio>
#include <random>

#include "common/base/spatial.hpp"
#include "common/base/units.hpp"
#include "common/wire/log_writer.hpp"
#include "test/support/virtual_dive.hpp"
#include "test/trials/trials.hpp"

namespace fathom::trials {

void record_dives(const std::string& folder, int seeds) {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  for (int seed = 1; seed <= seeds; ++seed) {
    const auto dive = test::make_dive(vehicle, {.duration = 300.0,
                                                .dt = 0.05,
                                                .seed = static_cast<unsigned>(seed),
                                                .velocity_noise = 0.0,
                                                .rate_noise = 0.0,
                                                .spread = 0.0});
    std::mt19937 random{static_cast<unsigned>(seed)};
    std::normal_distribution<double> normal;
    const auto noise = [&](double sigma) {
      return Eigen::Vector3d(sigma * normal(random), sigma * normal(random), sigma * normal(random));
    };
    Recording r;
    r.name = "dive";
    for (std::size_t k = 0; k < dive.trial.size(); ++k) {
      const Utime utime = utime_after(1'700'000'000'000'000, dive.trial.t[k]);
      const Vector6d& nu = dive.trial.nu[k];
      r.ahrs.push_back({.utime = utime, .w_WB_B = nu.tail<3>() + noise(0.5 * kDegree), .has_rates = true});
      if (k % 2 == 0) {
        const Eigen::Quaterniond q = dive.trial.q_WB[k] * quaternion_from_rotation_vector(noise(0.3 * kDegree));
        r.pose_capture.push_back({.utime = utime, .p_WB = dive.trial.p_WB[k] + noise(0.001), .q_WB = q});
      }
      if (k % 4 == 0) r.dvl.push_back({.utime = utime, .v_WB_B = nu.head<3>() + noise(0.01)});
      const Eigen::VectorXd& f = dive.trial.input[k];
      r.thrusters.push_back({.utime = utime, .force = {f.data(), f.data() + f.size()}});
      const std::size_t before = k > 0 ? k - 1 : k, after = std::min(k + 1, dive.trial.size() - 1);
      const Vector6d nu_dot =
          (dive.trial.nu[after] - dive.trial.nu[before]) / (dive.trial.dt * static_cast<double>(after - before));
      r.truth.push_back(
          {.utime = utime, .p_WB = dive.trial.p_WB[k], .q_WB = dive.trial.q_WB[k], .nu = nu, .nu_dot = nu_dot});
    }
    const std::string path = folder + "/dive-" + std::to_string(seed) + ".lcmlog";
    wire::write_log(r, path);
    std::printf("%s\n", path.c_str());
  }
}

}  // namespace fathom::trials
