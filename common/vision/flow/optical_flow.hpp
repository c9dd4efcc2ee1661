// Motion of the scene between two pictures: tracked features, the camera's rotation taken out, a plane fitted robustly.
// With tau = t / z_C, the camera's shift in units of its distance to the plane along its axis, and s the inverse depth
// along a feature's ray in the same units, features move by d = s (-tau_xy + y tau_z) to y, exactly (K-053 corrected).
#pragma once

#include <Eigen/Core>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "common/base/time.hpp"
#include "common/vision/projection.hpp"

namespace fathom::vision {

struct FlowSettings {
  double reduction{2.0};  ///< features are tracked in pictures so many times smaller
  int most_tracks{200};
  int least_tracks{10};          ///< fewer that agree say nothing
  double least_share{0.5};       ///< of the tracks that must agree
  double there_and_back{0.6};    ///< px of the reduced picture by which a track may miss its beginning on the way back
  double longest_interval{0.5};  ///< s
  double rotation_sigma{2e-3};   ///< rad/s, error of a sensor's rotation, which is taken out
};

enum class FlowState { kNone, kValid, kFirst, kPause, kNoTexture, kLost, kDisagree, kNoDetail, kNoRotation };
[[nodiscard]] const char* name(FlowState state);

/// A feature in two pictures [px].
struct Track {
  Eigen::Vector2d from, to;
  bool agrees{false};
};

struct Flow {
  FlowState state{FlowState::kNone};
  Utime utime{};      ///< middle between the pictures
  double interval{};  ///< s
  /// v_C / z_C [1/s]: camera's velocity in C, over its distance to the floor along its axis; both in the middle. The
  /// third one is the picture's divergence. Flow as the messages have it is minus that.
  Eigen::Vector3d rate{Eigen::Vector3d::Zero()};
  Eigen::Matrix3d covariance{Eigen::Matrix3d::Zero()};
  int n_tracks{}, n_agreed{};
  double residual{};  ///< px, spread of those that agree
  /// What lies on the floor, from the picture before to this one, in normalized coordinates: x_1 ~ floor_10 x_0; and
  /// the distance to it along its normal, over that of the picture before. Of a valid flow.
  Eigen::Matrix3d floor_10{Eigen::Matrix3d::Identity()};
  double nearing{1.0};
  double middle_distance{1.0};  ///< z_C in the middle over z_C at this picture; of a valid flow
};

class FlowTracker {
 public:
  FlowTracker(const model::Lens& lens, const FlowSettings& settings);
  ~FlowTracker();
  FlowTracker(FlowTracker&&) noexcept;
  FlowTracker& operator=(FlowTracker&&) noexcept;

  /// `R_01`: axes of this picture's camera in those of the one before; without it there is no valid flow.
  /// `normal_C`: the floor's normal in this picture's camera, unit, either sense; left out: the optical axis.
  /// `rotation_covariance`: of R_01 [rad^2, axes of the camera before]; left out: of a sensor's.
  Flow step(Utime utime, const cv::Mat& grey, const std::optional<Eigen::Matrix3d>& R_01,
            const std::optional<Eigen::Vector3d>& normal_C,
            const std::optional<Eigen::Matrix3d>& rotation_covariance = std::nullopt);
  /// Nothing within `reach` [px] of this line is a feature: a beam's dot there goes its own way, and outshines the
  /// floor.
  void leave_out(const std::vector<Eigen::Vector2d>& line, double reach);
  /// Of the last step.
  [[nodiscard]] const std::vector<Track>& tracks() const;
  void reset();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fathom::vision
