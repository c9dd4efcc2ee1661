#include "common/likelihood/curvature.hpp"

#include <doctest/doctest.h>

#include <Eigen/Cholesky>

using fathom::likelihood::Curvature;

namespace {

/// A maximum at zero whose curvature is a tenth of the information along one direction, and it along the others.
struct Flat {
  Eigen::MatrixXd information = Eigen::Vector4d{4.0, 1.0, 9.0, 2.0}.asDiagonal();
  Eigen::Vector4d along = Eigen::Vector4d{1.0, -2.0, 0.5, 1.0}.normalized();
  [[nodiscard]] Eigen::MatrixXd curvature() const {
    const Eigen::VectorXd u = information * along;
    return information - 0.9 / along.dot(u) * u * u.transpose();
  }
};

/// Steps from (1, 1, 1, 1) to a millionth of it, at most a hundred.
int steps(const Flat& flat, bool learns) {
  const Eigen::MatrixXd truth = flat.curvature();
  Eigen::VectorXd x = Eigen::VectorXd::Ones(4), slope = -truth * x;
  Curvature curvature;
  int count = 0;
  for (; count < 100 && x.norm() > 2e-6; ++count) {
    const Eigen::MatrixXd A =
        learns ? curvature.corrected(flat.information).value_or(flat.information) : flat.information;
    const Eigen::VectorXd s = A.ldlt().solve(slope);
    x += s;
    const Eigen::VectorXd there = -truth * x;
    curvature.learn(flat.information, s, slope - there);
    slope = there;
  }
  return count;
}

}  // namespace

TEST_CASE("curvature: where the information is ten times too large, learned steps arrive and others creep") {
  CHECK(steps({}, false) == 100);
  CHECK(steps({}, true) <= 10);
}

TEST_CASE("curvature: nothing is known before a step, and what is no maximum is not used") {
  const Eigen::MatrixXd information = Eigen::Matrix2d::Identity();
  Curvature curvature;
  CHECK_FALSE(curvature.corrected(information).has_value());
  // The slope grows along the step: no maximum, nothing learned.
  curvature.learn(information, Eigen::Vector2d{1.0, 0.0}, Eigen::Vector2d{-1.0, 0.0});
  CHECK_FALSE(curvature.corrected(information).has_value());
  curvature.learn(information, Eigen::Vector2d{1.0, 0.0}, Eigen::Vector2d{0.25, 0.0});
  REQUIRE(curvature.corrected(information).has_value());
  CHECK((*curvature.corrected(information))(0, 0) == doctest::Approx(0.25));
  CHECK((*curvature.corrected(information))(1, 1) == doctest::Approx(1.0));
  // With less information than was taken away from it there is no maximum left.
  CHECK_FALSE(curvature.corrected(0.5 * information).has_value());
  curvature.forget();
  CHECK_FALSE(curvature.corrected(information).has_value());
}
