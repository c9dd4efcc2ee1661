#include "common/estimation/consistency.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/base/statistics.hpp"

namespace fathom::estimation {
namespace {

constexpr double kWorkingRate =
    25.0;  // Hz: faster streams are averaged; a 40 ms mean takes 0.3 % off at 1 Hz, off both sides
constexpr double kDegree = 0.017453292519943295;
constexpr double kPoorRates = 0.995;           // robust R^2 below which other readings of the quaternion are tried
constexpr double kPoorVelocity = 0.99;         // robust R^2 below which other world axes are tried
constexpr double kAlike = 2.7, kUnlike = 1.5;  // sums of three cosines: the axes agree, the axes do not
constexpr double kClearlyBetter = 0.5;         // a hypothesis must halve the unexplained share

std::string text(const char* format, double a, double b = 0.0) {
  char buffer[200];
  std::snprintf(buffer, sizeof buffer, format, a, b);
  return buffer;
}

const char* words(QuaternionForm form) {
  switch (form) {
    case QuaternionForm::kInverse:
      return "the attitude is world-to-body, read as body-to-world";
    case QuaternionForm::kScalarLast:
      return "the quaternion's scalar stands last, read as first";
    case QuaternionForm::kScalarLastInverse:
      return "the quaternion's scalar stands last and it is world-to-body";
    default:
      return "";
  }
}

Eigen::Quaterniond as_meant(QuaternionForm form, const Eigen::Quaterniond& q) {
  // Read as (w x y z) = (x y z w): what stands in z is w.
  Eigen::Quaterniond last(q.z(), q.w(), q.x(), q.y());
  switch (form) {
    case QuaternionForm::kInverse:
      return q.conjugate();
    case QuaternionForm::kScalarLast:
      return last;
    case QuaternionForm::kScalarLastInverse:
      return last.conjugate();
    default:
      return q;
  }
}

class Check {
 public:
  explicit Check(std::span<const Recording> recordings);
  ConsistencyResult run();

 private:
  [[nodiscard]] PoseSeries pose(std::size_t r) const {
    PoseSeries corrected = poses_[r];
    correct_pose(result_.corrections[r], corrected);
    return corrected;
  }
  /// How well an attitude fits the sensor, and how near to the identity the matrix between them is (3: all axes agree).
  struct AttitudeFit {
    double explained{-1.0};
    double likeness{};
  };
  [[nodiscard]] AttitudeFit quick_attitude(QuaternionForm form) const;
  [[nodiscard]] double quick_velocity(std::size_t r, const Eigen::Matrix3d& world, double reach) const;
  void choose_quaternion();
  void choose_world();
  PairResult rates() const;
  PairResult velocity(const PairResult& gyro) const;
  PairResult acceleration() const;
  bool blame_pose_axes(const PairResult& gyro, const PairResult& dvl);
  bool blame_position_unit(const PairResult& dvl);
  bool find_heading(const PairResult& dvl);
  void align_clocks();
  void compare_noise();
  void report(const std::string& signal, const std::string& finding, double size, const std::string& unit,
              const std::string& evidence, const std::string& action, const std::string& reference) {
    result_.findings.push_back({.run = "all",
                                .signal = signal,
                                .reference = reference,
                                .finding = finding,
                                .size = size,
                                .unit = unit,
                                .evidence = evidence,
                                .action = action});
  }

  std::vector<RunSignals> runs_;
  std::vector<PoseSeries> poses_;  // averaged to the working rate
  std::vector<Series> gyro_, dvl_, force_;
  std::vector<std::string> names_;
  std::string reference_;
  ConsistencyResult result_;
};

Check::Check(std::span<const Recording> recordings) {
  result_.corrections.resize(recordings.size());
  for (const Recording& recording : recordings) {
    runs_.push_back(read_signals(recording, result_.findings));
    const RunSignals& run = runs_.back();
    names_.push_back(run.name);
    poses_.push_back(block_average(reference_pose(run), kWorkingRate));
    gyro_.push_back(block_average(run.gyro, kWorkingRate));
    dvl_.push_back(block_average(run.dvl, kWorkingRate));
    force_.push_back(block_average(run.specific_force, kWorkingRate));
    reference_ = run.pose.has_attitude || run.attitude.empty() ? "pose_capture" : "ahrs_attitude";
  }
}

Check::AttitudeFit Check::quick_attitude(QuaternionForm form) const {
  std::vector<double> explained, likeness;
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    const bool by_gyro = !gyro_[r].empty();
    if (!poses_[r].has_attitude || (!by_gyro && (dvl_[r].empty() || !poses_[r].has_position))) continue;
    PoseSeries turned = poses_[r];
    for (Eigen::Quaterniond& q : turned.q_WB) q = as_meant(form, q);
    make_continuous(turned.q_WB);
    const IncrementProblem problem = by_gyro ? rate_problem(turned) : velocity_problem(turned, nullptr);
    const IncrementFit fit =
        fit_increments(problem, by_gyro ? gyro_[r] : dvl_[r], {.outlier_floor = 0.0, .quick = true});
    if (!fit.ok) continue;
    explained.push_back(fit.explained);
    likeness.push_back(0.0);
    for (int k = 0; k < 3; ++k) likeness.back() += fit.theta.segment<3>(3 * k).normalized()[k];
  }
  if (explained.empty()) return {};
  return {median(std::move(explained)), median(std::move(likeness))};
}

void Check::choose_quaternion() {
  const AttitudeFit as_read = quick_attitude(QuaternionForm::kAsRead);
  if (as_read.explained < -0.5 || (as_read.explained > kPoorRates && as_read.likeness > kAlike)) return;
  QuaternionForm best = QuaternionForm::kAsRead;
  AttitudeFit chosen = as_read;
  for (const QuaternionForm form :
       {QuaternionForm::kInverse, QuaternionForm::kScalarLast, QuaternionForm::kScalarLastInverse}) {
    const AttitudeFit fit = quick_attitude(form);
    const double unexplained = 1.0 - fit.explained, before = 1.0 - chosen.explained;
    // Two forms may differ by fixed turns only and explain alike: then the one that needs no swapped axes was meant.
    const bool better = unexplained < kClearlyBetter * before;
    const bool as_good = unexplained < before / kClearlyBetter && fit.likeness > kAlike && chosen.likeness < kUnlike;
    if (!better && !as_good) continue;
    best = form;
    chosen = fit;
  }
  const double best_explained = chosen.explained;
  if (best == QuaternionForm::kAsRead) return;
  for (Corrections& corrections : result_.corrections) corrections.quaternion = best;
  const bool order = best != QuaternionForm::kInverse;
  report(reference_ + ".attitude", order ? "quaternion_order" : "quaternion_inverse", 1.0, "",
         std::string(words(best)) +
             text(": explains %.4f of the sensor's increments, as read only %.4f", best_explained, as_read.explained),
         "corrected: read as meant", gyro_.empty() || gyro_[0].empty() ? "dvl" : "gyro");
}

double Check::quick_velocity(std::size_t r, const Eigen::Matrix3d& world, double reach) const {
  PoseSeries turned = pose(r);
  for (Eigen::Vector3d& p : turned.p_WB) p = world * p;
  const IncrementFit fit = fit_increments(velocity_problem(turned, nullptr), dvl_[r],
                                          {.longest_delay = reach, .outlier_floor = 0.0, .quick = true});
  return fit.ok ? fit.explained : -1.0;
}

void Check::choose_world() {
  std::vector<double> explained;
  std::size_t longest = 0;
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    if (!poses_[r].has_position || !poses_[r].has_attitude || dvl_[r].empty()) continue;
    const double one = quick_velocity(r, Eigen::Matrix3d::Identity(), 1.1);
    if (one < -0.5) continue;
    explained.push_back(one);
    if (dvl_[r].size() > dvl_[longest].size()) longest = r;
  }
  if (explained.empty() || median(explained) > kPoorVelocity) return;
  const double as_read = quick_velocity(longest, Eigen::Matrix3d::Identity(), 0.3);
  double best = 1.0 - kClearlyBetter * (1.0 - as_read);
  double heading = 0.0;
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  for (int step = 1; step < 24; ++step) {
    const double angle = step * 15.0 * kDegree;
    const double one =
        quick_velocity(longest, Eigen::AngleAxisd(-angle, Eigen::Vector3d::UnitZ()).toRotationMatrix(), 0.3);
    if (one > best) {
      best = one;
      heading = angle;
    }
  }
  // A permutation must do better still: a turned heading is the commoner fault.
  double needed = 1.0 - kClearlyBetter * (1.0 - best);
  for (int order = 0; order < 6; ++order) {
    for (int signs = 0; signs < 8; ++signs) {
      std::array<int, 3> to{0, 1, 2};
      for (int k = 0; k < order; ++k) std::next_permutation(to.begin(), to.end());
      Eigen::Matrix3d Q = Eigen::Matrix3d::Zero();
      for (int k = 0; k < 3; ++k) Q(to[static_cast<std::size_t>(k)], k) = (signs >> k) & 1 ? -1.0 : 1.0;
      const double one = quick_velocity(longest, Q, 0.3);
      if (one > needed) {
        needed = one;
        axes = Q;
      }
    }
  }
  if (!axes.isIdentity()) {
    for (Corrections& corrections : result_.corrections) corrections.position_axes = axes;
    std::string mapping;
    for (int row = 0; row < 3; ++row) {
      int column = 0;
      axes.row(row).cwiseAbs().maxCoeff(&column);
      mapping += std::string(row == 0 ? "" : ", ") + "xyz"[row] + " = " + (axes(row, column) < 0.0 ? "-" : "+") +
                 "xyz"[column];
    }
    report("pose_capture.position", axes.isDiagonal() ? "sign" : "axes", axes.isDiagonal() ? -1.0 : 1.0, "",
           "the position's world axes do not fit attitude and DVL: " + mapping +
               text(" explains %.3f, as read %.3f", needed, as_read),
           "corrected: " + mapping, "dvl");
  } else if (heading != 0.0) {
    for (Corrections& corrections : result_.corrections) corrections.heading = heading;
  }
}

PairResult Check::rates() const {
  std::vector<IncrementFit> fits(runs_.size());
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    if (!poses_[r].has_attitude || gyro_[r].empty()) continue;
    fits[r] = fit_increments(rate_problem(pose(r)), gyro_[r], {.outlier_floor = 1.5 * kDegree});
  }
  const PairNames names{
      .signal = "gyro", .reference = reference_, .axes = {"p", "q", "r"}, .unit = "rad/s", .bias_floor = 2e-4};
  return compare(names, names_, std::move(fits));
}

PairResult Check::velocity(const PairResult& gyro) const {
  std::vector<IncrementFit> fits(runs_.size());
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    if (!poses_[r].has_position || !poses_[r].has_attitude || dvl_[r].empty()) continue;
    const bool with_rates = gyro.checked && gyro.explained > 0.8 && !gyro_[r].empty();
    const Series rates = with_rates ? on_reference_clock(gyro.faults[r], gyro_[r]) : Series{};
    fits[r] =
        fit_increments(velocity_problem(pose(r), with_rates ? &rates : nullptr), dvl_[r], {.outlier_floor = 0.03});
  }
  const PairNames names{
      .signal = "dvl", .reference = "pose_capture", .axes = {"u", "v", "w"}, .unit = "m/s", .bias_floor = 2e-3};
  return compare(names, names_, std::move(fits));
}

PairResult Check::acceleration() const {
  std::vector<IncrementFit> fits(runs_.size());
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    if (!poses_[r].has_position || !poses_[r].has_attitude || force_[r].empty()) continue;
    fits[r] = fit_increments(acceleration_problem(pose(r)), force_[r], {.outlier_floor = 0.3});
  }
  const PairNames names{.signal = "accelerometer",
                        .reference = "pose_capture",
                        .axes = {"x", "y", "z"},
                        .unit = "m/s^2",
                        .bias_floor = 0.03,
                        .has_bias = false};
  return compare(names, names_, std::move(fits));
}

/// Gyro and DVL turned in the same way against the pose: then it is the pose's body axes that are turned.
bool Check::blame_pose_axes(const PairResult& gyro, const PairResult& dvl) {
  if (!gyro.checked || !dvl.checked || runs_.empty()) return false;
  const Eigen::Matrix3d base = gyro.faults[0].base;
  if (base.isIdentity() || base.determinant() < 0.0 || base != dvl.faults[0].base) return false;
  for (Corrections& corrections : result_.corrections) corrections.attitude_axes = base;
  report("pose_capture.attitude", "axes", 1.0, "",
         "gyro and DVL agree with each other and are both turned against the pose: its body axes are",
         "corrected: body axes of the pose turned", "gyro and dvl");
  return true;
}

/// A reference 100, 1000 or 3.28 times too large is in smaller units; a DVL in kilometres does not exist.
bool Check::blame_position_unit(const PairResult& dvl) {
  if (!dvl.checked) return false;
  std::vector<double> scales;
  for (const SensorFault& fault : dvl.faults) {
    for (int k = 0; k < 3; ++k) {
      if (fault.scale[k] != 1.0) scales.push_back(fault.scale[k]);
    }
  }
  const double scale = median(scales);
  for (const auto& [factor, unit] : {std::pair{100.0, "centimetres"}, {1000.0, "millimetres"}, {3.28084, "feet"}}) {
    if (std::abs(scale / factor - 1.0) > 0.1 || scales.size() < runs_.size()) continue;
    for (Corrections& corrections : result_.corrections) corrections.position_scale /= factor;
    report("pose_capture.position", "unit", factor, "",
           std::string("the position is in ") + unit + text(": it moves %.4g times as far as the DVL says", scale),
           "corrected: divided by the size", "dvl");
    return true;
  }
  return false;
}

bool Check::find_heading(const PairResult& dvl) {
  std::vector<double> values, sigmas;
  for (const IncrementFit& fit : dvl.fits) {
    if (!fit.ok || fit.theta_replicates.empty() || fit.theta.size() < 16) continue;
    std::vector<double> replicates;
    for (const Eigen::VectorXd& theta : fit.theta_replicates) replicates.push_back(theta[15]);
    const double sigma = jackknife_sigma(replicates);
    if (sigma > 2.0 * kDegree) continue;
    values.push_back(fit.theta[15]);
    sigmas.push_back(sigma);
  }
  const Pooled pooled = pool(values, sigmas);
  const double before = result_.corrections.empty() ? 0.0 : result_.corrections[0].heading;
  const bool significant =
      pooled.count > 0 && std::abs(pooled.value) > 6.0 * pooled.sigma && std::abs(pooled.value) > 0.5 * kDegree;
  if (significant) {
    for (Corrections& corrections : result_.corrections) corrections.heading += pooled.value;
  }
  const double heading = before + (significant ? pooled.value : 0.0);
  if (heading == 0.0) return false;
  std::erase_if(result_.findings, [](const ConsistencyFinding& one) { return one.finding == "heading_offset"; });
  const double offset = -std::remainder(heading, 360.0 * kDegree);
  report(reference_ + ".attitude", "heading_offset", offset, "rad",
         text("heading and track over ground differ by %.2f +- %.2f deg at all headings", offset / kDegree,
              pooled.sigma / kDegree),
         "corrected: attitude turned about the vertical", "pose_capture.position and dvl");
  return significant;
}

void Check::align_clocks() {
  bool any = false;
  bool on_board = false;
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    Corrections& one = result_.corrections[r];
    on_board = on_board || (!gyro_[r].empty() && one.gyro.delay != 0.0);
    any = any || one.gyro.delay != 0.0 || one.dvl.delay != 0.0;
    one.pose_shift = one.gyro.delay;  // gyro(t + delay) belongs to pose(t): the pose's stamps move to the gyro's clock
    one.gyro_shift = 0.0;
    one.dvl_shift = one.gyro.delay - one.dvl.delay;
  }
  if (!any) return;
  report(
      "thrusters", "clock", result_.corrections[0].pose_shift, "s",
      on_board
          ? "the clocks differ; kinematics cannot tell on whose clock the thrusters are: taken to be that of the "
            "on-board gyro"
          : "the clocks differ; kinematics cannot tell on whose clock the thrusters are: taken to be that of the pose",
      "assumed: thruster stamps unshifted; pose stamps moved by the size", on_board ? "gyro" : reference_);
}

void Check::compare_noise() {
  const auto check = [&](const std::string& signal, const std::vector<Series>& series, double floor, const char* unit) {
    std::array<double, 3> sigma{};
    for (int k = 0; k < 3; ++k) {
      std::vector<double> one;
      for (const Series& run : series) {
        std::vector<double> part;
        for (const Eigen::Vector3d& x : run.x) part.push_back(x[k]);
        if (part.size() > 100) one.push_back(white_noise_sigma(part));
      }
      sigma[static_cast<std::size_t>(k)] = median(std::move(one));
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const double others = std::max(sigma[(k + 1) % 3], sigma[(k + 2) % 3]);
      if (sigma[k] < 5.0 * others || sigma[k] < floor || others <= 0.0) continue;
      report(signal + "." + (signal == "gyro" ? "pqr" : "uvw")[k], "noise", sigma[k], unit,
             text("white noise %.3g, on the other axes at most %.3g ", sigma[k], others) + unit,
             "weighted by its noise", "its other axes");
    }
  };
  std::vector<Series> gyro, dvl;
  for (const RunSignals& run : runs_) {
    gyro.push_back(run.gyro);
    dvl.push_back(run.dvl);
  }
  check("gyro", gyro, 0.5 * kDegree, "rad/s");
  check("dvl", dvl, 0.01, "m/s");
}

ConsistencyResult Check::run() {
  choose_quaternion();
  PairResult gyro = rates();
  choose_world();
  PairResult dvl = velocity(gyro);
  if (blame_position_unit(dvl)) dvl = velocity(gyro);
  if (blame_pose_axes(gyro, dvl)) {
    gyro = rates();
    dvl = velocity(gyro);
  }
  for (int round = 0; round < 3 && find_heading(dvl); ++round) dvl = velocity(gyro);
  PairResult force = acceleration();
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    if (gyro.checked) {
      result_.corrections[r].gyro = gyro.faults[r];
      result_.corrections[r].doubtful_pose = gyro.fits[r].outlier_times;
    }
    if (dvl.checked) result_.corrections[r].dvl = dvl.faults[r];
    if (force.checked) result_.corrections[r].accelerometer = force.faults[r];
  }
  for (const auto& [name, pair] :
       {std::pair<std::string, PairResult*>{"gyro", &gyro}, {"dvl", &dvl}, {"accelerometer", &force}}) {
    result_.findings.insert(result_.findings.end(), pair->findings.begin(), pair->findings.end());
    for (std::size_t r = 0; r < pair->fits.size(); ++r) {
      const auto count = pair->fits[r].outlier_times.size();
      if (!pair->checked || count == 0) continue;
      result_.findings.push_back(
          {.run = names_[r],
           .signal = name,
           .reference = reference_,
           .finding = "outliers",
           .size = static_cast<double>(count),
           .unit = "windows",
           .evidence = std::to_string(count) +
                       " of the windows of about 1 s miss by more than 8 robust sigmas, the first at " +
                       text("%.1f s", pair->fits[r].outlier_times.front()),
           .action = name == "gyro" ? "pose masked there, gyro trusted" : "given no weight in the comparison"});
    }
  }
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    const std::vector<ConsistencyFinding> depth = compare_depth(runs_[r], pose(r));
    result_.findings.insert(result_.findings.end(), depth.begin(), depth.end());
  }
  align_clocks();
  compare_noise();
  result_.pairs.emplace("gyro", std::move(gyro));
  result_.pairs.emplace("dvl", std::move(dvl));
  result_.pairs.emplace("accelerometer", std::move(force));
  return std::move(result_);
}

}  // namespace

const PoseSeries& reference_pose(const RunSignals& run) {
  return run.pose.has_attitude || run.attitude.empty() ? run.pose : run.attitude;
}

void correct_pose(const Corrections& corrections, PoseSeries& pose) {
  const Eigen::Quaterniond heading(Eigen::AngleAxisd(corrections.heading, Eigen::Vector3d::UnitZ()));
  const Eigen::Quaterniond axes(corrections.attitude_axes);
  for (Eigen::Quaterniond& q : pose.q_WB) q = heading * as_meant(corrections.quaternion, q) * axes;
  for (Eigen::Vector3d& p : pose.p_WB) p = corrections.position_scale * (corrections.position_axes * p);
  make_continuous(pose.q_WB);
}

Series on_reference_clock(const SensorFault& fault, const Series& logged) {
  Series corrected = logged;
  const Eigen::Matrix3d M = fault.matrix();
  for (double& t : corrected.t) t -= fault.delay;
  for (Eigen::Vector3d& x : corrected.x) x = M * x + fault.bias;
  return corrected;
}

ConsistencyResult check_consistency(std::span<const Recording> recordings) { return Check(recordings).run(); }

}  // namespace fathom::estimation
