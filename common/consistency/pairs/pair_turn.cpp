// By what small angles the sensor's axes are turned against the body, beyond swaps and signs.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "common/base/spatial.hpp"
#include "common/base/units.hpp"
#include "common/consistency/pairs/pair_comparison.hpp"
#include "common/estimation/wording.hpp"

namespace fathom::consistency {
namespace {

constexpr double kPractical = 3.0 * kDegree;   // 5 % of one axis show in another
constexpr double kAngleFloor = 0.3 * kDegree;  // smaller disagreements do not change a fitted model

}  // namespace

void Comparison::find_turns() {
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
      const auto of_first = [&](const Eigen::VectorXd& theta) { return component(theta, i, j); };
      const auto of_second = [&](const Eigen::VectorXd& theta) { return -component(theta, j, i); };
      Estimate one, two;
      if (logged_seen(i)) one = estimate(fit(r), of_first, false);
      if (logged_seen(j)) two = estimate(fit(r), of_second, false);
      if (!one.informative && !two.informative) continue;
      const double w1 = one.informative ? 1.0 / (one.sigma * one.sigma) : 0.0;
      const double w2 = two.informative ? 1.0 / (two.sigma * two.sigma) : 0.0;
      estimates[r].value = ((w1 > 0.0 ? w1 * one.value : 0.0) + (w2 > 0.0 ? w2 * two.value : 0.0)) / (w1 + w2);
      // Two columns that contradict each other show no turn.
      const double contradiction = one.informative && two.informative
                                       ? 0.5 * std::abs(one.value - two.value) * 2.0 * std::min(w1, w2) / (w1 + w2)
                                       : 0.0;
      estimates[r].sigma = std::hypot(std::sqrt(1.0 / (w1 + w2)), contradiction);
      estimates[r].freedom = (w1 * one.freedom + w2 * two.freedom) / (w1 + w2);
      estimates[r].informative = true;
      turn[r][a] = estimates[r].value;
    }
    const SharedValue decision = share(estimates, 0.0, kAngleFloor);
    least[static_cast<std::size_t>(a)] = std::max(kAngleFloor, decision.limit * decision.pooled.sigma);
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      const Eigen::Matrix3d large = turned_[r] * result_.faults[r].base.transpose();
      const bool is_large = !large.isIdentity(1e-9);
      turn[r][a] = is_large && estimates[r].informative ? decision.pooled.value : decision.applied[r];
    }
    if (turned_.empty() || turned_[0].isApprox(result_.faults[0].base, 1e-9)) {
      report(decision, names_.signal, std::string("misalignment_") + kAbout[static_cast<std::size_t>(a)], "rad", 0.0,
             kPractical,
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

}  // namespace fathom::consistency
