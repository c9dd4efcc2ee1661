// Optical flow against the tags of the same pictures: what the flow adds or hides is found, with its size; a flow that
// is right is not accused, nor is one accused for what moves the camera's view of both.
#include "common/consistency/flow_check.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "common/base/spatial.hpp"
#include "common/estimation/smoothing/state_as_measured.hpp"
#include "test/support/synthetic_pictures.hpp"
#include "test/support/timing.hpp"

using namespace fathom;
using namespace fathom::consistency;
using estimation::take_state_as_measured;

namespace {

struct Checked {
  test::Pictures pictures;
  std::vector<Recording> recordings;
  ConsistencyResult result;

  explicit Checked(const test::PictureOptions& options) : pictures{options}, recordings{pictures.recording} {
    take_state_as_measured(recordings.front());
    result.corrections.resize(1);
    check_flow(recordings, pictures.mounts, pictures.site, result);
  }
  [[nodiscard]] const ConsistencyFinding* finding(const std::string& signal, const std::string& what) const {
    const auto at = std::ranges::find_if(
        result.findings, [&](const ConsistencyFinding& one) { return one.signal == signal && one.finding == what; });
    return at == result.findings.end() ? nullptr : &*at;
  }
};

}  // namespace

TEST_CASE("flow check: a component that reads too small is found with its size, and what rests on it is corrected") {
  const Checked checked{{.seed = 4, .flow_factor = {1.0, 0.87}}};
  REQUIRE(checked.result.findings.size() == 1);
  const ConsistencyFinding* scale = checked.finding("optical_flow.v", "scale");
  REQUIRE(scale != nullptr);
  CHECK(scale->reference == "tag_pose");
  CHECK(std::abs(scale->size - 1.0 / 0.87) < 3.0 * scale->std);
  CHECK(scale->std < 0.01);
  const Corrections& corrections = checked.result.corrections.front();
  CHECK(corrections.dvl.scale.x() == 1.0);
  CHECK(corrections.dvl.scale.y() == doctest::Approx(1.0 / 0.87).epsilon(0.02));
}

TEST_CASE("flow check: the position is the tags' where STATE's is led astray") {
  const Eigen::Vector3d off{0.0, 0.05, 0.0};
  const auto error = [&](const Checked& checked) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    const test::SyntheticMotion motion{4};
    for (const PoseCapture& pose : checked.recordings.front().pose_capture) {
      sum += pose.p_WB - motion.p_WB(seconds_between(utime_after(0, 2.0), pose.utime));
    }
    return Eigen::Vector3d{sum / static_cast<double>(checked.recordings.front().pose_capture.size())};
  };
  // 2600 poses of some 4 mm: 1 mm is more than ten standard deviations of their mean.
  CHECK(error(Checked{{.seed = 4, .flow_factor = {1.0, 0.87}, .state_offset = off}}).norm() < 1e-3);
  CHECK((error(Checked{{.seed = 4, .state_offset = off}}) - off).norm() < 1e-3);  // nothing wrong: STATE stays
}

TEST_CASE("flow check: what the flow measured takes the place of what the estimator made of it") {
  const test::Pictures pictures{{.seed = 4}};
  const auto velocities = [&](double off) {
    std::vector<Recording> recordings{pictures.recording};
    for (StateEstimate& state : recordings.front().state) state.nu.x() += off;
    take_state_as_measured(recordings.front());
    ConsistencyResult result;
    result.corrections.resize(1);
    check_flow(recordings, pictures.mounts, pictures.site, result);
    return recordings.front().dvl;
  };
  const std::vector<Dvl> right = velocities(0.0), wrong = velocities(0.05);
  REQUIRE(right.size() > 100);
  REQUIRE(right.size() == wrong.size());
  CHECK(right.size() <= pictures.recording.optical_flow.size());
  for (std::size_t k = 0; k < right.size(); ++k)
    CHECK(std::abs(right[k].v_WB_B.x() - wrong[k].v_WB_B.x()) < 1e-3);  // m/s: STATE's share along a tilted lens
}

TEST_CASE("flow check: a flow that is late") {
  const Checked checked{{.seed = 5, .flow_delay = 0.1}};
  const ConsistencyFinding* delay = checked.finding("optical_flow", "delay");
  REQUIRE(delay != nullptr);
  CHECK(delay->size == doctest::Approx(0.1).epsilon(0.1));
  CHECK(checked.result.corrections.front().dvl_shift == doctest::Approx(-0.1).epsilon(0.1));
}

TEST_CASE("flow check: turning that is left in the flow is a lever arm, and is taken out of what the flow supplies") {
  const Eigen::Vector3d arm{-0.24, 0.27, 0.0};
  const Checked checked{{.seed = 7, .flow_arm = arm}};
  const ConsistencyFinding* x = checked.finding("optical_flow", "lever_arm_x");
  const ConsistencyFinding* y = checked.finding("optical_flow", "lever_arm_y");
  REQUIRE(x != nullptr);
  REQUIRE(y != nullptr);
  CHECK(std::abs(x->size - arm.x()) < 3.0 * x->std + 0.01);
  CHECK(std::abs(y->size - arm.y()) < 3.0 * y->std + 0.01);
  const Eigen::Matrix3d& coupling = checked.result.corrections.front().dvl.coupling;
  CHECK(coupling.topRows<2>().isApprox(skew(arm).topRows<2>(), 0.1));
  CHECK(coupling.row(2).isZero());  // no camera that looks down sees heave by flow
}

TEST_CASE("flow check: a gyro that is turned by a degree leaves turning in the flow, which is not the flow's fault") {
  for (unsigned seed = 1; seed <= test::seeds(4); ++seed) {
    CAPTURE(seed);
    CHECK(Checked{{.seed = seed, .gyro_turn = 0.0175}}.result.findings.empty());
  }
}

TEST_CASE("flow check: what is in order is not accused") {
  for (unsigned seed = 1; seed <= test::seeds(10); ++seed) {
    CAPTURE(seed);
    const Checked checked{{.seed = seed}};
    CHECK(checked.result.findings.empty());
    CHECK(checked.result.pairs.at("optical_flow").checked);
    CHECK(checked.result.corrections.front().dvl.scale == Eigen::Vector3d::Ones());
  }
}

TEST_CASE("flow check: a camera that repeats its last picture is no witness against the flow") {
  test::Pictures pictures{{.seed = 4}};
  std::vector<TagPose>& tags = pictures.recording.tag_pose;
  std::map<int, TagPose> last;
  for (std::size_t i = 0; i < tags.size(); ++i) {
    if (i < tags.size() / 3) {
      last[tags[i].tag] = tags[i];
    } else if (last.contains(tags[i].tag)) {
      tags[i].p_CT = last[tags[i].tag].p_CT;
    }
  }
  ConsistencyResult result;
  result.corrections.resize(1);
  check_flow(std::span(&pictures.recording, 1), pictures.mounts, pictures.site, result);
  CHECK(result.findings.empty());
}

TEST_CASE("flow check: unknown cameras, tags off the map and broken numbers are not heard") {
  test::Pictures pictures{{.seed = 4, .duration = 60.0, .flow_factor = {1.0, 0.87}}};
  for (TagPose& tag : pictures.recording.tag_pose) {
    if (tag.tag == 0) tag.tag = 99;
    if (tag.tag == 1) tag.camera = "bow";
  }
  pictures.recording.tag_pose[2].p_CT.x() = std::nan("");
  pictures.recording.optical_flow[9].flow_C.y() = std::nan("");
  ConsistencyResult result;
  result.corrections.resize(1);
  check_flow(std::span(&pictures.recording, 1), pictures.mounts, pictures.site, result);
  REQUIRE(result.findings.size() == 1);
  CHECK(result.findings.front().size == doctest::Approx(1.0 / 0.87).epsilon(0.02));
  for (OpticalFlow& flow : pictures.recording.optical_flow) flow.camera = "bow";
  ConsistencyResult none;
  none.corrections.resize(1);
  check_flow(std::span(&pictures.recording, 1), pictures.mounts, pictures.site, none);
  CHECK(none.pairs.empty());
}
