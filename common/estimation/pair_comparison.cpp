// From increment fits to named faults: which axes, which sign, what scale, turn, bias, lever arm and delay; what of it
// is significant, large enough to matter, and shared by all recordings.
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>

#include "common/base/spatial.hpp"
#include "common/base/statistics.hpp"
#include "common/estimation/compatibility.hpp"

namespace fathom::estimation {
namespace {

constexpr double kDegree = 0.017453292519943295;
// Practical floors: smaller disagreements do not change a fitted model.
constexpr double kDelayFloor = 0.010;  // s
constexpr double kScaleFloor = 0.010;
constexpr double kAngleFloor = 0.3 * kDegree;
constexpr double kLeverFloor = 0.005;    // m
constexpr double kSignificant = 4.0;     // sigmas
constexpr double kColumnSeen = 8.0;      // |column of M| over its sigma: below, nothing is said about the axis
constexpr double kLargeTurn = 0.05;      // rad: beyond, small-angle formulas err by more than their floors
constexpr double kLeastExplained = 0.3;  // robust R^2 below which a pair says nothing about delay or scale
constexpr double kCouplingSeen = 4.0;

std::string text(const char* format, double a, double b = 0.0, double c = 0.0) {
  char buffer[160];
  std::snprintf(buffer, sizeof buffer, format, a, b, c);
  return buffer;
}

/// All 48 signed permutations.
std::vector<Eigen::Matrix3d> signed_permutations() {
  std::vector<Eigen::Matrix3d> all;
  std::array<int, 3> order{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Eigen::Matrix3d P = Eigen::Matrix3d::Zero();
      for (int k = 0; k < 3; ++k) P(order[static_cast<std::size_t>(k)], k) = (signs >> k) & 1 ? -1.0 : 1.0;
      all.push_back(P);
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return all;
}

/// The signed permutation nearest to the seen columns; the rest stays as near to the identity as it can.
Eigen::Matrix3d nearest_permutation(const Eigen::Matrix3d& M, const std::array<bool, 3>& seen) {
  Eigen::Matrix3d best = Eigen::Matrix3d::Identity();
  double best_score = -std::numeric_limits<double>::infinity();
  for (const Eigen::Matrix3d& P : signed_permutations()) {
    double score = 0.02 * P.trace() + 0.01 * (P.determinant() > 0.0 ? 1.0 : 0.0);
    for (int k = 0; k < 3; ++k) {
      if (seen[static_cast<std::size_t>(k)]) score += M.col(k).normalized().dot(P.col(k));
    }
    if (score > best_score) {
      best_score = score;
      best = P;
    }
  }
  return best;
}

Eigen::Matrix3d matrix_of(const Eigen::VectorXd& theta) { return Eigen::Map<const Eigen::Matrix3d>(theta.data()); }

struct Estimate {
  double value{};
  double sigma{std::numeric_limits<double>::infinity()};
  bool informative{false};
};

/// One number over recordings after the decision.
struct Decision {
  Pooled pooled;
  bool found{false};
  double limit{};                      ///< sigmas that count as significant with this much data
  std::vector<double> applied;         ///< per recording
  std::vector<std::size_t> different;  ///< recordings with a value of their own
};

class Comparison {
 public:
  Comparison(const PairNames& names, std::span<const std::string> runs, std::vector<IncrementFit> fits)
      : names_(names), runs_(runs) {
    result_.fits = std::move(fits);
    result_.faults.resize(runs.size());
  }
  PairResult run();

 private:
  using Read = std::function<double(const Eigen::VectorXd& theta)>;
  [[nodiscard]] const IncrementFit& fit(std::size_t run) const { return result_.fits[run]; }
  [[nodiscard]] Estimate estimate(std::size_t run, const Read& read, bool bracket) const;
  void see_columns();
  void find_axes();
  void find_matrix();
  void find_offsets();
  void find_delay();
  Decision decide(const std::vector<Estimate>& estimates, double neutral, double floor) const;
  void report(const Decision& decision, const std::string& signal, const std::string& finding, const std::string& unit,
              double neutral, const std::string& action, const std::string& more = "");
  [[nodiscard]] std::string axis(int k) const { return names_.signal + "." + names_.axes[static_cast<std::size_t>(k)]; }
  [[nodiscard]] std::string describe(const Eigen::Matrix3d& P, int body) const;

  const PairNames& names_;
  std::span<const std::string> runs_;
  PairResult result_;
  std::vector<std::array<bool, 3>> seen_;  ///< per recording, logged axis
  std::vector<Eigen::Matrix3d> turned_;    ///< per recording: permutation and large turn
};

Estimate Comparison::estimate(std::size_t run, const Read& read, bool bracket) const {
  const IncrementFit& one = fit(run);
  Estimate result;
  std::vector<double> replicates;
  for (const Eigen::VectorXd& theta : one.theta_replicates) replicates.push_back(read(theta));
  result.value = read(one.theta);
  result.sigma = jackknife_sigma(replicates);
  if (bracket) {
    // The sensor's own noise pulls the plain value toward zero, taking it out may overshoot: the truth is between.
    const double upper = read(one.theta_upper);
    const double half = 0.5 * (upper - result.value);
    result.value += half;
    result.sigma = std::hypot(result.sigma, half);
  }
  result.informative = true;
  return result;
}

void Comparison::see_columns() {
  std::vector<double> explained;
  seen_.assign(runs_.size(), {false, false, false});
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    if (!fit(r).ok || fit(r).theta_replicates.empty() || fit(r).explained < kLeastExplained) continue;
    for (int k = 0; k < 3; ++k) {
      double sigma = 0.0;
      for (int i = 0; i < 3; ++i) {
        sigma = std::max(sigma, estimate(
                                    r, [&](const Eigen::VectorXd& theta) { return theta[3 * k + i]; }, false)
                                    .sigma);
      }
      seen_[r][static_cast<std::size_t>(k)] = fit(r).theta.segment<3>(3 * k).norm() > kColumnSeen * sigma;
    }
    explained.push_back(fit(r).explained);
  }
  result_.checked = !explained.empty();
  result_.explained = median(std::move(explained));
}

std::string Comparison::describe(const Eigen::Matrix3d& P, int body) const {
  for (int k = 0; k < 3; ++k) {
    if (P(body, k) != 0.0) return (P(body, k) < 0.0 ? "-" : "+") + names_.axes[static_cast<std::size_t>(k)];
  }
  return "?";
}

void Comparison::find_axes() {
  // Pool the columns first: a run with one axis only must not vote on the others.
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  std::array<bool, 3> any{};
  std::vector<Eigen::Matrix3d> own(runs_.size(), Eigen::Matrix3d::Identity());
  for (int k = 0; k < 3; ++k) {
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      if (!seen_[r][static_cast<std::size_t>(k)]) continue;
      any[static_cast<std::size_t>(k)] = true;
      sum.col(k) += matrix_of(fit(r).theta).col(k).normalized();  // one run, one vote
    }
  }
  const Eigen::Matrix3d P = nearest_permutation(sum, any);
  std::vector<std::size_t> different;
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    const Eigen::Matrix3d M = matrix_of(fit(r).ok ? fit(r).theta : Eigen::VectorXd(Eigen::VectorXd::Zero(9)));
    bool agrees = true;
    for (int k = 0; k < 3; ++k) {
      if (seen_[r][static_cast<std::size_t>(k)] && M.col(k).normalized().dot(P.col(k)) < 0.5) agrees = false;
    }
    own[r] = agrees ? P : nearest_permutation(M, seen_[r]);
    if (!agrees && own[r] != P) different.push_back(r);
    result_.faults[r].base = own[r];
  }
  const auto say = [&](const Eigen::Matrix3d& one, const std::string& run, const std::array<bool, 3>& seen) {
    const bool diagonal = one.isDiagonal();
    const bool half_turn = diagonal && one.determinant() > 0.0;
    for (int body = 0; body < 3; ++body) {
      int logged = 0;
      one.row(body).cwiseAbs().maxCoeff(&logged);
      if (one(body, body) > 0.5 || !seen[static_cast<std::size_t>(logged)]) continue;
      std::string evidence = axis(body) + " follows the logged " + describe(one, body);
      if (half_turn && one(0, 0) > 0.0) evidence += "; y and z both: forward-left-up axes read as forward-right-down";
      if (half_turn && one(2, 2) > 0.0) evidence += "; x and y both: mounted turned by 180 deg about z";
      evidence += text(" (robust R^2 of the pair %.3f)", result_.explained);
      result_.findings.push_back(
          {.run = run,
           .signal = axis(body),
           .reference = names_.reference,
           .finding = diagonal ? "sign" : "axes",
           .size = one(body, logged),
           .unit = "",
           .evidence = evidence,
           .action = "corrected: " + names_.axes[static_cast<std::size_t>(body)] + " = logged " + describe(one, body)});
    }
  };
  say(P, "all", any);
  for (const std::size_t r : different) say(own[r], runs_[r], seen_[r]);

  // A large turn (a mount at an angle) is taken out before small angles are measured.
  turned_ = own;
  if (!(any[0] && any[1] && any[2])) return;
  const Eigen::Matrix3d pooled = sum * P.transpose();
  Eigen::Matrix3d unit = pooled;
  for (int k = 0; k < 3; ++k) unit.col(k).normalize();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(unit, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d turn = svd.matrixU() * svd.matrixV().transpose();
  if (turn.determinant() < 0.0 || Eigen::AngleAxisd(turn).angle() < kLargeTurn) return;
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    if (own[r] == P) turned_[r] = turn * P;
  }
}

Decision Comparison::decide(const std::vector<Estimate>& estimates, double neutral, double floor) const {
  Decision decision;
  decision.applied.assign(runs_.size(), neutral);
  std::vector<std::size_t> used;
  std::vector<double> all;
  for (std::size_t r = 0; r < estimates.size(); ++r) {
    if (!estimates[r].informative || !std::isfinite(estimates[r].sigma) || estimates[r].sigma <= 0.0) continue;
    used.push_back(r);
    all.push_back(estimates[r].value);
  }
  // A recording unlike the others: only a majority can say so.
  if (used.size() >= 3) {
    const double centre = median(all);
    const double spread = mad_sigma(all);
    std::vector<std::size_t> alike;
    for (const std::size_t r : used) {
      const double off = std::abs(estimates[r].value - centre);
      if (off > 3.0 * floor && off > 6.0 * std::hypot(estimates[r].sigma, spread)) {
        decision.different.push_back(r);
      } else {
        alike.push_back(r);
      }
    }
    if (2 * alike.size() > used.size()) {
      used = alike;
    } else {
      decision.different.clear();
    }
  }
  std::vector<double> values, sigmas;
  std::size_t blocks = 0;
  int positive = 0, negative = 0;
  for (const std::size_t r : used) {
    values.push_back(estimates[r].value - neutral);
    sigmas.push_back(estimates[r].sigma);
    blocks += fit(r).theta_replicates.size() - 1;
    (values.back() > 0.0 ? positive : negative) += 1;
  }
  decision.pooled = pool(values, sigmas);
  if (used.empty()) return decision;
  // Student's tail: few blocks know their own scatter badly. This follows the 6e-5 quantile down to 7 blocks.
  const double limit = kSignificant * (1.0 + 5.0 / static_cast<double>(blocks));
  decision.limit = limit;
  const double size = std::abs(decision.pooled.value);
  const int same = decision.pooled.value > 0.0 ? positive : negative;
  const bool repeated = used.size() < 3 ? same == static_cast<int>(used.size()) : same >= 3;
  decision.found = size > limit * decision.pooled.sigma && size > floor && repeated;
  decision.pooled.value += neutral;
  if (decision.found) decision.applied.assign(runs_.size(), decision.pooled.value);
  for (const std::size_t r : decision.different) decision.applied[r] = estimates[r].value;
  return decision;
}

void Comparison::report(const Decision& decision, const std::string& signal, const std::string& finding,
                        const std::string& unit, double neutral, const std::string& action, const std::string& more) {
  if (decision.found) {
    result_.findings.push_back(
        {.run = "all",
         .signal = signal,
         .reference = names_.reference,
         .finding = finding,
         .size = decision.pooled.value,
         .unit = unit,
         .evidence = text("%.5g +- %.2g (1 sigma)", decision.pooled.value, decision.pooled.sigma) + " " + unit +
                     ", from " + std::to_string(decision.pooled.count) + " recordings" + more,
         .action = action});
  }
  for (const std::size_t r : decision.different) {
    result_.findings.push_back({.run = runs_[r],
                                .signal = signal,
                                .reference = names_.reference,
                                .finding = finding,
                                .size = decision.applied[r],
                                .unit = unit,
                                .evidence = text("%.5g here, %.5g in the other recordings ", decision.applied[r],
                                                 decision.found ? decision.pooled.value : neutral) +
                                            unit + more,
                                .action = action + ", in this recording only"});
  }
}

/// "cm/s read as m/s" where a scale is a unit.
std::string unit_guess(double scale, bool rates) {
  struct Unit {
    double factor;
    const char* words;
  };
  static constexpr std::array<Unit, 2> kAngles{{{0.0174533, "the logged numbers are degrees"},
                                                {57.29578, "the logged numbers were divided by 57.3 once too often"}}};
  static constexpr std::array<Unit, 6> kLengths{{{0.01, "the logged numbers are centimetres"},
                                                 {0.001, "the logged numbers are millimetres"},
                                                 {0.3048, "the logged numbers are feet"},
                                                 {100.0, "the reference is in centimetres"},
                                                 {1000.0, "the reference is in millimetres"},
                                                 {3.28084, "the reference is in feet"}}};
  const auto search = [&](const auto& list) -> std::string {
    for (const Unit& unit : list) {
      if (std::abs(scale / unit.factor - 1.0) < 0.1) return unit.words;
    }
    return "";
  };
  return rates ? search(kAngles) : search(kLengths);
}

void Comparison::find_matrix() {
  std::array<Decision, 3> scales;
  for (int k = 0; k < 3; ++k) {
    std::vector<Estimate> estimates(runs_.size());
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      if (!seen_[r][static_cast<std::size_t>(k)]) continue;
      const Eigen::Vector3d direction = turned_[r].col(k);
      estimates[r] = estimate(
          r, [&](const Eigen::VectorXd& theta) { return direction.dot(theta.segment<3>(3 * k)); }, true);
    }
    Decision& decision = scales[static_cast<std::size_t>(k)];
    decision = decide(estimates, 1.0, kScaleFloor);
    const std::string unit = unit_guess(decision.pooled.value, names_.signal == "gyro");
    report(decision, axis(k), decision.found && !unit.empty() ? "unit" : "scale", "", 1.0,
           "corrected: multiplied by the size", "; 1 % matters" + (unit.empty() ? "" : "; " + unit));
    for (std::size_t r = 0; r < runs_.size(); ++r) result_.faults[r].scale[k] = decision.applied[r];
  }
  // Turn: the part of M's columns across their own direction, by two columns per axis, each as good as it is sure.
  std::vector<Eigen::Vector3d> turn(runs_.size(), Eigen::Vector3d::Zero());
  static constexpr std::array<const char*, 3> kAbout{"x", "y", "z"};
  std::array<double, 3> least{};  // of a turn that is significant and matters
  for (int a = 0; a < 3; ++a) {
    std::vector<Estimate> estimates(runs_.size());
    const int i = (a + 1) % 3, j = (a + 2) % 3;  // turn about a carries i to j and j to minus i
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      const Eigen::Matrix3d& T = turned_[r];
      const Eigen::Matrix3d P = result_.faults[r].base;
      const auto component = [&](const Eigen::VectorXd& theta, int from, int to) {
        int logged = 0;
        P.row(from).cwiseAbs().maxCoeff(&logged);
        const double sign = P(from, logged);
        const Eigen::Vector3d column = sign * T.transpose() * Eigen::Vector3d(theta.segment<3>(3 * logged));
        // In the turned frame the column lies along its logged axis.
        const Eigen::Vector3d body = P * column;
        return body[to] / body[from];
      };
      const auto logged_seen = [&](int body) {
        int logged = 0;
        P.row(body).cwiseAbs().maxCoeff(&logged);
        return seen_[r][static_cast<std::size_t>(logged)];
      };
      Estimate one, two;
      if (logged_seen(i))
        one = estimate(
            r, [&](const Eigen::VectorXd& theta) { return component(theta, i, j); }, false);
      if (logged_seen(j))
        two = estimate(
            r, [&](const Eigen::VectorXd& theta) { return -component(theta, j, i); }, false);
      if (!one.informative && !two.informative) continue;
      const double w1 = one.informative ? 1.0 / (one.sigma * one.sigma) : 0.0;
      const double w2 = two.informative ? 1.0 / (two.sigma * two.sigma) : 0.0;
      estimates[r].value = ((w1 > 0.0 ? w1 * one.value : 0.0) + (w2 > 0.0 ? w2 * two.value : 0.0)) / (w1 + w2);
      // Two columns that contradict each other show no turn.
      const double contradiction = one.informative && two.informative
                                       ? 0.5 * std::abs(one.value - two.value) * 2.0 * std::min(w1, w2) / (w1 + w2)
                                       : 0.0;
      estimates[r].sigma = std::hypot(std::sqrt(1.0 / (w1 + w2)), contradiction);
      estimates[r].informative = true;
      turn[r][a] = estimates[r].value;
    }
    Decision decision = decide(estimates, 0.0, kAngleFloor);
    least[static_cast<std::size_t>(a)] = std::max(kAngleFloor, decision.limit * decision.pooled.sigma);
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      const Eigen::Matrix3d large = turned_[r] * result_.faults[r].base.transpose();
      const bool is_large = !large.isIdentity(1e-9);
      turn[r][a] = is_large && estimates[r].informative ? decision.pooled.value : decision.applied[r];
    }
    if (turned_.empty() || turned_[0].isApprox(result_.faults[0].base, 1e-9)) {
      report(decision, names_.signal, std::string("misalignment_") + kAbout[static_cast<std::size_t>(a)], "rad", 0.0,
             "corrected: turned by the size about body " + std::string(kAbout[static_cast<std::size_t>(a)]));
    }
  }
  bool told = false;
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    const Eigen::Matrix3d P = result_.faults[r].base;
    const Eigen::Matrix3d large = turned_[r] * P.transpose();
    // turned = large * P; the small turn was measured in the logged frame carried to body axes, before the large turn.
    result_.faults[r].rotation = large * quaternion_from_rotation_vector(turn[r]).toRotationMatrix();
    if (large.isIdentity(1e-9)) continue;
    const Eigen::AngleAxisd whole(result_.faults[r].rotation);
    const Eigen::Vector3d vector = whole.angle() * whole.axis();
    // Badly seen columns fake a large turn, which then is not significant.
    bool significant = false;
    for (int a = 0; a < 3; ++a) significant = significant || std::abs(vector[a]) > least[static_cast<std::size_t>(a)];
    if (!significant) result_.faults[r].rotation.setIdentity();
    if (told || !significant) continue;
    told = true;
    for (int a = 0; a < 3; ++a) {
      if (std::abs(vector[a]) < least[static_cast<std::size_t>(a)]) continue;
      result_.findings.push_back({.run = "all",
                                  .signal = names_.signal,
                                  .reference = names_.reference,
                                  .finding = std::string("misalignment_") + kAbout[static_cast<std::size_t>(a)],
                                  .size = vector[a],
                                  .unit = "rad",
                                  .evidence = text("turned by %.2f deg in all, %.2f deg about this axis",
                                                   whole.angle() / kDegree, vector[a] / kDegree),
                                  .action = "corrected: turned back"});
    }
  }
}

void Comparison::find_offsets() {
  const int lever = names_.has_bias ? 12 : 9;
  for (int a = 0; a < 3 && names_.has_bias; ++a) {
    std::vector<Estimate> estimates(runs_.size());
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      if (!fit(r).ok || fit(r).explained < kLeastExplained) continue;
      estimates[r] = estimate(
          r, [&](const Eigen::VectorXd& theta) { return theta[9 + a]; }, false);
      estimates[r].informative = estimates[r].sigma < 10.0 * names_.bias_floor;
    }
    const Decision decision = decide(estimates, 0.0, names_.bias_floor);
    report(decision, axis(a), "bias", names_.unit, 0.0, "corrected: the size is added");
    for (std::size_t r = 0; r < runs_.size(); ++r) result_.faults[r].bias[a] = decision.applied[r];
  }
  const auto columns = [&](std::size_t r) { return static_cast<int>(fit(r).theta.size()); };
  const auto offsets = [&](int column, double floor, double limit, int lever_axis = -1) {
    std::vector<Estimate> estimates(runs_.size());
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      if (!fit(r).ok || fit(r).explained < kLeastExplained || column >= columns(r)) continue;
      if (lever_axis >= 0 && !fit(r).lever_seen[lever_axis]) continue;
      estimates[r] = estimate(
          r, [&](const Eigen::VectorXd& theta) { return theta[column]; }, false);
      estimates[r].informative = estimates[r].sigma < limit;
    }
    return decide(estimates, 0.0, floor);
  };
  std::array<Decision, 3> levers;
  double largest_lever = 0.0;
  for (int a = 0; a < 3; ++a) {
    levers[static_cast<std::size_t>(a)] = offsets(lever + a, kLeverFloor, 0.05, a);
    if (levers[static_cast<std::size_t>(a)].found)
      largest_lever = std::max(largest_lever, std::abs(levers[static_cast<std::size_t>(a)].pooled.value));
  }
  // A lever arm makes an antisymmetric coupling to the rates and nothing else.
  double largest_coupling = 0.0;
  Eigen::Matrix3d coupling = Eigen::Matrix3d::Zero();
  constexpr std::array<std::array<int, 2>, 6> kSymmetric{{{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};
  for (int k = 0; k < 6; ++k) {
    const Decision decision = offsets(lever + 4 + k, kLeverFloor, 0.02);
    const bool strong = decision.found && std::abs(decision.pooled.value) > kCouplingSeen * decision.pooled.sigma;
    if (!strong) continue;
    largest_coupling = std::max(largest_coupling, std::abs(decision.pooled.value));
    const auto [a, b] = kSymmetric[static_cast<std::size_t>(k)];
    coupling(a, b) = coupling(b, a) = decision.pooled.value;
  }
  const bool rigid = largest_coupling < 0.2 * largest_lever || largest_coupling == 0.0;
  static constexpr std::array<const char*, 3> kAxis{"x", "y", "z"};
  for (int a = 0; a < 3; ++a) {
    const Decision& decision = levers[static_cast<std::size_t>(a)];
    for (std::size_t r = 0; r < runs_.size(); ++r) result_.faults[r].lever[a] = decision.applied[r];
    if (rigid) {
      report(decision, names_.signal, std::string("lever_arm_") + kAxis[static_cast<std::size_t>(a)], "m", 0.0,
             "corrected: moved to the body origin");
    }
  }
  if (!rigid) {
    Eigen::Matrix3d whole = coupling;
    for (std::size_t r = 0; r < runs_.size(); ++r) result_.faults[r].coupling = coupling;
    whole += skew(result_.faults.empty() ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : result_.faults[0].lever);
    int row = 0, column = 0;
    whole.cwiseAbs().maxCoeff(&row, &column);
    result_.findings.push_back({.run = "all",
                                .signal = names_.signal,
                                .reference = names_.reference,
                                .finding = "rate_coupling",
                                .size = whole(row, column),
                                .unit = "m",
                                .evidence = "couples to the rates as no lever arm can (symmetric part up to " +
                                            text("%.1f mm", 1e3 * largest_coupling) +
                                            "): as if a lever correction had been made with wrong rates; largest: " +
                                            names_.axes[static_cast<std::size_t>(row)] + " from rate " +
                                            kAxis[static_cast<std::size_t>(column)],
                                .action = "corrected: the fitted coupling is taken out"});
  }
}

void Comparison::find_delay() {
  std::vector<Estimate> estimates(runs_.size());
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    if (!fit(r).ok || !fit(r).delay_found || fit(r).explained < kLeastExplained) continue;
    estimates[r].value = fit(r).delay;
    estimates[r].sigma = jackknife_sigma(fit(r).delay_replicates);
    estimates[r].informative = estimates[r].sigma < 0.05;
  }
  const Decision decision = decide(estimates, 0.0, kDelayFloor);
  report(decision, names_.signal, "delay", "s", 0.0, "corrected: clocks aligned",
         decision.pooled.value > 0.0 ? "; lags " + names_.reference : "; leads " + names_.reference);
  for (std::size_t r = 0; r < runs_.size(); ++r) result_.faults[r].delay = decision.applied[r];
}

PairResult Comparison::run() {
  see_columns();
  if (!result_.checked) return std::move(result_);
  find_axes();
  find_delay();
  find_matrix();
  find_offsets();
  return std::move(result_);
}

}  // namespace

PairResult compare(const PairNames& names, std::span<const std::string> runs, std::vector<IncrementFit> fits) {
  return Comparison(names, runs, std::move(fits)).run();
}

}  // namespace fathom::estimation
