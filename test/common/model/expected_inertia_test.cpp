// What a vehicle is expected to weigh with its water, and beside the paper's vehicle.
#include "common/model/priors/expected_inertia.hpp"

#include <doctest/doctest.h>

#include "test/support/virtual_dive.hpp"

using namespace fathom;

TEST_CASE("expected inertia: a stated prior counts, else one and a half times the dry mass") {
  const Vector6d brov = model::expected_inertia(test::vehicle_from_repository("bluerov2"));
  CHECK(brov.head<3>() == Eigen::Vector3d{17.0, 24.2, 26.1});
  CHECK(brov[5] == 0.28);
  const Vector6d beluga = model::expected_inertia(test::vehicle_from_repository("beluga"));  // 24 kg, no such prior
  CHECK(beluga[0] == doctest::Approx(36.0));
  model::Vehicle unknown;
  unknown.parameters = {"X_u"};
  unknown.priors = {{-3.0, 1.0}};
  CHECK(model::expected_inertia(unknown) == Vector6d::Zero());
  CHECK(model::inertia_beside_lbv150(unknown) == Vector6d::Ones());
}

TEST_CASE("expected inertia: beside the paper's vehicle the paper's own is one, a heavier one more") {
  CHECK(model::inertia_beside_lbv150(test::vehicle_from_repository("seabotix_lbv150")) == Vector6d::Ones());
  const Vector6d brov = model::inertia_beside_lbv150(test::vehicle_from_repository("bluerov2"));
  CHECK(brov[2] == doctest::Approx(26.1 / 10.898));
  CHECK(brov.tail<3>() == Eigen::Vector3d::Ones());
}
