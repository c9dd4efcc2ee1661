// Evidence and choice of a reading on motions that are known exactly.
#include "common/consistency/conventions/selection.hpp"

#include <doctest/doctest.h>

#include "test/support/synthetic_recording.hpp"

namespace fathom::consistency {
namespace {

constexpr double kStep = 0.05;    // s
constexpr double kLength = 90.0;  // s
constexpr double kExact = 1e-3;   // of the variance: what the trapezoidal rule leaves

/// Streams without noise.
struct Streams {
  estimation::PoseSeries pose;
  estimation::Series velocity, rates, force, depth;

  explicit Streams(unsigned seed) {
    const test::SyntheticMotion motion{seed};
    pose.has_position = pose.has_attitude = true;
    for (double t = 0.0; t < kLength; t += kStep) {
      pose.t.push_back(t);
      pose.p_WB.push_back(motion.p_WB(t));
      pose.q_WB.emplace_back(motion.R_WB(t));
      pose.valid.push_back(1);
      for (auto* series : {&velocity, &rates, &force}) series->t.push_back(t);
      velocity.x.push_back(motion.v_B(t));
      rates.x.push_back(motion.w_B(t));
      force.x.push_back(motion.f_B(t));
    }
  }
  [[nodiscard]] Evidence evidence() const { return {pose, velocity, rates, force, depth}; }
};

}  // namespace

TEST_CASE("evidence: as read explains a right recording, each wrong reading leaves its own relation unexplained") {
  const Streams streams{1};
  const Evidence evidence = streams.evidence();
  REQUIRE(evidence.speaks());
  const Judged right = evidence.judge({});
  for (const Relation relation : {kTravel, kTurning}) {
    REQUIRE(right.seen[relation]);
    CHECK(right.unexplained[relation] < kExact);
  }
  CHECK(right.seen[kGravity]);
  CHECK_FALSE(right.seen[kDepth]);
  CHECK_FALSE(right.upside_down);
  const Judged world = evidence.judge({.velocity_frame = estimation::VectorFrame::kWorld});
  CHECK(world.unexplained[kTravel] > 0.2);
  CHECK(world.unexplained[kTurning] == doctest::Approx(right.unexplained[kTurning]));
  const Eigen::Matrix3d flip = Eigen::Vector3d(1, -1, -1).asDiagonal();
  const Judged turned = evidence.judge({.rates = flip});
  CHECK(turned.unexplained[kTurning] > 0.2);
  CHECK(turned.unexplained[kTravel] == doctest::Approx(right.unexplained[kTravel]));
  CHECK(evidence.judge({.attitude_axes = flip}).upside_down);
  CHECK(compare(right, world).gain > 100.0);
}

TEST_CASE("evidence: a heading that was left free comes back as the angle by which it was turned") {
  Streams streams{2};
  const double angle = 0.6;  // rad
  for (Eigen::Quaterniond& q : streams.pose.q_WB) q = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()) * q;
  const Judged judged = streams.evidence().judge({.free_heading = true});
  CHECK(judged.heading == doctest::Approx(-angle).epsilon(0.01));
  CHECK(judged.unexplained[kTravel] < kExact);
}

TEST_CASE("evidence: too little says nothing") {
  Streams streams{3};
  streams.velocity = streams.rates = streams.force = {};
  CHECK_FALSE(streams.evidence().speaks());
  CHECK(select_reading(streams.evidence()).causes.empty());
}

TEST_CASE("selection: nothing is altered in a right recording, and one slip has one cause with its name") {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    CAPTURE(seed);
    const Streams right{seed};
    CHECK(select_reading(right.evidence()).causes.empty());

    Streams world{seed};
    for (std::size_t i = 0; i < world.velocity.size(); ++i)
      world.velocity.x[i] = world.pose.q_WB[i] * world.velocity.x[i];
    const Selection along = select_reading(world.evidence());
    REQUIRE(along.causes.size() == 1);
    CHECK(along.causes[0].hypothesis->finding == "in_world_axes");
    CHECK(along.causes[0].hypothesis->signal == "dvl");
    CHECK(along.reading.velocity_frame == estimation::VectorFrame::kWorld);
    CHECK(along.causes[0].after[kTravel] < kExact);

    Streams inverse{seed};
    for (Eigen::Quaterniond& q : inverse.pose.q_WB) q = q.conjugate();
    const Selection conjugate = select_reading(inverse.evidence());
    REQUIRE(conjugate.causes.size() == 1);
    CHECK(conjugate.causes[0].hypothesis->finding == "quaternion_inverse");
  }
}

TEST_CASE("selection: two slips are two causes") {
  Streams both{4};
  const Eigen::Matrix3d enu = (Eigen::Matrix3d() << 0, 1, 0, 1, 0, 0, 0, 0, -1).finished();
  for (std::size_t i = 0; i < both.velocity.size(); ++i) {
    both.pose.q_WB[i] = both.pose.q_WB[i].conjugate();
    both.pose.p_WB[i] = enu * both.pose.p_WB[i];
  }
  const Selection selection = select_reading(both.evidence());
  REQUIRE(selection.causes.size() == 2);
  CHECK(selection.reading.quaternion == estimation::QuaternionForm::kInverse);
  CHECK(selection.reading.position == enu);
}

}  // namespace fathom::consistency
