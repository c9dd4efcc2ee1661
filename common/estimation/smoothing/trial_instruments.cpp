#include "common/estimation/smoothing/trial_instruments.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "common/base/spatial.hpp"
#include "common/base/statistics.hpp"
#include "common/estimation/online/estimator.hpp"
#include "common/estimation/online/navigator.hpp"
#include "common/estimation/smoothing/turned_package.hpp"
#include "common/estimation/wording.hpp"

namespace fathom::estimation {
namespace {

constexpr double kAttitudeMemory = 30.0;  // s: what an attitude sensor's own filter leaves, as `joint` states it
constexpr double kWander = 60.0;  // s: how long an attitude may be off the same way, where its mean over a trial counts
constexpr double kTurned = 0.01;  // rad, prior: what a package is turned by in a hull, about each axis
constexpr double kLeastBias = 1e-3;   // m/s, of a velocity log: makers state no less
constexpr std::size_t kFewest = 100;  // samples that a white noise is measured from
constexpr double kLeastForce = 1e-3;  // m/s^2 and rad/s: rounding of instruments
constexpr double kLeastRate = 1e-4;

model::Pose pose_of(const model::Mount& mount) { return {mount.p_BS, Eigen::Quaterniond{mount.R_BS}}; }

}  // namespace

void add_places(const TrialFiles& files, KalmanSettings& s) {
  if (files.mounts) {
    const model::Mounts& mounts = *files.mounts;
    if (s.cameras.empty()) {
      for (const model::CameraMount& one : mounts.cameras) s.cameras.push_back({one.name, pose_of(one.mount)});
    }
    if (mounts.ahrs && s.p_BI.isZero(0.0)) s.p_BI = mounts.ahrs->p_BS;
    if (mounts.ranges && s.p_BA.isZero(0.0)) s.p_BA = mounts.ranges->p_BS;
    if (s.singles.empty()) s.add_singles(mounts.singles);
  }
  if (files.site) {
    const model::Site& site = *files.site;
    if (s.tags.empty()) {
      for (const model::Tag& one : site.tags)
        s.tags.push_back({one.number(), {one.p_WT, Eigen::Quaterniond{one.R_WT}}});
    }
    if (s.transponders.empty()) {
      for (const model::Transponder& one : site.transponders) s.transponders.push_back({one.name, one.p_W});
    }
    if (!s.floor && std::isfinite(site.floor)) s.floor = site.floor;
    s.gravity = site.gravity;
    s.walls = {Eigen::Vector2d{site.south, site.west}, Eigen::Vector2d{site.north, site.east}};
  }
}

namespace {

void measure_white_noises(const std::vector<Ahrs>& stream, KalmanSettings& s) {
  std::vector<double> t, series;
  const auto noise = [&](const auto& has, const auto& value, double least) -> std::optional<double> {
    t.clear();
    series.clear();
    for (const Ahrs& one : stream) {
      if (!has(one) || (!t.empty() && seconds_between(stream.front().utime, one.utime) <= t.back())) continue;
      t.push_back(seconds_between(stream.front().utime, one.utime));
      series.push_back(value(one));
    }
    if (series.size() < kFewest) return std::nullopt;
    return std::max(white_noise_sigma(t, series), least);
  };
  for (int i = 0; i < 3; ++i) {
    const auto force = noise([](const Ahrs& one) { return one.has_specific_force; },
                             [i](const Ahrs& one) { return one.f_B[i]; }, kLeastForce);
    const auto rate = noise([](const Ahrs& one) { return one.has_rates; },
                            [i](const Ahrs& one) { return one.w_WB_B[i]; }, kLeastRate);
    if (force) s.accelerometer_noise[i] = *force;
    if (rate) s.gyro_noise[i] = *rate;
  }
}

// Those beside the package: each by itself, for no file states them. One that the recording lacks costs no state.
void measure_singles(const std::vector<Signal>& signals, KalmanSettings& s, std::vector<std::string>& unrecorded) {
  std::vector<model::SingleInertialMount> told;
  std::vector<std::optional<double>> noises;
  for (const SingleInertial& one : s.singles) {
    std::vector<double> t, series;
    for (const Signal& sample : signals) {
      if (sample.name != one.mount.signal) continue;
      const double at = seconds_between(signals.front().utime, sample.utime);
      if (!t.empty() && at <= t.back()) continue;
      t.push_back(at);
      series.push_back(sample.value);
    }
    if (series.empty()) {
      unrecorded.push_back(one.mount.signal);
      continue;
    }
    const bool force = one.mount.measures == model::SingleInertialMount::Measures::kForce;
    told.push_back(one.mount);
    noises.push_back(series.size() < kFewest
                         ? std::nullopt
                         : std::optional{std::max(white_noise_sigma(t, series), force ? kLeastForce : kLeastRate)});
  }
  s.singles.clear();
  s.add_singles(told);
  for (std::size_t i = 0; i < noises.size(); ++i) s.singles[i].noise = noises[i];
}

// The live filter's section: its cut-offs are of no use here; its noises, and what it says lasts, are.
void add_live(const NavigatorSettings& live, const std::vector<Ahrs>& stream, KalmanSettings& s, std::string& note) {
  s.gate = live.gate;
  const Eigen::Vector3d attitude_sigma = live.attitude_sigma();
  s.attitude_noise = attitude_sigma.x();
  s.heading_noise = attitude_sigma.z();
  s.attitude_memory = kAttitudeMemory;
  s.accelerometer_bias = live.bias_prior;
  s.tag_attitude = false;
  s.flow = live.flow.used;
  s.laser = live.laser.used;
  const auto noise = [](const AidSettings& aid, double& value) {
    if (aid.used && aid.noise > 0.0) value = aid.noise;
  };
  noise(live.flow, s.flow_noise);
  noise(live.laser, s.laser_noise);
  noise(live.dvl, s.velocity_noise);
  noise(live.usbl, s.usbl_noise);
  noise(live.depth, s.depth_noise);
  s.flow_scale = live.flow.scale;
  s.velocity_scale = live.dvl.scale;
  if (live.dvl.used) s.velocity_bias = std::max(live.dvl.systematic, kLeastBias);
  if (!live.tags.used) s.tags.clear();
  const double across = std::max(live.tags.systematic, live.usbl.systematic);
  const double down = live.depth.systematic > 0.0 ? live.depth.systematic : std::max(across, live.laser.systematic);
  s.lasting_position = {across, across, down};
  // Gyros and accelerometers are one rigid package: how it is turned in the hull the attitude beside them tells, which
  // the live filter believes; what that is off by all the time no motion tells.
  s.lasting_attitude.setConstant(live.attitude_noise);
  if (const auto package = turned_package(stream)) {
    const double t = seconds_between(stream.front().utime, stream.back().utime);
    const Eigen::Vector3d wandered = attitude_sigma * std::sqrt(std::min(1.0, 2.0 * kWander / t));
    const Eigen::Vector3d doubt2 = wandered.cwiseAbs2().array() + package->sigma * package->sigma;
    const Eigen::Vector3d share =  // of what is seen, by the prior
        kTurned * kTurned * (doubt2.array() + kTurned * kTurned).inverse();
    s.R_BI = quaternion_from_rotation_vector(share.cwiseProduct(package->turn)).toRotationMatrix();
    s.lasting_attitude = share.cwiseProduct(doubt2).cwiseSqrt();
    const Eigen::Vector3d mrad = 1e3 * share.cwiseProduct(package->turn), left = 1e3 * s.lasting_attitude;
    note = text(
        "gyros and accelerometers stand turned against the told attitude by %.1f %.1f %.1f mrad (+- %.1f %.1f %.1f): "
        "taken out",
        mrad.x(), mrad.y(), mrad.z(), left.x(), left.y(), left.z());
  }
  s.lasting_velocity.setConstant(std::max(live.flow.systematic, live.dvl.systematic));
  measure_white_noises(stream, s);
}

void add_recorded(const EstimatorSettings& recorded, KalmanSettings& s) {
  s.position_noise = recorded.position_noise;
  s.capture_attitude_noise = recorded.attitude_noise;
  s.velocity_noise = recorded.velocity_noise;
  s.depth_noise = recorded.depth_noise;
  s.gyro_noise.setConstant(recorded.rate_noise);
}

}  // namespace

void TrialFiles::add(const Config& file) {
  if (file.is_section("estimator")) estimator = file.section("estimator");
  if (file.is_section("identifier")) identifier = file.section("identifier");
  if (file.is_section("sensors")) mounts = model::Mounts::from(file.section("sensors"));
  if (file.has("site") && !file.is_section("site")) site = model::Site::from(file);
}

namespace {

/// What the newest process of a name told of its files.
void add_told(const Recording& recording, const std::string& process, TrialFiles& files) {
  const auto info = std::find_if(
      recording.process_info.rbegin(), recording.process_info.rend(),
      [&](const ProcessInfo& one) { return one.process == process || one.process == "fathom-" + process; });
  if (info == recording.process_info.rend()) return;
  std::istringstream text{info->config};
  std::string name, body;
  const auto take = [&] {
    if (!name.empty() && name.find(": not told") == std::string::npos)
      files.add(Config::parse(body, recording.name + ", PROCESS_INFO of the " + process + ", " + name));
    body.clear();
  };
  constexpr std::string_view kHead = "# file ";
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with(kHead)) {
      take();
      name = line.substr(kHead.size());
    } else {
      body += line + "\n";
    }
  }
  take();
}

}  // namespace

TrialFiles files_in(const Recording& recording) {
  TrialFiles files;
  add_told(recording, "estimator", files);
  if (!files.identifier) {
    TrialFiles others;
    add_told(recording, "identifier", others);
    files.identifier = others.identifier;
  }
  files.in_the_log = files.estimator || files.mounts || files.site;
  return files;
}

TrialInstruments instruments_of(const Recording& recording, const TrialFiles& files) {
  TrialInstruments result;
  KalmanSettings& s = result.settings;
  const std::string filter = !files.estimator                 ? "none"
                             : files.estimator->has("filter") ? files.estimator->text("filter")
                                                              : "recorded";
  if (filter == "ekf") {
    s = KalmanSettings::from(*files.estimator);
    files.estimator->finish();
    result.process_stated = files.estimator->has("process");
  } else if (filter == "recorded") {
    add_recorded(EstimatorSettings::from(*files.estimator), s);
  } else if (filter != "none" && filter != "complementary") {
    files.estimator->fail("filter", "'filter' must be recorded, complementary or ekf, not '" + filter + "'");
  }
  add_places(files, s);
  if (filter == "complementary") {
    add_live(NavigatorSettings::from(*files.estimator), recording.ahrs, s, result.note);
    result.noises_stated = true;
  }
  if (!s.singles.empty()) measure_singles(recording.signals, s, result.unrecorded);
  return result;
}

std::vector<std::string> unused_instruments(const Recording& recording, const KalmanSettings& s) {
  std::vector<std::string> lines;
  const auto say = [&](const char* channel, std::size_t count, const std::string& why) {
    lines.push_back(recording.name + ": " + channel + " are not used (" + std::to_string(count) + " of them): " + why);
  };
  const auto known = [](const auto& list, const auto& what, auto member) {
    return std::ranges::find(list, what, member) != list.end();
  };
  const auto without_camera = [&](const auto& stream) {
    return std::ranges::none_of(stream,
                                [&](const auto& one) { return known(s.cameras, one.camera, &KnownCamera::name); });
  };
  constexpr const char* kNoCamera = "where their camera sits is not known; name the vehicle file (--vehicle)";
  if (!recording.ranges.empty() && s.transponders.empty())
    say("RANGES", recording.ranges.size(),
        "no transponder's place is known; name the site file (--site) or state them");
  if (!recording.tag_pose.empty()) {
    if (s.tags.empty()) {
      say("TAG_POSE", recording.tag_pose.size(), "no tag's place is known; name the site file (--site)");
    } else if (without_camera(recording.tag_pose)) {
      say("TAG_POSE", recording.tag_pose.size(), kNoCamera);
    } else if (std::ranges::none_of(recording.tag_pose,
                                    [&](const auto& one) { return known(s.tags, one.tag, &KnownTag::number); })) {
      say("TAG_POSE", recording.tag_pose.size(), "the site has none of these tags");
    }
  }
  const auto of_floor = [&](const char* channel, const auto& stream, bool wanted) {
    if (stream.empty()) return;
    if (!wanted) {
      say(channel, stream.size(), "the pipeline does not use them");
    } else if (!s.floor) {
      say(channel, stream.size(), "the floor's depth is not known; name the site file (--site)");
    } else if (without_camera(stream)) {
      say(channel, stream.size(), kNoCamera);
    }
  };
  of_floor("OPTICAL_FLOW", recording.optical_flow, s.flow);
  of_floor("LASER_RANGE", recording.laser_range, s.laser);
  return lines;
}

}  // namespace fathom::estimation
