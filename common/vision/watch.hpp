// The front end as a process uses it: compressed pictures and attitudes in, and a line for the operator when pictures
// cannot be read. A bad picture costs itself alone.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "common/model/mounts.hpp"
#include "common/samples/sensors.hpp"
#include "common/vision/attitude_history.hpp"
#include "common/vision/front_end.hpp"
#include "common/vision/stamp_scatter.hpp"

namespace fathom::vision {

class Watch {
 public:
  Watch(const model::Site& site, const model::CameraMount& camera, const std::optional<model::LaserMount>& laser,
        FrontEndSettings settings);

  void hear(const Ahrs& sample) { attitudes_.hear(sample); }
  /// False when the picture cannot be decoded. What it told: front_end().
  bool see(const Camera& sample);
  void reset();

  [[nodiscard]] const FrontEnd& front_end() const { return front_end_; }
  /// The last picture with everything drawn in, compressed; nothing when it could not be read.
  [[nodiscard]] std::optional<Camera> drawing(int quality) const;
  /// Why nothing can be measured now; empty when all is well.
  [[nodiscard]] const std::string& complaint() const { return complaint_; }
  /// Pictures, tags by verdict, flows, dots: for HEALTH.
  [[nodiscard]] std::string counts() const;

 private:
  void count();
  void judge_stamps();

  model::CameraMount camera_;
  std::string map_complaint_, scatter_complaint_;
  FrontEnd front_end_;
  AttitudeHistory attitudes_;
  StampScatter scatter_;
  Picture picture_;
  bool readable_{false};
  Utime last_{}, tracked_{};  ///< of the last picture that came, and that was read
  std::string complaint_;
  std::map<std::string, std::int64_t> counts_;
};

}  // namespace fathom::vision
