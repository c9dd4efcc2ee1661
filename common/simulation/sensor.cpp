#include "common/simulation/sensor.hpp"

#include <cmath>

#include "common/base/config.hpp"

namespace fathom::simulation {

double probability(const Config& config, const std::string& key) {
  const double value = config.quantity(key, "");
  if (value < 0.0 || value > 1.0) config.fail(key, "'" + key + "' is a probability: 0 to 1");
  return value;
}

Timing::Timing(const Config& config, const std::string& name, std::uint64_t seed)
    : rate_{config.positive("rate", "Hz")},
      latency_{utime_after(0, config.not_negative("latency", "s"))},
      stream_{seed, name + ".timing"},
      jitters_{seed, name + ".jitter"} {
  if (config.has("jitter")) jitter_ = config.not_negative("jitter", "s");
  if (config.has("phase")) {
    phase_ = config.not_negative("phase", "s");
    if (phase_ * rate_ >= 1.0) config.fail("phase", "'phase' is below one period of 'rate'");
  }
  if (!config.has("drop_out")) return;
  drop_out_ = probability(config, "drop_out");
  drop_out_length_ = config.positive("drop_out_length", "s");
}

Utime Timing::taken(Utime start, std::int64_t count) const {
  return utime_after(start, phase_ + static_cast<double>(count) / rate_);
}

Utime Timing::latency() { return jitter_ > 0.0 ? latency_ + utime_after(0, jitters_.uniform(0.0, jitter_)) : latency_; }

bool Timing::works(Utime utime) {
  if (drop_out_ <= 0.0) return true;
  const bool begins = stream_.chance(drop_out_);
  const double length = -drop_out_length_ * std::log(1.0 - stream_.uniform());
  if (utime < silent_until_) return false;
  if (begins) silent_until_ = utime_after(utime, length);
  return !begins;
}

const std::vector<SensorKind>& sensor_kinds() {
  static const std::vector<SensorKind> kKinds{{kThrusterFeedback, make_thrusters},
                                              {"battery", make_battery},
                                              {"loads", make_loads},
                                              {"ahrs", make_ahrs},
                                              {"accelerometers", make_accelerometers},
                                              {"gyros", make_gyros},
                                              {"dvl", make_dvl},
                                              {"depth", make_depth},
                                              {"usbl", make_usbl},
                                              {"ranges", make_ranges},
                                              {"pose_capture", make_pose_capture},
                                              {"tag_pose", make_tag_pose, SensorKind::Pictures::kWithout},
                                              {"optical_flow", make_optical_flow, SensorKind::Pictures::kWithout},
                                              {"laser_range", make_laser_range, SensorKind::Pictures::kWithout},
                                              {"camera", make_camera, SensorKind::Pictures::kWith}};
  return kKinds;
}

}  // namespace fathom::simulation
