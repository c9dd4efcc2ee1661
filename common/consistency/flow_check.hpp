// What a camera that looks at the floor says twice: the vehicle's way by the tags in its pictures, and its velocity by
// their optical flow. A flow that reads too small looks like a force to whoever trusts it.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/consistency/consistency.hpp"
#include "common/model/mounts.hpp"
#include "common/model/site.hpp"
#include "common/samples/recording.hpp"

namespace fathom::consistency {

/// What the comparison takes from STATE.
struct MotionAt {
  Utime utime{};
  Eigen::Vector3d p_WB;     ///< m
  Eigen::Quaterniond q_WB;  ///< unit
  Vector6d nu;              ///< m/s, rad/s
  bool valid{};
};
[[nodiscard]] MotionAt motion_of(const StateEstimate& state);

/// The two witnesses of one trial, as small as they can be kept. Attitude, height, rates and what the camera cannot
/// see are taken from STATE when they are compared.
class FlowWitnesses {
 public:
  /// Cameras that `mounts` does not know and tags that are not on the map are not heard.
  FlowWitnesses(const model::Mounts& mounts, const model::Site& site);

  void hear(const TagPose& tag);
  void hear(const OpticalFlow& flow);
  [[nodiscard]] const model::Site& site() const { return site_; }
  void forget_before(Utime utime);
  void clear();

  /// Motion capture made of tags, velocity log made of flow; between `begin` and `end`, where a valid state is near.
  /// `motion`: in the order of time.
  [[nodiscard]] Recording seen(const std::deque<MotionAt>& motion, Utime begin, Utime end) const;

 private:
  struct Picture {
    Utime utime{};
    Eigen::Vector3d sum_p_WT;  // of the tags seen
    Eigen::Vector3d sum_p_BT;
    double tags{};
  };
  struct Flow {
    Utime utime{};
    std::size_t camera{};
    Eigen::Vector3d flow_C;
  };
  [[nodiscard]] std::size_t camera(const std::string& name) const;

  std::vector<model::CameraMount> cameras_;
  model::Site site_;
  std::deque<Picture> pictures_;
  std::deque<Flow> flows_;
  std::map<std::pair<std::size_t, int>, Eigen::Vector3d> last_;  // by camera and tag
};

/// `seen`: one per trial. Signs, scales and delay of optical_flow.u and .v against tag_pose, and turning that is left
/// in the flow as by a lever arm; of the rest the flow says nothing.
[[nodiscard]] PairResult compare_flow(std::span<const Recording> seen, const model::Site& site);

/// Compares flow and tags of logs with STATE; adds to `result`. Where STATE stands for the velocity log
/// (take_state_as_measured) the flow's own velocity does from now on; where it is wrong, it is corrected, and the tags'
/// own position is taken.
void check_flow(std::span<Recording> recordings, const model::Mounts& mounts, const model::Site& site,
                ConsistencyResult& result);

}  // namespace fathom::consistency
