// usage: fathom_live_states SITE VEHICLE FIRST LAST
// Live trials in one process, and the same log smoothed without a word of configuration: errors of the live STATE and
// of the smoothed one against the simulator's truth, and squares of errors over what each says of itself.
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <string>

#include "common/estimation/smoothing/state_reconstruction.hpp"
#include "test/support/full_trial.hpp"

namespace {

using namespace fathom;

constexpr double kBegun = 10.0;  // s after which states are compared: by then the live filter is valid

/// Position, attitude, velocity, rates.
struct Errors {
  std::array<double, 4> square{}, nees{};
  double count{};

  template <class State>
  void add(const State& state, const Truth& truth) {
    const double dt = seconds_between(truth.utime, state.utime);  // the truth is told less often
    const Eigen::Quaterniond q_then =
        truth.q_WB * quaternion_from_rotation_vector(dt * truth.nu.tail<3>() + 0.5 * dt * dt * truth.nu_dot.tail<3>());
    std::array<Eigen::Vector3d, 4> off{state.p_WB - truth.p_WB - dt * (truth.q_WB * truth.nu.template head<3>()),
                                       rotation_vector_from_quaternion(q_then.conjugate() * state.q_WB),
                                       state.nu.template head<3>() - truth.nu.head<3>() - dt * truth.nu_dot.head<3>(),
                                       state.nu.template tail<3>() - truth.nu.tail<3>() - dt * truth.nu_dot.tail<3>()};
    for (std::size_t i = 0; i < 4; ++i) {
      square[i] += off[i].squaredNorm();
      const Eigen::Vector3d sigma = state.sigma.template segment<3>(3 * static_cast<Eigen::Index>(i));
      nees[i] += off[i].cwiseQuotient(sigma).squaredNorm() / 3.0;
    }
    count += 1.0;
  }
  void print(const char* who) const {
    constexpr std::array kUnit{1e3, 57.29577951308232, 1e3, 57.29577951308232};
    std::printf("  %-9s", who);
    for (std::size_t i = 0; i < 4; ++i)
      std::printf(" %9.3f (%6.2f)", kUnit[i] * std::sqrt(square[i] / count), nees[i] / count);
    std::printf("\n");
  }
};

template <class State>
void compare(const std::vector<State>& states, const std::vector<Truth>& truths, Errors& errors) {
  std::size_t k = 0;
  for (const Truth& truth : truths) {
    if (seconds_between(truths.front().utime, truth.utime) < kBegun) continue;
    while (k < states.size() && states[k].utime < truth.utime) ++k;
    if (k == states.size() || states[k].utime - truth.utime > 5'000) continue;
    if constexpr (requires { states[k].valid; }) {
      if (!states[k].valid) continue;
    }
    errors.add(states[k], truth);
  }
}

int run(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: %s SITE VEHICLE FIRST LAST\n", argv[0]);
    return 1;
  }
  std::printf(
      "rms and, in brackets, NEES per component: position [mm], attitude [deg], velocity [mm/s], rates [deg/s]\n");
  Errors all_live, all_smoothed;
  int refused = 0;
  for (unsigned seed = static_cast<unsigned>(std::stoi(argv[3])); seed <= static_cast<unsigned>(std::stoi(argv[4]));
       ++seed) {
    Recording recording{.name = "seed " + std::to_string(seed)};
    static_cast<void>(test::run_trial({.seed = seed, .site = argv[1], .vehicle = argv[2], .recording = &recording}));
    Errors live, smoothed;
    compare(recording.state, recording.truth, live);
    compare(recording.state, recording.truth, all_live);
    std::printf("%s\n", recording.name.c_str());
    live.print("live");
    try {
      std::vector<std::string> notes;
      const auto found = estimation::reconstruct_state(recording, estimation::files_in(recording), {}, notes);
      for (const std::string& note : notes) std::printf("    %s\n", note.c_str());
      compare(found.trial.smoothed, recording.truth, smoothed);
      compare(found.trial.smoothed, recording.truth, all_smoothed);
      smoothed.print("smoothed");
      for (const auto& one : found.trial.statistics) {
        if (one.used + one.refused == 0) continue;
        std::printf("    %-16s used %8lld refused %6lld NIS %.3f\n", one.name.c_str(), static_cast<long long>(one.used),
                    static_cast<long long>(one.refused), one.nis());
      }
    } catch (const std::exception& error) {
      std::printf("  refused: %s\n", error.what());
      ++refused;
    }
    std::fflush(stdout);
  }
  std::printf("all, %d refused\n", refused);
  all_live.print("live");
  if (all_smoothed.count > 0.0) all_smoothed.print("smoothed");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
