// Instruments that fail: each kind, for as long as stated, and nobody else's bits.
#include "common/simulation/failure.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "test/support/dive_site.hpp"

using namespace fathom;
using namespace fathom::simulation;

namespace {

constexpr Utime kOrigin = 1'700'000'000'000'000;

std::vector<Depth> depths(const std::string& failure) {
  Setup setup{.seed = 4};
  if (!failure.empty()) setup.fail = {failure};
  auto simulator = test::make_simulator("seabotix_lbv150", "tank", setup);
  return test::run<Depth>(*simulator, 4.0);
}

}  // namespace

TEST_CASE("failure: silent, frozen, nan, late, and a clock that jumps, from one second to two") {
  const std::vector<Depth> well = depths("");
  REQUIRE(well.size() == 80);
  CHECK(depths("depth=silent,from:1,to:2").size() == 60);

  const std::vector<Depth> frozen = depths("depth=frozen,from:1,to:2");
  REQUIRE(frozen.size() == 80);
  for (std::size_t k = 0; k < 80; ++k) {
    CHECK(frozen[k].utime == well[k].utime);
    CHECK(frozen[k].z == (k >= 20 && k < 40 ? well[19].z : well[k].z));
  }
  const std::vector<Depth> spoilt = depths("depth=nan,from:1,to:2");
  for (std::size_t k = 0; k < 80; ++k) CHECK(std::isnan(spoilt[k].z) == (k >= 20 && k < 40));

  const std::vector<Depth> jumped = depths("depth=jump,by:-3,from:1,to:2");
  for (std::size_t k = 0; k < 80; ++k) {
    CHECK(jumped[k].utime == well[k].utime - (k >= 20 && k < 40 ? 3'000'000 : 0));
  }
  // One second of samples comes half a second later than the others: out of order, and all of them.
  const std::vector<Depth> late = depths("depth=delay,by:0.5,from:1,to:2");
  CHECK(late.size() == 80);
  CHECK_FALSE(std::is_sorted(late.begin(), late.end(), [](const auto& a, const auto& b) { return a.utime < b.utime; }));
  CHECK(late[20].utime == kOrigin + 1'000'000);  // nothing came in between
}

TEST_CASE("failure: what the thrusters tell of themselves fails too") {
  const auto told = [](const std::string& failure) {
    Setup setup{.seed = 4};
    if (!failure.empty()) setup.fail = {failure};
    auto simulator = test::make_simulator("seabotix_lbv150", "tank", setup);
    return test::run<Thrusters>(*simulator, 4.0);
  };
  const std::size_t all = told("").size();
  CHECK(all == 200);  // one an interval
  CHECK(told("thrusters=silent,from:1,to:2").size() == 150);
  CHECK(told("thrusters=delay,by:0.5,from:3.8").size() < all);
  CHECK(told("thrusters=jump,by:-3,from:1").back().utime == told("").back().utime - 3'000'000);
  CHECK(std::isnan(told("thrusters=nan").back().tau[0]));
}

TEST_CASE("failure: the others do not notice") {
  auto well = test::make_simulator("seabotix_lbv150", "deep", {.seed = 4});
  auto ill = test::make_simulator("seabotix_lbv150", "deep", {.seed = 4, .fail = {"ahrs=nan"}});
  const auto a = test::run<Dvl>(*well, 5.0), b = test::run<Dvl>(*ill, 5.0);
  REQUIRE(a.size() == b.size());
  for (std::size_t k = 0; k < a.size(); ++k) CHECK(a[k].v_WB_B == b[k].v_WB_B);
}

TEST_CASE("failure: what is not known is answered in one line") {
  const auto complaint = [](const std::string& text) {
    return test::complaint_of<InputError>([&] { static_cast<void>(Failure::parse(text)); });
  };
  CHECK(complaint("sonar=silent").find("no instrument 'sonar'") != std::string::npos);
  CHECK(complaint("ahrs").find("no '='") != std::string::npos);
  CHECK(complaint("ahrs=tired").find("'tired' is no failure") != std::string::npos);
  CHECK(complaint("ahrs=silent,from:soon").find("'soon' is no number") != std::string::npos);
  CHECK(complaint("ahrs=silent,from:2,to:1").find("ends before it begins") != std::string::npos);
  CHECK(complaint("ahrs=delay,by:-1").find("no sample comes before it is taken") != std::string::npos);
  CHECK(test::complaint_of<InputError>([] {
          static_cast<void>(test::make_simulator("seabotix_lbv150", "tank", {.fail = {"usbl=silent"}}));
        }).find("not carried at tank") != std::string::npos);
}
