// Normal equations of increments against plain least squares, and the noise that misfits show.
#include "common/consistency/increments/increment_normals.hpp"

#include <doctest/doctest.h>

#include <Eigen/QR>
#include <random>
#include <vector>

namespace fathom::consistency {
namespace {

constexpr int kColumns = 5, kWindows = 200;
constexpr double kRidge = 1e-6;  // relative: what the tiny ridge takes off

struct Data {
  Eigen::MatrixXd rows{3 * kWindows, kColumns};
  Eigen::VectorXd y{3 * kWindows}, truth{kColumns};
  std::vector<Normals> blocks;

  explicit Data(double noise) {
    std::mt19937 random{5};
    std::normal_distribution<double> normal;
    truth << 1.0, -2.0, 0.5, 3.0, 100.0;
    for (int w = 0; w < kWindows; ++w) {
      Rows part{3, kColumns};
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < kColumns; ++j) part(i, j) = normal(random) * (j == 4 ? 1e-3 : 1.0);
      }
      const Eigen::Vector3d own =
          part * truth + noise * Eigen::Vector3d(normal(random), normal(random), normal(random));
      rows.middleRows<3>(3 * w) = part;
      y.segment<3>(3 * w) = own;
      if (w % 25 == 0) blocks.emplace_back(kColumns);
      blocks.back().add(part, own, 1.0);
    }
  }
  [[nodiscard]] Normals all() const {
    Normals sum(kColumns);
    for (const Normals& block : blocks) sum.add(block, 1.0);
    return sum;
  }
};

}  // namespace

TEST_CASE("increment normals: the solution is that of least squares, whatever the size of a column") {
  const Data data{0.1};
  const Normals all = data.all();
  const Eigen::VectorXd plain = data.rows.colPivHouseholderQr().solve(data.y);
  const Eigen::VectorXd theta = all.solve();
  CHECK((theta - plain).norm() < kRidge * plain.norm());
  CHECK(all.square(theta) == doctest::Approx((data.y - data.rows * theta).squaredNorm()));
  CHECK(all.weight == kWindows);
}

TEST_CASE("increment normals: blocks are taken out again as they were put in") {
  const Data data{0.1};
  Normals rest = data.all();
  rest.add(data.blocks.front(), -1.0);
  Normals others(kColumns);
  for (std::size_t b = 1; b < data.blocks.size(); ++b) others.add(data.blocks[b], 1.0);
  CHECK((rest.full() - others.full()).norm() < 1e-9 * others.full().norm());
  CHECK((rest.solve() - others.solve()).norm() < 1e-6 * others.solve().norm());
}

TEST_CASE("increment normals: what no row shows stays at zero") {
  Normals none(2);
  Rows part{3, 2};
  part.col(0) << 1.0, 2.0, 3.0;
  part.col(1).setZero();
  none.add(part, {2.0, 4.0, 6.0}, 1.0);
  const Eigen::VectorXd theta = none.solve();
  CHECK(theta[0] == doctest::Approx(2.0));
  CHECK(theta[1] == 0.0);
}

TEST_CASE("increment normals: the noise is the misfit's mean square, more where blocks pull one way") {
  const Data data{0.1};
  const Eigen::VectorXd theta = data.all().solve();
  CHECK(noise_of(data.blocks, theta) == doctest::Approx(0.01).epsilon(0.6));  // eight blocks know it no better
  std::vector<Normals> pulled = data.blocks;
  for (std::size_t b = 0; b < pulled.size(); ++b) pulled[b].g[0] += b % 2 == 0 ? 60.0 : -60.0;
  CHECK(noise_of(pulled, theta) > 10.0 * noise_of(data.blocks, theta));
}

}  // namespace fathom::consistency
