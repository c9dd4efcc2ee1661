#include "common/model/lens.hpp"

#include <doctest/doctest.h>

#include "common/base/config.hpp"
#include "common/base/error.hpp"

namespace fathom::model {
namespace {

Lens read(const std::string& text) { return Lens::from(Config::parse("width: 640\nheight: 480\n" + text, "lens")); }

}  // namespace

TEST_CASE("lens: a focal length alone is a lens without distortion, its axis through the middle") {
  const Lens lens = read("focal: 540");
  CHECK(lens.fx == 540.0);
  CHECK(lens.fy == 540.0);
  CHECK(lens.cx == 319.5);
  CHECK(lens.cy == 239.5);
  CHECK(lens.distortion == std::array<double, 5>{});
  CHECK_FALSE(lens.port);
}

TEST_CASE("lens: everything that a calibration states is read") {
  const Lens lens = read(
      "focal: 500 510\ncentre: 300 200\nlens: fisheye\ndistortion: 0.1 -0.02 0.003 0.004\n"
      "port: {distance: 10 mm, thickness: 5 mm, index_window: 1.5}");
  CHECK(lens.kind == Lens::Kind::kFisheye);
  CHECK(lens.fy == 510.0);
  CHECK(lens.cy == 200.0);
  CHECK(lens.distortion[3] == 0.004);
  REQUIRE(lens.port);
  CHECK(lens.port->thickness == 5e-3);
  CHECK(lens.port->index_window == 1.5);
  CHECK(lens.port->index_water == 1.333);
}

TEST_CASE("lens: what no lens can be is refused") {
  CHECK_THROWS_AS(read("focal: 0"), InputError);
  CHECK_THROWS_AS(read("focal: 1 2 3"), InputError);
  CHECK_THROWS_AS(read("focal: 500\ncentre: 3"), InputError);
  CHECK_THROWS_AS(read("focal: 500\nlens: telescope"), InputError);
  CHECK_THROWS_AS(read("focal: 500\nlens: fisheye\ndistortion: 1 2 3 4 5"), InputError);
  CHECK_THROWS_AS(read("focal: 500\nport: {distance: -1 mm, thickness: 5 mm}"), InputError);
  CHECK_THROWS_AS(read("focal: 500\nport: {distance: 1 mm, thickness: 5 mm, index_water: 0.5}"), InputError);
}

}  // namespace fathom::model
