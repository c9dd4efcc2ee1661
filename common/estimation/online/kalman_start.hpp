// Where a Kalman filter begins: attitude from a heading and the accelerometers' vertical or from a measured attitude,
// position from a fix, from acoustic ranges, or from the settings.
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "common/estimation/online/kalman_settings.hpp"
#include "common/samples/sensors.hpp"
#include "common/samples/vision.hpp"

namespace fathom::estimation {

/// A sample of any instrument, not owned.
using SampleView = std::variant<const Ahrs*, const PoseCapture*, const Dvl*, const Depth*, const Usbl*, const Ranges*,
                                const TagPose*, const OpticalFlow*, const LaserRange*, const Signal*>;

struct KalmanStart {
  model::KinematicVector x{model::KinematicVector::Zero()};
  model::KinematicVector sigma{model::KinematicVector::Zero()};
};

/// Position from ranges (0 or less: not heard) and, where there is one, a depth; nothing from fewer than three
/// equations in three unknowns, or when they contradict each other by more than `tolerance` [m].
[[nodiscard]] std::optional<Eigen::Vector3d> locate(const std::vector<Transponder>& transponders,
                                                    const std::vector<double>& ranges, std::optional<double> depth,
                                                    double tolerance);

/// Which of the ranges contradicts the others, when leaving one out makes them agree within `tolerance` [m].
enum class Agreement { kAll, kAllButOne, kNone };
struct Verdict {
  Agreement agreement{Agreement::kAll};
  std::size_t odd{};  ///< the one that is left out
};
/// Ranges as above; `ranges` is used as scratch and restored. Too few of them to contradict each other agree;
/// of three and a depth nobody can say which one is odd.
[[nodiscard]] Verdict agree(const std::vector<Transponder>& transponders, std::vector<double>& ranges,
                            std::optional<double> depth, double tolerance);

class StartFinder {
 public:
  /// `awaited`: it is known that something will tell the position, however late.
  explicit StartFinder(const KalmanSettings& settings, bool awaited = false)
      : settings_{&settings}, awaited_{awaited} {}

  void hear(Utime utime, const SampleView& sample);
  /// The start, as soon as attitude and position are known; a position that nothing measures is taken to be zero after
  /// some seconds, unless there are transponders or it is awaited.
  [[nodiscard]] std::optional<KalmanStart> found() const;
  /// One line: what is missing.
  [[nodiscard]] std::string missing() const;

 private:
  void use(const Ahrs& sample);
  void use(const PoseCapture& sample);
  void use(const Dvl&) {}
  void use(const Depth& sample) { depth_ = sample.z; }
  void use(const Usbl& sample);
  void use(const Ranges& sample);
  void use(const TagPose& sample);
  void use(const OpticalFlow&) {}
  void use(const LaserRange&) {}
  void use(const Signal&) {}

  const KalmanSettings* settings_;
  bool awaited_;
  std::optional<Utime> first_;
  double elapsed_{};
  int ranges_heard_{};
  std::optional<double> heading_, depth_;
  std::optional<Eigen::Vector3d> up_, position_;
  std::optional<Eigen::Quaterniond> attitude_;
};

}  // namespace fathom::estimation
