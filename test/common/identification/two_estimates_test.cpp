// An estimate that knows more replaces another where it lies within its chance; ends of intervals follow, flat ones
// stay.
#include "common/identification/two_estimates.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::identification;

namespace {

constexpr double kSigma = 0.1;  // of every number, of the first estimate

struct Fixture {
  model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  FitResult first, second;
  Eigen::Index last{};  ///< place of the onset

  Fixture() {
    first.model = model::nominal_model(vehicle, false);
    first.model.add(test::active("thruster_failure", {0.5, 85.0}));
    const auto n = static_cast<Eigen::Index>(ParameterMap{first.model}.size());
    last = n - 1;
    first.covariance = kSigma * kSigma * Eigen::MatrixXd::Identity(n, n);
    first.freedom = 20.0;
    first.interval95.assign(static_cast<std::size_t>(n), std::nullopt);
    second = first;
    second.covariance *= 0.25;
  }
};

}  // namespace

TEST_CASE("two estimates: three standard deviations of one number of many agree, ten do not") {
  Fixture fixture;
  model::Model other = fixture.first.model;
  CHECK(agree(fixture.first, other));
  other.theta[model::index(model::BaseParameter::X_u)] += 3.0 * kSigma;
  CHECK(agree(fixture.first, other));
  other.theta[model::index(model::BaseParameter::X_u)] += 7.0 * kSigma;
  CHECK_FALSE(agree(fixture.first, other));
}

TEST_CASE("two estimates: an end follows the deviation, and stays where the cost is flat") {
  Fixture fixture;
  const double half = fixture.first.t95() * kSigma;
  fixture.first.interval95[static_cast<std::size_t>(fixture.last)] = {85.0 - half, 99.0};
  fixture.second.model.effects[0].theta[1] = 85.05;
  const auto ends = drawn_in(fixture.first, fixture.second);
  CHECK_FALSE(ends[0]);
  REQUIRE(ends.back());
  CHECK((*ends.back())[0] == doctest::Approx(85.05 - 0.5 * half).epsilon(1e-9));
  CHECK((*ends.back())[1] == 99.0);
}
