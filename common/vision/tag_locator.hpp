// The camera's pose from all tags of the map that it sees, and which of them are true: a tag is believed when its place
// in the picture agrees with the others', or, alone, when it is clear enough and fits what was known just before.
#pragma once

#include <optional>
#include <vector>

#include "common/base/time.hpp"
#include "common/model/site.hpp"
#include "common/vision/camera_pose.hpp"
#include "common/vision/tag_detector.hpp"

namespace fathom::vision {

struct LocatorSettings {
  double corner_sigma{0.3};     ///< px, of a corner along each axis
  double gate{4.0};             ///< standard deviations (corner and map together) beyond which a tag is refused
  double memory{0.5};           ///< s for which an earlier pose says something about a new one
  double largest_speed{2.0};    ///< m/s of the camera
  double attitude_sigma{0.05};  ///< rad, of a tilt that comes from outside: sensor, mounting, level of the map
};

struct CameraFix {
  Pose pose;
  Matrix6d covariance{Matrix6d::Zero()};  ///< of a shift [m, in W] and a turn [rad, in C]
  double rms{};                           ///< px, over all accepted corners
  int n_tags{};
  /// A plane seen from afar has two poses that explain the corners alike, and nothing says which: `pose` is the one
  /// with the smaller error, `other` the second one.
  bool ambiguous{false};
  std::optional<Pose> other;
};

class TagLocator {
 public:
  /// Without a lens, tags are judged by map and margin alone and there is no pose.
  TagLocator(const model::Site& site, const std::optional<model::Lens>& lens, const LocatorSettings& settings);

  /// Judges the tags of a picture (verdict, reprojection) and tells the camera's pose. `down_C`: direction of gravity
  /// in C, where an attitude sensor tells it.
  std::optional<CameraFix> step(Utime utime, std::vector<TagSighting>& tags,
                                const std::optional<Eigen::Vector3d>& down_C);
  void reset();
  struct Expected {
    model::TagName name;
    std::array<Eigen::Vector2d, 4> corners;  ///< px
  };
  /// Where tags of the map that are not among `seen` must be in the picture, whole.
  [[nodiscard]] std::vector<Expected> missing(const CameraFix& fix, const std::vector<TagSighting>& seen) const;
  /// Place of a tag of the map in the camera: X_CT.
  [[nodiscard]] std::pair<Eigen::Vector3d, Eigen::Matrix3d> in_camera(const CameraFix& fix, int number) const;
  [[nodiscard]] const std::optional<Projection>& projection() const { return projection_; }

 private:
  struct Candidate {
    TagSighting* tag{};
    std::vector<Correspondence> corners;  ///< the sound ones
    Eigen::Vector3d normal;               ///< of its plane, in W
    bool clear{false};                    ///< its margin would do alone
    bool agrees{false};
    double error{};  ///< px
  };
  struct Consensus {
    FittedPose fitted;
    std::vector<bool> agrees;
    int n{};
    double margin{};
  };

  void judge_by_map(std::vector<TagSighting>& tags);
  [[nodiscard]] double error(const Candidate& candidate, const Pose& pose) const;
  [[nodiscard]] double gate(const Candidate& candidate, const Pose& pose) const;
  void choose(double limit, Consensus& consensus) const;
  [[nodiscard]] std::optional<Consensus> grow(const Pose& seed) const;
  [[nodiscard]] std::optional<Consensus> best_consensus(Utime utime) const;
  [[nodiscard]] std::vector<Correspondence> corners_of(const std::vector<bool>& chosen) const;
  [[nodiscard]] bool alone_is_plausible(Utime utime, const Pose& pose, const std::optional<Eigen::Vector3d>& down_C);
  void look_for_second(Utime utime, const std::vector<Correspondence>& points, const Eigen::Vector3d& normal,
                       const std::optional<Eigen::Vector3d>& down_C, FittedPose& fitted, CameraFix& fix) const;
  [[nodiscard]] Matrix6d covariance(const FittedPose& fitted, std::size_t n_points, int n_tags) const;
  [[nodiscard]] bool recent(Utime utime) const;
  [[nodiscard]] double since_last(const Pose& pose) const;  ///< m; when there is a last one

  model::Site site_;
  std::optional<Projection> projection_;
  bool folds_{false};  ///< somewhere in the picture
  LocatorSettings settings_;
  std::vector<Candidate> candidates_;
  std::optional<Pose> last_;
  Utime last_utime_{};
  int implausible_{};  ///< in a row
};

}  // namespace fathom::vision
