#include "test/sealed/dives/dive.hpp"

#include <optional>

#include "test/sealed/dives/helmsman.hpp"
#include "test/sealed/dives/pilot.hpp"

namespace fathom::sealed {
namespace {

constexpr double kWarmUp = 12.0;  // s, so that a file begins in the middle of things
constexpr int kSteps = 2;         // of 5 ms between samples
constexpr double kRunaway = 6.0;  // m/s or rad/s: no such vehicle is that fast

Vector6 white(double first, double second, Random& random) {
  Vector6 x;
  for (int i = 0; i < 6; ++i) x[i] = (i < 3 ? first : second) * random.normal();
  return x;
}

void sense(const Dive& run, const std::vector<State>& all, const Mechanisms& mechanisms, Random& random, Streams& out) {
  out.dt = run.dt;
  for (const State& state : all) {
    out.position.push_back(state.head<3>());
    out.euler.push_back(state.segment<3>(3));
    out.nu.push_back(state.segment<6>(kSpeed));
  }
  for (const auto& mechanism : mechanisms) mechanism->sense(out, random);
  const auto skip = static_cast<std::ptrdiff_t>(run.warm_up);
  out.position.erase(out.position.begin(), out.position.begin() + skip);
  out.euler.erase(out.euler.begin(), out.euler.begin() + skip);
  out.nu.erase(out.nu.begin(), out.nu.begin() + skip);
}

}  // namespace

Dive dive(const Craft& craft, const Site& site, const Mechanisms& mechanisms, const Noise& noise,
          const DiveOrder& order) {
  Dive run;
  run.begin = order.begin;
  const double from = order.begin - kWarmUp, to = order.begin + order.length;
  Random paths(order.seed, order.purpose + ":paths"), noises(order.seed, order.purpose + ":noise");
  Random drive(order.seed, order.purpose + ":pilot"), instruments(order.seed, order.purpose + ":instruments");
  for (const auto& mechanism : mechanisms) mechanism->begin_file(from, to, paths);
  std::optional<Pilot> pilot;
  std::optional<Helmsman> helmsman;
  if (craft.craft_class == CraftClass::kRov) {
    pilot.emplace(craft, site, from, to, drive);
  } else {
    helmsman.emplace(craft, site, from, to, drive);
  }
  Body body(craft, mechanisms);
  State state = body.at_rest(site.centre, drive.uniform(-3.0, 3.0)), rate = state;
  rate.setZero();
  run.warm_up = static_cast<std::size_t>(std::lround(kWarmUp / run.dt));
  const std::size_t count = run.warm_up + static_cast<std::size_t>(std::lround(order.length / run.dt));
  run.commands.begin = from;
  run.commands.dt = run.dt;
  run.commands.hold = order.hold;
  run.commands.force.assign(1, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(craft.jets.size())));
  run.commands.force.reserve(count + 1);
  std::vector<State> all;
  all.reserve(count);
  for (std::size_t k = 0; k < count; ++k) {
    const double t = from + static_cast<double>(k) * run.dt;
    const Vector6 pose_noise = white(noise.position, noise.angle, noises);
    const Vector6 nu_noise = white(noise.velocity, noise.rate, noises);
    const Eigen::Vector3d position = state.head<3>() + pose_noise.head<3>();
    const Eigen::Vector3d euler = state.segment<3>(3) + pose_noise.tail<3>();
    const Vector6 nu = state.segment<6>(kSpeed) + nu_noise;
    run.commands.force.push_back(pilot ? pilot->command(t + run.dt, run.dt, position, euler, nu)
                                       : helmsman->command(t + run.dt, run.dt, position, euler, nu));
    all.push_back(state);
    if (k >= run.warm_up) {
      body.rate(t, state, run.commands, rate);
      run.state.push_back(state);
      run.nu_dot.emplace_back(rate.segment<6>(kSpeed));
      run.pose_noise.push_back(pose_noise);
      run.nu_noise.push_back(nu_noise);
      for (const auto& mechanism : mechanisms) {
        if (const double volt = mechanism->voltage(t); volt > 0.0) run.voltage.push_back(volt);
      }
    }
    for (int i = 0; i < kSteps; ++i) body.step(t + i * run.dt / kSteps, run.dt / kSteps, run.commands, state);
    if (!state.allFinite() || state.segment<6>(kSpeed).cwiseAbs().maxCoeff() > kRunaway || std::abs(state[4]) > 1.4) {
      run.sound = false;
      return run;
    }
  }
  sense(run, all, mechanisms, instruments, run.sensed);
  return run;
}

}  // namespace fathom::sealed
