// Which body axis each logged axis lies along, with what sign, and the large turn of a mount at an angle.
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>

#include "common/consistency/pairs/pair_comparison.hpp"
#include "common/consistency/pairs/signed_permutation.hpp"
#include "common/estimation/wording.hpp"

namespace fathom::consistency {
namespace {

constexpr double kLargeTurn = 0.05;  // rad: beyond, small-angle formulas err by more than their floors

Eigen::Matrix3d matrix_of(const Eigen::VectorXd& theta) { return Eigen::Map<const Eigen::Matrix3d>(theta.data()); }

}  // namespace

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
  for (int k = 0; k < 3; ++k) {
    const bool seen = any[static_cast<std::size_t>(k)];
    const double along = seen ? sum.col(k).normalized()[k] : 0.0;
    result_.statements.push_back({.signal = axis(k),
                                  .reference = names_.reference,
                                  .quantity = "axis",
                                  .answer = !seen           ? Answer::kCannotTell
                                            : P(k, k) > 0.5 ? Answer::kAgree
                                                            : Answer::kDisagree,
                                  .value = along,
                                  .neutral = 1.0,
                                  .practical = 1.0});
  }
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

}  // namespace fathom::consistency
