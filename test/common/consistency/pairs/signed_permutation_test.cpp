#include "common/consistency/pairs/signed_permutation.hpp"

#include <doctest/doctest.h>

#include <Eigen/LU>

namespace fathom::consistency {

TEST_CASE("signed permutation: there are 48, all different, half of them rotations") {
  const auto all = signed_permutations();
  REQUIRE(all.size() == 48);
  CHECK(all.front().isIdentity());
  int rotations = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    CHECK((all[i] * all[i].transpose()).isIdentity());
    CHECK(all[i].cwiseAbs().sum() == 3.0);
    rotations += all[i].determinant() > 0.0;
    for (std::size_t k = 0; k < i; ++k) CHECK(all[i] != all[k]);
  }
  CHECK(rotations == 24);
}

TEST_CASE("signed permutation: the nearest one follows the columns that were seen and leaves the others alone") {
  Eigen::Matrix3d M;
  M << 0.1, 0.9, 0.0,  //
      -1.1, 0.2, 0.1,  //
      0.0, 0.1, 3.0;
  Eigen::Matrix3d wanted;
  wanted << 0, 1, 0, -1, 0, 0, 0, 0, 1;
  CHECK(nearest_permutation(M, {true, true, true}) == wanted);
  CHECK(nearest_permutation(100.0 * M, {true, true, true}) == wanted);  // its size says nothing
  CHECK(nearest_permutation(M, {false, false, true}).isIdentity());
  CHECK(nearest_permutation(-M, {false, false, false}).isIdentity());
  // One column seen, with its sign turned: the other two need no turning.
  CHECK(nearest_permutation(-M, {false, false, true}) == Eigen::Matrix3d(Eigen::Vector3d(1, 1, -1).asDiagonal()));
}

}  // namespace fathom::consistency
