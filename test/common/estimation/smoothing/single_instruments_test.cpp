// Accelerometers and gyros beside the inertial package, each a column of its own with its place and its direction
// cosines (Pereira and Duncan, eqs. 12 to 14).
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/estimation/online/kalman_estimator.hpp"
#include "common/estimation/smoothing/process_tuning.hpp"
#include "common/estimation/smoothing/trial_instruments.hpp"
#include "common/estimation/smoothing/trial_smoother.hpp"
#include "test/support/trial_recording.hpp"

namespace fathom::estimation {
namespace {

using Mount = model::SingleInertialMount;
constexpr double kForceNoise = 0.02, kForceBias = 0.05;  // m/s^2
constexpr double kRateNoise = 0.002, kRateBias = 0.005;  // rad/s

/// At bow, stern and sides, square to the arm: together they feel how the hull begins to turn. Two are askew, and a
/// gyro.
std::vector<Mount> scattered() {
  const auto force = [](const char* name, const Eigen::Vector3d& place, const Eigen::Vector3d& axis) {
    return Mount{Mount::Measures::kForce, name, place, axis.normalized()};
  };
  return {
      force("bow y", {0.6, 0.0, 0.0}, {0.0, 1.0, 0.0}),        force("bow z", {0.6, 0.0, 0.0}, {0.0, 0.0, 1.0}),
      force("stern y", {-0.6, 0.0, 0.0}, {0.0, 1.0, 0.0}),     force("stern z", {-0.6, 0.0, 0.0}, {0.0, 0.0, 1.0}),
      force("port", {0.0, -0.35, 0.0}, {0.3, 0.0, 1.0}),       force("starboard", {0.0, 0.35, 0.0}, {-0.3, 0.2, 1.0}),
      Mount{Mount::Measures::kRate, "yaw gyro", {}, {0, 0, 1}}};
}

struct Scattered {
  model::Vehicle vehicle = model::Vehicle::load(std::string{FATHOM_SOURCE_DIR} + "/config/vehicles/pap104_half.yaml");
  KalmanSettings instruments = test::instruments_from_repository("pap104_half");
  /// A recorded zigzag, and what the mounts tell of the flight: a_O + w x (w x r) + w_dot x r - g, along each.
  struct Trial {
    test::TrialRecording record;
    std::vector<double> biases;
  };
  [[nodiscard]] Trial record(unsigned seed) const {
    const model::Manoeuvre manoeuvre{.kind = model::ManoeuvreKind::kZigzag, .duration = 60.0, .difference = 4.5};
    Trial trial{test::record_trial(vehicle, instruments, {.manoeuvre = manoeuvre, .seed = seed}), {}};
    std::mt19937 random{1000 + seed};
    std::normal_distribution<double> normal;
    const std::vector<Mount> mounts = scattered();
    for (const Mount& mount : mounts)
      trial.biases.push_back((mount.measures == Mount::Measures::kForce ? kForceBias : kRateBias) * normal(random));
    const Utime first = trial.record.recording.ahrs.front().utime;
    for (const model::FlightMoment& m : trial.record.flight) {
      const Eigen::Vector3d v = m.nu.head<3>(), w = m.nu.tail<3>(), w_dot = m.nu_dot.tail<3>();
      const Eigen::Vector3d down = m.q_WB.conjugate() * Eigen::Vector3d::UnitZ();
      for (std::size_t i = 0; i < mounts.size(); ++i) {
        const bool force = mounts[i].measures == Mount::Measures::kForce;
        const Eigen::Vector3d& r = mounts[i].p_BS;
        const Eigen::Vector3d felt =
            m.nu_dot.head<3>() + w.cross(v) + w.cross(w.cross(r)) + w_dot.cross(r) - model::kGravity * down;
        trial.record.recording.signals.push_back({.utime = utime_after(first, m.t - trial.record.flight.front().t),
                                                  .name = mounts[i].signal,
                                                  .unit = mounts[i].unit(),
                                                  .value = mounts[i].axis_B.dot(force ? felt : w) + trial.biases[i] +
                                                           (force ? kForceNoise : kRateNoise) * normal(random)});
      }
    }
    return trial;
  }
  [[nodiscard]] KalmanSettings with_singles() const {
    KalmanSettings settings = instruments;
    settings.add_singles(scattered());
    for (SingleInertial& one : settings.singles)
      one.noise = one.mount.measures == Mount::Measures::kForce ? kForceNoise : kRateNoise;
    return settings;
  }
};

/// Over the run: mean square of the angular accelerations' errors, and the same over what the smoother says of them.
struct Turning {
  double error2{}, nees{};
};

Turning turning(const SmoothedTrial& smoothed, const std::vector<model::FlightMoment>& flight) {
  Turning sum;
  REQUIRE(smoothed.smoothed.size() == flight.size());
  for (std::size_t k = 0; k < flight.size(); ++k) {
    const Eigen::Vector3d off = (smoothed.smoothed[k].nu_dot - flight[k].nu_dot).tail<3>();
    sum.error2 += off.squaredNorm() / 3.0;
    sum.nees += off.cwiseQuotient(smoothed.smoothed[k].sigma.tail<3>()).squaredNorm() / 3.0;
  }
  const auto count = static_cast<double>(flight.size());
  return {sum.error2 / count, sum.nees / count};
}

}  // namespace

TEST_CASE_FIXTURE(Scattered,
                  "single instruments: accelerometers apart tell how the hull turns, and their biases are found") {
  Turning without, with;
  double biases = 0.0;
  int count = 0;
  constexpr unsigned kSeeds = 2;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const Trial trial = record(seed);
    const KalmanSettings alone = tune_process(trial.record.recording, instruments, 60.0);
    const KalmanSettings settings = tune_process(trial.record.recording, with_singles(), 60.0);
    const SmoothedTrial many = smooth(trial.record.recording, settings);
    const Turning of_one = turning(smooth(trial.record.recording, alone), trial.record.flight);
    const Turning of_many = turning(many, trial.record.flight);
    without = {without.error2 + of_one.error2 / kSeeds, without.nees + of_one.nees / kSeeds};
    with = {with.error2 + of_many.error2 / kSeeds, with.nees + of_many.nees / kSeeds};
    for (std::size_t i = 0; i < settings.singles.size(); ++i) {
      const InnovationStatistics& one = many.statistics[many.statistics.size() - settings.singles.size() + i];
      CAPTURE(one.name);
      CHECK(one.name == settings.singles[i].mount.signal);
      CHECK(one.used == static_cast<std::int64_t>(trial.record.flight.size()));
      CHECK(one.nis() == doctest::Approx(1.0).epsilon(0.2));
    }
    // Bow and stern along one axis differ by how the hull turns, which has no mean over a run, and by their biases.
    for (const auto& [a, b] : {std::pair{0, 2}, std::pair{1, 3}}) {
      const double found = many.biases[model::at::kSingleBias + a] - many.biases[model::at::kSingleBias + b];
      biases +=
          std::pow(found - (trial.biases[static_cast<std::size_t>(a)] - trial.biases[static_cast<std::size_t>(b)]), 2);
      ++count;
    }
  }
  MESSAGE("angular acceleration, rms: one package " << std::sqrt(without.error2) << " rad/s^2 (NEES " << without.nees
                                                    << "), with singles " << std::sqrt(with.error2) << " (" << with.nees
                                                    << "); biases' differences " << std::sqrt(biases / count));
  CHECK(with.error2 < 0.6 * without.error2);
  CHECK(with.nees < 2.0);
  CHECK(std::sqrt(biases / count) < 0.2 * std::sqrt(2.0) * kForceBias);  // of what they differ by before
}

namespace {

/// STATE of a recording whose other instruments come a tenth of a second after the package; `beside` may say more.
template <class Beside>
std::vector<StateEstimate> fed(KalmanEstimator& live, const Recording& r, const Beside& beside) {
  std::vector<StateEstimate> states;
  const auto keep = [&](const KalmanEstimator::Output& output) {
    states.insert(states.end(), output.begin(), output.end());
  };
  std::size_t depth = 0, ranges = 0, signal = 0;
  for (const Ahrs& one : r.ahrs) {
    const Utime late = one.utime - 100'000;
    for (; depth < r.depth.size() && r.depth[depth].utime <= late; ++depth) keep(live.step(r.depth[depth]));
    for (; ranges < r.ranges.size() && r.ranges[ranges].utime <= late; ++ranges) keep(live.step(r.ranges[ranges]));
    for (; signal < r.signals.size() && r.signals[signal].utime <= late; ++signal) keep(live.step(r.signals[signal]));
    keep(live.step(one));
    beside(one.utime);
  }
  keep(live.finish());
  return states;
}

}  // namespace

TEST_CASE_FIXTURE(Scattered,
                  "single instruments: the live filter takes them in, whatever the order in which they come") {
  const Trial trial = record(7);
  const SmoothedTrial offline = smooth(trial.record.recording, with_singles());
  KalmanEstimator live{with_singles()};
  const std::vector<StateEstimate> states = fed(live, trial.record.recording, [](Utime) {});
  REQUIRE(states.size() > 1000);
  const StateEstimate& a = states[states.size() - 50];
  const auto b = std::ranges::find(offline.filtered, a.utime, &StateEstimate::utime);
  REQUIRE(b != offline.filtered.end());
  CHECK((a.p_WB - b->p_WB).norm() < 1e-3);  // m: it begins a moment later than the log
  CHECK((a.nu - b->nu).norm() < 1e-3);
  for (const auto& [reason, number] : live.rejected()) CHECK_MESSAGE(reason.find("bow") == std::string::npos, reason);
}

TEST_CASE_FIXTURE(Scattered,
                  "single instruments: columns of others, and clocks that are hours off, change no bit of STATE") {
  const Trial trial = record(7);
  KalmanEstimator live{with_singles()}, disturbed{with_singles()};
  const std::vector<StateEstimate> alone = fed(live, trial.record.recording, [](Utime) {});
  const std::vector<StateEstimate> beside = fed(disturbed, trial.record.recording, [&](Utime utime) {
    for (const double off : {3600.0, -3600.0}) {
      const Utime wrong = utime_after(utime, off);
      CHECK(disturbed.step(Signal{.utime = wrong, .name = "winch", .unit = "m", .value = 3.0}).empty());
      CHECK(disturbed.step(Signal{.utime = wrong, .name = "bow y", .unit = "m/s^2", .value = 9.0}).empty());
    }
  });
  CHECK(disturbed.rejected().at("ahead") == static_cast<std::int64_t>(trial.record.recording.ahrs.size()));
  REQUIRE(alone.size() > 1000);
  REQUIRE(beside.size() == alone.size());
  for (std::size_t k = 0; k < alone.size(); ++k) {
    REQUIRE(beside[k].utime == alone[k].utime);
    REQUIRE(beside[k].p_WB == alone[k].p_WB);
    REQUIRE(beside[k].nu == alone[k].nu);
  }
}

TEST_CASE_FIXTURE(Scattered, "single instruments: the vehicle file names the columns; their noises are measured") {
  Trial trial = record(9);
  TrialFiles files;
  model::Mounts mounts = vehicle.mounts;
  mounts.singles = scattered();
  mounts.singles.push_back({Mount::Measures::kForce, "never recorded", {0.1, 0.0, 0.0}, {1, 0, 0}});
  files.mounts = mounts;
  const TrialInstruments told = instruments_of(trial.record.recording, files);
  CHECK(told.unrecorded == std::vector<std::string>{"never recorded"});
  REQUIRE(told.settings.singles.size() == scattered().size());
  CHECK(told.settings.states() == model::kMostStates);
  for (const SingleInertial& one : told.settings.singles) {
    const bool force = one.mount.measures == Mount::Measures::kForce;
    REQUIRE(one.noise);
    CHECK(*one.noise == doctest::Approx(force ? kForceNoise : kRateNoise).epsilon(0.15));
  }
  trial.record.recording.signals.clear();
  CHECK(instruments_of(trial.record.recording, files).settings.states() == model::kInertialStates);
}

TEST_CASE_FIXTURE(Scattered, "single instruments: a column in another unit is refused, with what to do") {
  Trial trial = record(3);
  trial.record.recording.signals.front().unit = "V";
  std::string said;
  try {
    static_cast<void>(smooth(trial.record.recording, with_singles()));
  } catch (const InputError& error) {
    said = error.what();
  }
  CHECK_MESSAGE(said.find("column 'bow y' is told in 'V', not in m/s^2") != std::string::npos, said);
}

TEST_CASE("single instruments: what a vehicle file may say of them") {
  const auto mounts = [](const std::string& text) { return model::Mounts::from(Config::parse(text, "vehicle.yaml")); };
  const auto said = [&](const std::string& text) -> std::string {
    try {
      static_cast<void>(mounts(text));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const std::string bow = "  - {signal: bow, position: 1 0 0 m, axis: 0 0.6 0.8}\n",
                    yaw = "  - {signal: yaw, axis: 0 0 1}\n";
  const model::Mounts both = mounts("accelerometers:\n" + bow + "gyros:\n" + yaw);
  REQUIRE(both.singles.size() == 2);
  CHECK(both.singles[0].p_BS == Eigen::Vector3d(1.0, 0.0, 0.0));
  CHECK(both.singles[0].axis_B.isApprox(Eigen::Vector3d(0.0, 0.6, 0.8), 1e-12));
  CHECK(std::string{both.singles[1].unit()} == "rad/s");
  CHECK(said("accelerometers:\n" + bow + bow).find("two instruments are told as 'bow'") != std::string::npos);
  CHECK(said("accelerometers:\n  - {signal: a, position: 1 0 0 m, axis: 0 0 2}\n").find("unit vector") !=
        std::string::npos);
  std::string many = "gyros:\n";
  for (int i = 0; i < 10; ++i) many += "  - {signal: g" + std::to_string(i) + ", axis: 0 0 1}\n";
  CHECK(said(many).find("more than 9") != std::string::npos);
}

}  // namespace fathom::estimation
