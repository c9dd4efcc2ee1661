#include "common/estimation/reconstruct.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/base/spatial.hpp"
#include "common/base/statistics.hpp"
#include "common/estimation/pose_derivatives.hpp"
#include "common/estimation/run_signals.hpp"
#include "common/estimation/steady_attitude.hpp"
#include "common/estimation/trial_columns.hpp"
#include "common/estimation/trial_input.hpp"
#include "common/estimation/wording.hpp"

namespace fathom::estimation {
namespace {

constexpr double kHighestRate = 50.0;  // Hz: at half of it, steps of 40 ms put masses 0.05 % off
constexpr double kDoubt = 0.4;         // s: half the window in which gyro and pose were compared
constexpr double kFewSteps = 2.5;      // between samples that a spline joins
constexpr double kMostlyThere = 0.05;  // least share of the grid that samples fill: else a clock has leapt

void measure_noise(DerivativeSource& source) {
  for (int k = 0; k < 3; ++k) {
    std::vector<double> part;
    for (const Eigen::Vector3d& x : source.series.x) part.push_back(x[k]);
    source.sigma[k] = white_noise_sigma(source.series.t, part);
  }
}

/// Evaluates a source on the grid.
void sample(const DerivativeSource& source, const std::vector<double>& grid, std::vector<Eigen::Vector3d>& x,
            std::vector<std::uint8_t>& ok) {
  x.assign(grid.size(), Eigen::Vector3d::Zero());
  ok.assign(grid.size(), 0);
  if (!source.exists()) return;
  const Spline spline(source.series, std::max(source.bridged, kFewSteps * typical_step(source.series.t)));
  // The first and last stamp may lie a rounding beside the grid.
  constexpr double kEdge = 1e-5;  // s
  for (std::size_t i = 0; i < grid.size(); ++i) {
    double t = grid[i];
    if (t < source.series.t.front() && t > source.series.t.front() - kEdge) t = source.series.t.front();
    if (t > source.series.t.back() && t < source.series.t.back() + kEdge) t = source.series.t.back();
    ok[i] = spline.at(t, x[i]) ? 1 : 0;
  }
}

/// Straight lines across what is not valid, constant beyond the ends.
void bridge(std::vector<Eigen::Vector3d>& x, const std::vector<std::uint8_t>& ok) {
  const std::size_t n = x.size();
  std::size_t before = n;
  for (std::size_t i = 0; i < n; ++i) {
    if (ok[i] == 0) continue;
    const std::size_t from = before == n ? 0 : before + 1;
    for (std::size_t j = from; j < i; ++j) {
      const double share = before == n ? 1.0 : static_cast<double>(j - before) / static_cast<double>(i - before);
      x[j] = before == n ? x[i] : Eigen::Vector3d((1.0 - share) * x[before] + share * x[i]);
    }
    before = i;
  }
  for (std::size_t j = before == n ? n : before + 1; j < n; ++j) x[j] = x[before];
}

/// Whom to charge with what separates sensor and derivative beyond their white noise. A gyro's own errors are small and
/// slow once bias and turn are out, a derivative of attitude carries the tracker's jitter; a DVL wanders with its beams
/// and is interpolated between slow samples, position seldom does.
enum class Doubt { kSensor, kDerivative };

/// The better of two sources, or both weighted when their noise is alike; the other bridges gaps.
struct Choice {
  std::vector<Eigen::Vector3d> x;
  std::vector<std::uint8_t> ok;
  Eigen::Vector3d sigma{Eigen::Vector3d::Zero()};
  Eigen::Vector3d share{Eigen::Vector3d::Ones()};  ///< of the sensor
};

Choice choose(const DerivativeSource& sensor, const DerivativeSource& derivative, const std::vector<double>& grid,
              Doubt doubt) {
  std::vector<Eigen::Vector3d> a, b;
  std::vector<std::uint8_t> a_ok, b_ok;
  sample(sensor, grid, a, a_ok);
  sample(derivative, grid, b, b_ok);
  Eigen::Vector3d sigma_a = sensor.sigma;
  Eigen::Vector3d sigma_b = derivative.sigma;
  if (sensor.exists() && derivative.exists()) {
    for (int k = 0; k < 3; ++k) {
      std::vector<double> difference;
      for (std::size_t i = 0; i < grid.size(); ++i) {
        if (a_ok[i] && b_ok[i]) difference.push_back(a[i][k] - b[i][k]);
      }
      const double total = mad_sigma(std::move(difference));
      Eigen::Vector3d& charged = doubt == Doubt::kSensor ? sigma_a : sigma_b;
      const double other = doubt == Doubt::kSensor ? sigma_b[k] : sigma_a[k];
      const double rest = total * total - other * other;
      if (rest > 0.5 * total * total) charged[k] = std::max(charged[k], std::sqrt(rest));
    }
  }
  Choice choice;
  choice.x.resize(grid.size());
  choice.ok.resize(grid.size());
  Eigen::Vector3d& share = choice.share;
  for (int k = 0; k < 3; ++k) {
    if (!sensor.exists()) share[k] = 0.0;
    if (!sensor.exists() || !derivative.exists()) continue;
    const double va = sigma_a[k] * sigma_a[k], vb = sigma_b[k] * sigma_b[k];
    if (va + vb <= 0.0) continue;
    share[k] = vb / (va + vb);
    if (share[k] > 0.8) share[k] = 1.0;
    if (share[k] < 0.2) share[k] = 0.0;
  }
  for (int k = 0; k < 3; ++k) {
    const double sa = sensor.exists() ? sigma_a[k] : 0.0, sb = derivative.exists() ? sigma_b[k] : 0.0;
    choice.sigma[k] = std::hypot(share[k] * sa, (1.0 - share[k]) * sb);
  }
  for (std::size_t i = 0; i < grid.size(); ++i) {
    choice.ok[i] = a_ok[i] | b_ok[i];
    for (int k = 0; k < 3; ++k) {
      const double s = a_ok[i] && b_ok[i] ? share[k] : (a_ok[i] ? 1.0 : 0.0);
      choice.x[i][k] = s * a[i][k] + (1.0 - s) * b[i][k];
    }
  }
  bridge(choice.x, choice.ok);
  return choice;
}

/// A grid over a clock that leaps (set by a network after a start at 1970, say) would fill all memory with nothing.
void check_span(const std::string& name, const std::vector<double>& t, double dt) {
  if (dt <= 0.0) throw InputError(name + ": its samples share one time stamp");
  const double span = t.back() - t.front();
  if (kMostlyThere * span <= static_cast<double>(t.size()) * dt) return;
  std::size_t longest = 1;
  for (std::size_t i = 1; i < t.size(); ++i) {
    if (t[i] - t[i - 1] > t[longest] - t[longest - 1]) longest = i;
  }
  throw InputError(name + ": " + std::to_string(t.size()) + " samples " + text("%.3g", dt) +
                   " s apart lie spread over " + text("%.4g", span) + " s; the longest gap is " +
                   text("%.4g", t[longest] - t[longest - 1]) + " s, after " + text("%.4g", t[longest - 1]) +
                   " s. Does its clock leap there? Give what is before and after as recordings of their own");
}

void shift(std::vector<double>& t, double by) {
  for (double& one : t) one += by;
}

}  // namespace

Trial reconstruct(const Recording& recording, const Corrections& corrections, const model::Vehicle& vehicle) {
  std::vector<ConsistencyFinding> ignored;
  const RunSignals run = read_signals(recording, ignored);

  PoseSeries pose = block_average(reference_pose(run), kHighestRate);
  correct_pose(corrections, pose);
  for (const double doubtful : corrections.doubtful_pose) {
    const auto from = std::lower_bound(pose.t.begin(), pose.t.end(), doubtful - kDoubt) - pose.t.begin();
    const auto to = std::upper_bound(pose.t.begin(), pose.t.end(), doubtful + kDoubt) - pose.t.begin();
    std::fill(pose.valid.begin() + from, pose.valid.begin() + to, std::uint8_t{0});
  }
  shift(pose.t, corrections.pose_shift);
  PoseDerivatives derived = differentiate(pose);

  DerivativeSource gyro{.series = block_average(run.gyro, kHighestRate)};
  shift(gyro.series.t, corrections.gyro_shift);
  to_body(corrections.rates_frame, corrections.rates_world, pose, gyro.series);
  const Eigen::Matrix3d gyro_matrix = corrections.gyro.matrix();
  for (Eigen::Vector3d& x : gyro.series.x) x = gyro_matrix * x + corrections.gyro.bias;
  measure_noise(gyro);

  DerivativeSource dvl{.series = block_average(run.dvl, kHighestRate)};
  shift(dvl.series.t, corrections.dvl_shift);
  to_body(corrections.velocity_frame, corrections.velocity_world, pose, dvl.series);
  const Spline rates(gyro.exists() ? gyro.series : derived.rates.series);
  const Eigen::Matrix3d dvl_matrix = corrections.dvl.matrix();
  const Eigen::Matrix3d from_rates = skew(corrections.dvl.lever) + corrections.dvl.coupling;
  for (std::size_t i = 0; i < dvl.series.size(); ++i) {
    Eigen::Vector3d omega = Eigen::Vector3d::Zero();
    if (!from_rates.isZero() && !rates.at(dvl.series.t[i], omega)) omega.setZero();
    dvl.series.x[i] = dvl_matrix * dvl.series.x[i] + corrections.dvl.bias + from_rates * omega;
  }
  measure_noise(dvl);
  // An estimate that follows its instruments late changes late, and smoothly: its noise would tell nothing of that.
  if (recording.pose_estimated && gyro.exists()) derived.rates = {};
  if (recording.pose_estimated && dvl.exists()) derived.velocity = {};

  // The main stream gives the grid; blocks are centred, so a fast stream's means fall on the grid.
  const std::vector<double>* main = nullptr;
  double shifted = 0.0;
  for (const auto& [times, by] : {std::pair{&run.gyro.t, corrections.gyro_shift},
                                  {&reference_pose(run).t, corrections.pose_shift},
                                  {&run.dvl.t, corrections.dvl_shift}}) {
    if (main == nullptr && times->size() > 3) {
      main = times;
      shifted = by;
    }
  }
  if (main == nullptr)
    throw InputError(recording.name + ": no motion is recorded (neither pose, nor rates, nor velocity)");
  const double step = typical_step(*main);
  const double block = std::max(1.0, std::ceil(1.0 / (kHighestRate * step) - 0.05));
  Trial trial;
  trial.name = recording.name;
  trial.dt = std::round(block * step * 1e6) * 1e-6;  // stamps are whole microseconds
  check_span(recording.name, *main, trial.dt);
  const double begin = main->front() + shifted + 0.5 * (block - 1.0) * step;
  const auto count = static_cast<std::size_t>((main->back() + shifted - begin) / trial.dt + 1e-3) + 1;
  for (std::size_t i = 0; i < count; ++i) trial.t.push_back(begin + static_cast<double>(i) * trial.dt);

  trial.observed = {.position = pose.has_position,
                    .attitude = pose.has_attitude,
                    .velocity = dvl.exists() || derived.velocity.exists(),
                    .rates = gyro.exists() || derived.rates.exists()};
  const Choice velocity = choose(dvl, derived.velocity, trial.t, Doubt::kSensor);
  const Choice angular = choose(gyro, derived.rates, trial.t, Doubt::kDerivative);
  trial.velocity_valid = velocity.ok;
  trial.rates_valid = angular.ok;
  for (std::size_t i = 0; i < count; ++i) trial.nu.push_back((Vector6d() << velocity.x[i], angular.x[i]).finished());
  trial.nu_sigma << velocity.sigma, angular.sigma;

  DerivativeSource position, vector, scalar;
  for (std::size_t i = 0; i < pose.size(); ++i) {
    if (!pose.valid[i]) continue;
    for (DerivativeSource* one : {&position, &vector, &scalar}) one->series.t.push_back(pose.t[i]);
    position.series.x.push_back(pose.p_WB[i]);
    vector.series.x.push_back(pose.q_WB[i].vec());
    scalar.series.x.emplace_back(pose.q_WB[i].w(), 0.0, 0.0);
  }
  std::vector<Eigen::Vector3d> x, y;
  sample(position, trial.t, trial.p_WB, trial.pose_valid);
  sample(vector, trial.t, x, trial.pose_valid);
  sample(scalar, trial.t, y, trial.pose_valid);
  bridge(trial.p_WB, trial.pose_valid);
  bridge(x, trial.pose_valid);
  bridge(y, trial.pose_valid);
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Quaterniond q(y[i].x(), x[i].x(), x[i].y(), x[i].z());
    trial.q_WB.push_back(trial.observed.attitude && q.norm() > 1e-6 ? q.normalized() : Eigen::Quaterniond::Identity());
  }

  if (trial.observed.attitude && (angular.share.array() == 1.0).all()) steady_attitude(trial);

  add_input(recording, run.origin, corrections.thrusters, vehicle, {static_cast<int>(block), step}, trial);
  add_columns(recording, run.origin, vehicle, trial);
  const double start = trial.t.front();
  for (double& t : trial.t) t -= start;
  return trial;
}

}  // namespace fathom::estimation
