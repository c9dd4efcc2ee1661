// Hypotheses: their order, how they combine, and how two readings are compared.
#include "common/consistency/conventions/reading.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "common/consistency/conventions/evidence.hpp"

namespace fathom::consistency {

TEST_CASE("readings: named conventions stand before turns, turns before reflections, and each changes something") {
  const auto& all = hypotheses();
  CHECK(std::ranges::is_sorted(all, {}, [](const Hypothesis& one) { return penalty(one.kind); }));
  CHECK(penalty(Kind::kNamed) < penalty(Kind::kTurn));
  CHECK(penalty(Kind::kTurn) < penalty(Kind::kReflection));
  for (const Hypothesis& one : all) {
    CAPTURE(one.words);
    Reading both;
    CHECK(compose({}, one.change, both));
    CHECK_FALSE(compose(one.change, one.change, both));  // one stream is read in one way
  }
}

TEST_CASE("readings: two causes combine where they concern two streams, and only there") {
  const Eigen::Matrix3d flip = Eigen::Vector3d(1, -1, -1).asDiagonal();
  const Reading world{.velocity_frame = estimation::VectorFrame::kWorld},
      conjugate{.quaternion = estimation::QuaternionForm::kInverse};
  Reading both;
  REQUIRE(compose(world, conjugate, both));
  CHECK(both.velocity_frame == estimation::VectorFrame::kWorld);
  CHECK(both.quaternion == estimation::QuaternionForm::kInverse);
  CHECK_FALSE(compose({.velocity = flip}, world, both));
  CHECK_FALSE(compose(world, {.velocity = flip}, both));
}

TEST_CASE("readings: Vuong's z by hand, smaller where neighbouring windows tell one story") {
  Judged none, better, slow;
  none.log_likelihood.assign(100, 0.0);
  for (int i = 0; i < 100; ++i) {
    better.log_likelihood.push_back(1.0 + (i % 2 == 0 ? 0.5 : -0.5));
    slow.log_likelihood.push_back(1.0 + ((i / 10) % 2 == 0 ? 0.5 : -0.5));
  }
  CHECK(compare(better, none).gain == doctest::Approx(100.0));
  CHECK(compare(slow, none).gain == doctest::Approx(100.0));
  // Independent windows: 100 over the root of 100 times a quarter is 20; stretches of ten alike tell far less.
  CHECK(compare(slow, none).z < 12.0);
  CHECK(compare(better, none).z > 20.0);
  CHECK(compare(none, better).z < -20.0);
  Judged keel_up = none;
  keel_up.upside_down = true;
  CHECK(compare(none, keel_up).gain > 10.0);
}

}  // namespace fathom::consistency
