// The factor between position and velocity log is laid on one of them, never on both, and the finding names the other.
#include "common/consistency/either_scale.hpp"

#include <doctest/doctest.h>

using namespace fathom;

TEST_CASE(
    "either scale: laid on the velocity log the position is as it was logged, and nothing is lost of the factor") {
  consistency::ConsistencyResult result;
  result.corrections.resize(2);
  for (auto& one : result.corrections) one.position_scale = 1.0 / 1.25;
  result.findings = {{.run = "all",
                      .signal = "pose_capture.position",
                      .reference = "dvl",
                      .finding = "scale",
                      .size = 1.25,
                      .evidence = "differ",
                      .action = "corrected: the position is divided by the size",
                      .or_else = "dvl"}};
  result.either_scale = 1.25;
  consistency::put_scale_on_velocity_log(result);
  for (const auto& one : result.corrections) {
    CHECK(one.position_scale == doctest::Approx(1.0));
    CHECK((one.dvl.scale.array() - 1.25).abs().maxCoeff() < 1e-12);
  }
  CHECK(result.findings[0].signal == "dvl");
  CHECK(result.findings[0].reference == "pose_capture.position");
  CHECK(result.findings[0].action.find("velocity log is multiplied") != std::string::npos);
  consistency::say_of_scale(result, "why");
  CHECK(result.findings[0].evidence == "differ; why");
}

TEST_CASE("either scale: without such a factor nothing changes") {
  consistency::ConsistencyResult result;
  result.corrections.resize(1);
  consistency::put_scale_on_velocity_log(result);
  CHECK(result.corrections[0].position_scale == 1.0);
}
