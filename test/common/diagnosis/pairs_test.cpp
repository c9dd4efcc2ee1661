// Which two effects promise most together: least squares on what each would change.
#include "common/diagnosis/pairs.hpp"

#include <doctest/doctest.h>

#include <random>

namespace fathom::diagnosis {
namespace {

const model::Effect* effect(std::size_t i) { return model::all_effects()[i]; }

/// Answers whose changes are `columns` (each of its own effect), and a residual that must vanish.
Answers answers_of(const Eigen::MatrixXd& columns, const Eigen::VectorXd& residual) {
  Answers answers;
  for (Eigen::Index i = 0; i < columns.cols(); ++i) {
    Screened screened{.effect = effect(static_cast<std::size_t>(i))};
    screened.change = columns.col(i).norm();
    screened.signature = columns.col(i).normalized();
    answers.near.push_back(screened);
  }
  answers.unexplained = residual;
  answers.axis = Eigen::VectorXi::Zero(residual.size());
  answers.cost = 0.5 * residual.squaredNorm();
  return answers;
}

Eigen::MatrixXd noise(Eigen::Index columns, unsigned seed) {
  std::mt19937 random{seed};
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(200, columns, [&] { return normal(random); });
}

}  // namespace

TEST_CASE("pairs: two that hide each other are found, with the amplitudes at which they do") {
  Eigen::MatrixXd columns = noise(6, 3);
  columns.col(4) = columns.col(1) + 0.4 * noise(1, 4);  // much like one another, and against each other
  const Eigen::VectorXd residual = -(2.0 * columns.col(1) - 1.8 * columns.col(4));
  const std::vector<Pair> pairs = promising_pairs(answers_of(columns, residual), 3);
  REQUIRE(pairs.size() == 3);
  CHECK(pairs[0].first == 1);
  CHECK(pairs[0].second == 4);
  CHECK(pairs[0].of_first == doctest::Approx(2.0));
  CHECK(pairs[0].of_second == doctest::Approx(-1.8));
  CHECK(pairs[0].share > 0.999);
  CHECK(pairs[1].share < 0.9);
}

TEST_CASE("pairs: forms of one effect that can act at once are a pair, those of which it has one are none") {
  const Eigen::MatrixXd columns = noise(4, 6);
  Answers answers = answers_of(columns, -(columns.col(0) + columns.col(1)));
  for (std::size_t i : {0UL, 1UL}) {
    answers.near[i].effect = model::find_effect("cross_coupling");
    answers.near[i].variant = static_cast<int>(i);
  }
  CHECK(promising_pairs(answers, 1).front().second == 1);
  for (std::size_t i : {0UL, 1UL}) answers.near[i].effect = model::find_effect("thruster_lag");
  CHECK(promising_pairs(answers, 1).front().share < 0.9);
}

TEST_CASE("pairs: forms of one effect, what changes nothing and what is one and the same are no pair") {
  const Eigen::MatrixXd columns = noise(5, 5);
  Answers answers = answers_of(columns, columns.col(0) + columns.col(1));
  answers.near[1].effect = effect(0);                      // another form of the first
  answers.near[2].change = 0.0;                            // changes nothing
  answers.near[4].signature = -answers.near[3].signature;  // the same as the one before
  for (const Pair& pair : promising_pairs(answers, 20)) {
    CHECK_FALSE((pair.first == 0 && pair.second == 1));
    for (const std::size_t place : {pair.first, pair.second}) CHECK(place != 2);
    CHECK_FALSE((pair.first == 3 && pair.second == 4));
  }
}

}  // namespace fathom::diagnosis
