// Simulated trials of the half-scale PAP-104 reconstructed: what the filter and the smoother reach, how consistent they
// are, and what is said of bad input.
#include "common/estimation/smoothing/trial_smoother.hpp"

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "common/base/error.hpp"
#include "common/estimation/online/kalman_estimator.hpp"
#include "common/estimation/smoothing/noise_from_rest.hpp"
#include "common/estimation/smoothing/process_tuning.hpp"
#include "common/estimation/smoothing/transponder_check.hpp"
#include "test/support/trial_recording.hpp"

namespace fathom::estimation {
namespace {

struct Fixture {
  model::Vehicle vehicle = model::Vehicle::load(std::string{FATHOM_SOURCE_DIR} + "/config/vehicles/pap104_half.yaml");
  KalmanSettings instruments = test::instruments_from_repository("pap104_half");
  Fixture() {
    instruments.process.jerk = 0.1;
    instruments.process.angular_jerk = 0.03;
  }
  [[nodiscard]] test::TrialRecording record(unsigned seed, bool noise = true) const {
    return test::record_trial(vehicle, instruments, {.seed = seed, .noise = noise});
  }
};

Eigen::Vector3d rms_position(const std::vector<Eigen::Vector3d>& errors) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& one : errors) sum += one.cwiseAbs2();
  return (sum / static_cast<double>(errors.size())).cwiseSqrt();
}

}  // namespace

TEST_CASE_FIXTURE(Fixture, "smoother: better than the filter, most of all at the beginning") {
  const auto trial = record(3);
  const SmoothedTrial result = smooth(trial.recording, instruments);
  REQUIRE(result.filtered.size() == trial.flight.size());
  REQUIRE(result.smoothed.size() == trial.flight.size());
  std::vector<Eigen::Vector3d> filter_early, filter_late, early, late;
  for (std::size_t k = 0; k < trial.flight.size(); ++k) {
    const Eigen::Vector3d& truth = trial.flight[k].p_WB;
    (trial.flight[k].t < 30.0 ? filter_early : filter_late).push_back(result.filtered[k].p_WB - truth);
    (trial.flight[k].t < 30.0 ? early : late).push_back(result.smoothed[k].p_WB - truth);
  }
  CHECK(rms_position(early).norm() < 0.7 * rms_position(filter_early).norm());
  CHECK(rms_position(late).norm() < 0.9 * rms_position(filter_late).norm());
  CHECK(rms_position(late).maxCoeff() < 0.1);  // m: ranges of 10 cm
}

TEST_CASE_FIXTURE(Fixture, "smoother: perfect instruments give the truth") {
  KalmanSettings settings = instruments;
  settings.accelerometer_noise.setConstant(1e-3);
  settings.gyro_noise.setConstant(1e-4);
  settings.heading_noise = settings.depth_noise = settings.range_noise = 1e-3;
  settings.biases = false;
  const auto trial = record(1, false);
  const SmoothedTrial result = smooth(trial.recording, settings);
  double worst = 0.0, worst_velocity = 0.0;
  for (std::size_t k = 0; k < trial.flight.size(); ++k) {
    worst = std::max(worst, (result.smoothed[k].p_WB - trial.flight[k].p_WB).norm());
    worst_velocity = std::max(worst_velocity, (result.smoothed[k].nu - trial.flight[k].nu).norm());
  }
  CHECK(worst < 0.02);           // m: thrust sets in within one step, which no smooth model follows
  CHECK(worst_velocity < 0.05);  // m/s, the same
}

TEST_CASE_FIXTURE(Fixture, "smoother: coupling lets accelerometers inform velocity, as printed they do not") {
  const auto trial = record(5);
  KalmanSettings printed = instruments;
  printed.model = KinematicModel::kPrinted;
  printed = tune_process(trial.recording, printed, 60.0);
  const KalmanSettings coupled = tune_process(trial.recording, instruments, 60.0);
  const auto error = [&](const KalmanSettings& settings) {
    const SmoothedTrial result = smooth(trial.recording, settings);
    double sum = 0.0;
    for (std::size_t k = 0; k < trial.flight.size(); ++k) {
      sum += (result.smoothed[k].nu - trial.flight[k].nu).head<3>().squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(trial.flight.size()));
  };
  const double with = error(coupled), without = error(printed);
  MESSAGE("rms of the velocity: coupled " << with << ", printed " << without << " m/s");
  CHECK(with < 0.8 * without);
}

TEST_CASE_FIXTURE(Fixture, "live: the estimator gives the filter's numbers, whatever the order of arrival") {
  const auto trial = record(2);
  const SmoothedTrial offline = smooth(trial.recording, instruments);
  KalmanEstimator live{instruments};
  std::vector<StateEstimate> states;
  const auto keep = [&](const KalmanEstimator::Output& output) {
    states.insert(states.end(), output.begin(), output.end());
  };
  std::size_t depth = 0, ranges = 0;
  for (const Ahrs& one : trial.recording.ahrs) {
    keep(live.step(one));
    const Utime late = one.utime - 100'000;  // depth and ranges arrive a tenth of a second late
    while (depth < trial.recording.depth.size() && trial.recording.depth[depth].utime <= late) {
      keep(live.step(trial.recording.depth[depth++]));
    }
    while (ranges < trial.recording.ranges.size() && trial.recording.ranges[ranges].utime <= late) {
      keep(live.step(trial.recording.ranges[ranges++]));
    }
  }
  keep(live.finish());
  REQUIRE(states.size() > offline.filtered.size() - 60);  // the last depths never came
  const StateEstimate &a = states[states.size() - 50], *b = nullptr;
  for (const StateEstimate& one : offline.filtered) {
    if (one.utime == a.utime) b = &one;
  }
  REQUIRE(b != nullptr);
  for (const auto& [reason, count] : live.rejected()) MESSAGE(reason << " " << count);
  // It begins when attitude and position are known, a moment after the log's first sample.
  CHECK((a.p_WB - b->p_WB).norm() < 1e-3);
  CHECK(a.valid);
}

TEST_CASE_FIXTURE(Fixture, "noise: a rest gives what the instruments have, and a run without one says so") {
  auto trial = record(4);
  KalmanSettings settings = instruments;
  settings.accelerometer_noise.setConstant(1.0);
  settings.gyro_noise.setConstant(1.0);
  settings.heading_noise = settings.depth_noise = 1.0;
  std::vector<std::string> notes;
  const KalmanSettings found = noise_from_rest(trial.recording, settings, notes);
  CHECK(found.accelerometer_noise.mean() == doctest::Approx(0.05).epsilon(0.15));  // 300 samples per axis
  CHECK(found.gyro_noise.mean() == doctest::Approx(0.005).epsilon(0.15));
  CHECK(found.depth_noise == doctest::Approx(0.02).epsilon(0.35));  // 60 samples, and the vehicle bobs on its chain
  CHECK(*found.heading_noise == doctest::Approx(instruments.heading_noise.value_or(1.0)).epsilon(0.35));
  REQUIRE(notes.size() == 1);
  settings.attitude_memory = 30.0;  // s: what wanders for so long does not show in seconds of rest
  const KalmanSettings wandering = noise_from_rest(trial.recording, settings, notes);
  CHECK(wandering.heading_noise == settings.heading_noise);
  CHECK(wandering.attitude_noise == settings.attitude_noise);
  trial.recording.ahrs.erase(trial.recording.ahrs.begin(), trial.recording.ahrs.begin() + 300);
  notes.clear();
  Recording moving = trial.recording;
  for (std::size_t i = 0; i < moving.ahrs.size(); ++i) {
    moving.ahrs[i].w_WB_B.z() += 0.2 * std::sin(0.05 * static_cast<double>(i));
  }
  CHECK(noise_from_rest(moving, settings, notes).gyro_noise == settings.gyro_noise);
  REQUIRE(notes.size() == 1);
  CHECK(notes.front().find("no stretch") != std::string::npos);
}

TEST_CASE_FIXTURE(Fixture,
                  "noise: a vehicle that drifts without a turn is not at rest, whichever instrument sees it go") {
  auto trial = record(4);
  REQUIRE(find_rest(trial.recording));
  const Rest rest = *find_rest(trial.recording);
  const auto seconds = [&](Utime utime) { return seconds_between(rest.from, utime); };
  Recording sinking = trial.recording;
  for (Depth& one : sinking.depth) one.z += 0.02 * seconds(one.utime);  // m/s: 0.1 m in the rest, five of its noises
  const auto later = find_rest(sinking);
  CHECK((!later || later->from > rest.to || later->to - later->from < rest.to - rest.from));
  Recording carried = trial.recording;  // by a current: the log tells a steady speed, and the hull feels none of it
  for (const Ahrs& one : trial.recording.ahrs) carried.dvl.push_back({.utime = one.utime, .v_WB_B = {0.1, 0.0, 0.0}});
  CHECK_FALSE(find_rest(carried));
  for (Dvl& one : carried.dvl) one.v_WB_B.setZero();
  CHECK(find_rest(carried));
}

TEST_CASE_FIXTURE(Fixture, "bad input: two transponders only are not enough to begin, and the line says what is") {
  auto trial = record(1);
  KalmanSettings settings = instruments;
  settings.transponders.resize(2);
  try {
    static_cast<void>(smooth(trial.recording, settings));
    FAIL("two transponders were accepted");
  } catch (const InputError& error) {
    CHECK(std::string{error.what()}.find("2 transponders do not fix a position") != std::string::npos);
  }
  settings.start = trial.flight.front().p_WB;
  const SmoothedTrial result = smooth(trial.recording, settings);
  CHECK((result.smoothed.back().p_WB - trial.flight.back().p_WB).norm() < 0.5);
}

TEST_CASE_FIXTURE(Fixture, "bad input: a transponder in the wrong place is named and left out, right ones never are") {
  const auto trial = record(6);
  std::vector<std::string> notes;
  KalmanSettings checked = without_wrong_transponders(trial.recording, instruments, notes);
  CHECK(notes.empty());
  for (std::size_t guilty = 0; guilty < instruments.transponders.size(); ++guilty) {
    KalmanSettings wrong = instruments;
    wrong.transponders[guilty].p_WT += Eigen::Vector3d(2.0, -1.5, 0.0);
    notes.clear();
    checked = without_wrong_transponders(trial.recording, wrong, notes);
    REQUIRE(notes.size() == 1);
    CHECK(notes.front().find("transponder " + wrong.transponders[guilty].name) != std::string::npos);
    CHECK_FALSE(checked.transponders[guilty].used);
  }
}

TEST_CASE_FIXTURE(Fixture, "bad input: a transponder that is left out neither witnesses nor is judged") {
  auto trial = record(6);
  KalmanSettings settings = instruments;
  settings.start = trial.flight.front().p_WB;  // to 2 m: ranges are asked to agree
  settings.transponders[3].used = false;
  Ranges& first = trial.recording.ranges.front();
  for (std::size_t i = 0; i < first.range.size(); ++i) {
    const Eigen::Vector3d p_WA = trial.flight.front().p_WB + trial.flight.front().q_WB * instruments.p_BA;
    first.range[i] = (instruments.transponders[i].p_WT - p_WA).norm() + (i == 0 ? 5.0 : 0.0);
    first.valid[i] = i == 2 ? 0 : 1;  // A, B and E do not agree, and two cannot tell who errs
  }
  const auto statistics = innovations(trial.recording, settings);
  CHECK(statistics[kFirstRange].refused > 0);
  CHECK(statistics[kFirstRange + 3].refused == 0);
  CHECK(statistics[kFirstRange + 3].used == 0);
}

TEST_CASE_FIXTURE(Fixture, "bad input: one of three transponders in the wrong place, or two exchanged, is told of") {
  const auto trial = record(6);
  std::vector<std::string> notes;
  KalmanSettings three = instruments;
  three.transponders.resize(3);
  static_cast<void>(without_wrong_transponders(trial.recording, three, notes));
  CHECK(notes.empty());
  three.transponders[1].p_WT += Eigen::Vector3d(2.0, -1.5, 0.0);
  static_cast<void>(without_wrong_transponders(trial.recording, three, notes));
  REQUIRE(notes.size() == 1);
  CHECK(notes.front().find("with 3 transponders nothing tells which place is wrong") != std::string::npos);
  notes.clear();
  KalmanSettings exchanged = instruments;
  std::swap(exchanged.transponders[0].p_WT, exchanged.transponders[1].p_WT);
  static_cast<void>(without_wrong_transponders(trial.recording, exchanged, notes));
  REQUIRE(notes.size() == 2);
  CHECK(notes[0].find("transponder A contradicts") != std::string::npos);
  CHECK(notes[1].find("transponder B contradicts") != std::string::npos);
}

TEST_CASE_FIXTURE(Fixture, "bad input: an outlier among the first three ranges does not begin the run") {
  auto trial = record(3);
  Ranges& first = trial.recording.ranges.front();
  for (std::size_t i = 0; i < first.range.size(); ++i) {
    const Eigen::Vector3d p_WA = trial.flight.front().p_WB + trial.flight.front().q_WB * instruments.p_BA;
    first.range[i] = (instruments.transponders[i].p_WT - p_WA).norm() + (i == 0 ? 2.24 : 0.05);
    first.valid[i] = i == 0 || i == 1 || i == 4 ? 1 : 0;
  }
  const SmoothedTrial result = smooth(trial.recording, instruments);
  double worst = 0.0;
  for (std::size_t k = 0; k < 500; ++k) {
    worst = std::max(worst, (result.smoothed[k].p_WB - trial.flight[k].p_WB).norm());
  }
  CHECK(worst < 0.25);  // m; begun from the outlier it is more than one, and right ranges are refused for seconds
}

TEST_CASE_FIXTURE(Fixture, "bad input: unequal time steps and a gap of seconds are bridged, and said") {
  auto trial = record(7);
  auto& ahrs = trial.recording.ahrs;
  for (std::size_t i = ahrs.size(); i-- > 0;) {
    const bool gap = i > 2500 && i < 2650;
    if (gap || (i % 3 == 1 && i % 7 < 3)) ahrs.erase(ahrs.begin() + static_cast<std::ptrdiff_t>(i));
  }
  const SmoothedTrial result = smooth(trial.recording, instruments);
  REQUIRE(result.notes.size() == 1);
  CHECK(result.notes.front().find("longer than the usual 0.02 s, the longest 3.") != std::string::npos);
  CHECK(smooth(record(7).recording, instruments).notes.empty());
  std::size_t k = 0;
  double worst = 0.0;
  for (const auto& one : result.smoothed) {
    while (utime_after(trial.recording.truth.front().utime, trial.flight[k].t) < one.utime) ++k;
    worst = std::max(worst, (one.p_WB - trial.flight[k].p_WB).norm());
  }
  CHECK(worst < 0.5);
}

TEST_CASE_FIXTURE(Fixture, "bad input: a run without a heading says what is missing") {
  auto trial = record(1);
  for (Ahrs& one : trial.recording.ahrs) one.has_attitude = false;
  try {
    static_cast<void>(smooth(trial.recording, instruments));
    FAIL("a run without heading was accepted");
  } catch (const InputError& error) {
    CHECK(std::string{error.what()} == "trial: no sensor tells the heading at the start");
  }
}

TEST_CASE("smoother: a vehicle that stands on its bow and turns over keeps its attitude") {
  // Two turns about the body's y axis in 40 s, then about x and z at once: every angle passes its singularity.
  Recording recording;
  recording.name = "loop";
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  std::vector<Eigen::Quaterniond> truth;
  std::mt19937 random{4};
  std::normal_distribution<double> normal;
  const auto noise = [&](double sigma) {
    return Eigen::Vector3d(sigma * normal(random), sigma * normal(random), sigma * normal(random));
  };
  for (int k = 0; k < 3000; ++k) {
    const double t = 0.02 * k;
    const Eigen::Vector3d w = t < 40.0 ? Eigen::Vector3d(0.0, 0.314, 0.02) : Eigen::Vector3d(0.3, 0.1, 0.3);
    const Utime utime = 1'000'000 + 20'000 * static_cast<Utime>(k);
    recording.ahrs.push_back({.utime = utime, .w_WB_B = w + noise(0.005), .has_rates = true});
    if (k % 5 == 0) {
      recording.pose_capture.push_back(
          {.utime = utime, .p_WB = noise(0.002), .q_WB = q * quaternion_from_rotation_vector(noise(0.005))});
    }
    truth.push_back(q);
    q = (q * quaternion_from_rotation_vector(0.02 * w)).normalized();
  }
  KalmanSettings settings;
  settings.process.angular_jerk = 0.5;
  const SmoothedTrial result = smooth(recording, settings);
  REQUIRE(result.smoothed.size() == truth.size());
  double worst = 0.0, square = 0.0;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const double off = truth[k].angularDistance(result.smoothed[k].q_WB);
    worst = std::max(worst, off);
    square += off * off / static_cast<double>(truth.size());
  }
  CHECK(std::sqrt(square) < 0.004);  // rad; attitudes of 5 mrad, ten a second
  CHECK(worst < 0.03);               // where the rates leap
}

}  // namespace fathom::estimation
