// All that is read from a camera's pictures: tags and the camera's pose, flow and velocity, the laser's dot and range.
#pragma once

#include <optional>
#include <vector>

#include "common/samples/vision.hpp"
#include "common/vision/flow/optical_flow.hpp"
#include "common/vision/laser/beam_witness.hpp"
#include "common/vision/laser/laser_dot.hpp"
#include "common/vision/picture_check.hpp"
#include "common/vision/tag_detector.hpp"
#include "common/vision/tag_locator.hpp"

namespace fathom {
class Config;
}

namespace fathom::vision {

struct FrontEndSettings {
  DetectorSettings detector;
  LocatorSettings locator;
  FlowSettings flow;
  LaserSettings laser;
  double range_memory{0.5};  ///< s for which a distance to the floor is good

  /// Section `vision` of a pipeline: sections `tags`, `flow`, `laser`, all keys optional.
  [[nodiscard]] static FrontEndSettings from(const Config& config);
};

/// One picture. `bgr` may be empty: then there is no laser.
struct Picture {
  Utime utime{};
  cv::Mat grey, bgr;
  bool halved_colour{false};  ///< colour came with half the resolution of `grey`
  double stamp_sigma{};       ///< s, error of `utime`, for each picture its own
};

/// Everything that one picture told.
struct Sight {
  PictureState picture{PictureState::kGood};
  std::vector<TagSighting> tags;
  std::optional<CameraFix> fix;
  Flow flow;
  std::optional<LaserDot> laser;  ///< nothing without a laser
  std::optional<double> range;    ///< m, along the axis to the floor: from the laser, else from the tags
  double range_sigma{};           ///< m
  /// m/s, of the camera in C, in the middle of the two pictures; needs flow and range.
  std::optional<Eigen::Vector3d> v_C;
  Eigen::Matrix3d v_covariance{Eigen::Matrix3d::Zero()};
};

class FrontEnd {
 public:
  /// Without a lens there are detections alone. The floor is that of the site, or the plane of its tags. InputError for
  /// a map with tags that their family does not have.
  FrontEnd(const model::Site& site, const std::optional<model::Lens>& lens,
           const std::optional<model::LaserMount>& laser, const FrontEndSettings& settings);

  /// `R_WC`: the camera's attitude from a sensor; left out, tags stand in where both pictures have some. `gyro_R_01`:
  /// its axes in those of the picture before, from a gyro; left out: the difference of two attitudes.
  const Sight& step(const Picture& picture, const std::optional<Eigen::Matrix3d>& R_WC,
                    const std::optional<Eigen::Matrix3d>& gyro_R_01 = std::nullopt);
  /// There was a picture that could not be read: nothing is told of it.
  void skip() { sight_ = {}; }
  void reset();

  /// As messages have them; flow and laser only when valid, tags only when accepted and their pose is no guess.
  [[nodiscard]] std::vector<TagPose> tag_poses(const std::string& camera) const;
  [[nodiscard]] std::optional<OpticalFlow> optical_flow(const std::string& camera) const;
  [[nodiscard]] std::optional<LaserRange> laser_range(const std::string& camera) const;
  [[nodiscard]] const Sight& sight() const { return sight_; }
  [[nodiscard]] const std::vector<Track>& tracks() const;
  [[nodiscard]] const std::optional<model::Lens>& lens() const { return lens_; }
  [[nodiscard]] const LaserFinder* laser() const { return laser_ ? &*laser_ : nullptr; }

 private:
  [[nodiscard]] bool look_again(const cv::Mat& grey);
  void find_dot(const Picture& picture, const std::optional<Eigen::Vector3d>& normal_C);
  [[nodiscard]] Eigen::Matrix3d sensor_turn_covariance(const Picture& picture, const Eigen::Matrix3d& turn) const;
  void find_range(const std::optional<Eigen::Vector3d>& normal_C);

  model::Site site_;
  std::optional<model::Lens> lens_;
  FrontEndSettings settings_;
  TagDetector detector_;
  std::optional<TagDetector> near_detector_;  ///< at full resolution, for regions alone
  TagLocator locator_;
  TagLocator loose_locator_;  ///< for pictures that the lens does not fit: verdicts without a pose
  std::optional<FlowTracker> tracker_;
  std::optional<LaserFinder> laser_;
  std::optional<BeamWitness> witness_;  ///< beside the laser
  std::vector<LaserFinder::Outline> paper_;
  PictureCheck check_;
  std::optional<Eigen::Matrix3d> attitude_before_;  ///< R_WC of the picture before
  std::optional<CameraFix> fix_before_;             ///< of the picture before, when its pose is no guess
  double floor_{};
  Utime utime_{}, tracked_{};  ///< of the last picture, and of the last that flow has seen
  std::optional<Utime> range_utime_;
  double last_range_{}, last_range_sigma_{};
  Sight sight_;
};

}  // namespace fathom::vision
