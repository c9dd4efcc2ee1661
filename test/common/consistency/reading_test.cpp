// An attitude that was misread is recognised, and read as it was meant.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>

#include "test/support/consistency.hpp"

namespace fathom {

using test::check;
using test::check_motion;
using test::find;
using test::print;
using test::SyntheticOptions;

TEST_CASE("attitude that was misread is recognised") {
  SUBCASE("inverse") {
    const SyntheticOptions options{
        .seed = 12, .duration = 120.0, .spoil_pose = [](PoseCapture& pose) { pose.q_WB = pose.q_WB.conjugate(); }};
    const auto checked = check(options);
    const auto& findings = checked.findings();
    print(findings);
    CHECK(find(findings, "pose_capture.attitude", "quaternion_inverse") != nullptr);
    check_motion(checked);
  }
  SUBCASE("scalar last") {
    const SyntheticOptions options{.seed = 13, .duration = 120.0, .spoil_pose = [](PoseCapture& pose) {
                                     pose.q_WB =
                                         Eigen::Quaterniond(pose.q_WB.x(), pose.q_WB.y(), pose.q_WB.z(), pose.q_WB.w());
                                   }};
    const auto checked = check(options);
    const auto& findings = checked.findings();
    print(findings);
    CHECK(find(findings, "pose_capture.attitude", "quaternion_order") != nullptr);
    check_motion(checked);
  }
  SUBCASE("heading offset, small and large") {
    for (const double offset : {0.06, 1.2, -2.5}) {
      const SyntheticOptions options{
          .seed = 14, .spoil_pose = [offset](PoseCapture& pose) {
            pose.q_WB = Eigen::Quaterniond(Eigen::AngleAxisd(offset, Eigen::Vector3d::UnitZ())) * pose.q_WB;
          }};
      const auto checked = check(options);
      const auto& findings = checked.findings();
      print(findings);
      const ConsistencyFinding* one = find(findings, "pose_capture.attitude", "heading_offset");
      REQUIRE(one != nullptr);
      CHECK(std::abs(one->size - offset) < 0.01);
      check_motion(checked);
    }
  }
}

}  // namespace fathom
