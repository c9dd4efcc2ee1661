// estimator: what the sensors say in, STATE out. The section's `filter` chooses between the trial's complementary
// filter, the one for recordings with motion capture, and a Kalman filter.
#include <cctype>
#include <cmath>
#include <fathom_lcm/ahrs_t.hpp>
#include <fathom_lcm/depth_t.hpp>
#include <fathom_lcm/dvl_t.hpp>
#include <fathom_lcm/laser_range_t.hpp>
#include <fathom_lcm/optical_flow_t.hpp>
#include <fathom_lcm/pose_capture_t.hpp>
#include <fathom_lcm/ranges_t.hpp>
#include <fathom_lcm/signal_t.hpp>
#include <fathom_lcm/state_t.hpp>
#include <fathom_lcm/tag_pose_t.hpp>
#include <fathom_lcm/usbl_t.hpp>
#include <optional>
#include <string>

#include "common/base/config.hpp"
#include "common/estimation/corrections_file.hpp"
#include "common/estimation/online/estimator.hpp"
#include "common/estimation/online/kalman_estimator.hpp"
#include "common/estimation/online/navigator.hpp"
#include "common/estimation/smoothing/trial_instruments.hpp"
#include "common/model/site.hpp"
#include "common/model/vehicle.hpp"
#include "common/runtime/process.hpp"
#include "common/wire/channels.hpp"
#include "common/wire/decode.hpp"
#include "common/wire/minds.hpp"
#include "common/wire/sensors.hpp"

using namespace fathom;

namespace {

template <class Message, class Mind>
void hear(runtime::Process& process, Mind& mind, const std::string& channel) {
  process.on<Message>(channel, wire::kDecode, [&process, &mind](const auto& sample) {
    for (const StateEstimate& state : mind.step(sample)) process.publish(wire::kState, wire::encode(state));
  });
}

/// A trial's filter, and what it complains of: said as soon as it changes, for a trial in lockstep may be over before
/// HEALTH comes again.
struct Trial {
  static constexpr double kEvery = 0.5;  // s of the messages
  runtime::Process& process;
  estimation::Navigator& navigator;
  std::optional<Utime> looked{};
  std::optional<std::string> told{};

  void look(Utime now) {
    if (looked && std::abs(seconds_between(*looked, now)) < kEvery) return;
    looked = now;
    std::string complaint = navigator.complaint();
    if (complaint.empty()) complaint = navigator.remark();
    std::string kind = complaint;
    std::erase_if(kind, [](unsigned char c) { return std::isdigit(c) != 0; });
    if (told == kind) return;
    const bool was_well = told && told->empty();
    told = kind;
    if (was_well) process.log_warning(complaint);
    process.tell_health();
  }
};

void hear_ahrs(Trial& trial) {
  trial.process.on<fathom_lcm::ahrs_t>(wire::kAhrs, wire::kDecode, [&trial](const Ahrs& sample) {
    for (const StateEstimate& state : trial.navigator.step(sample))
      trial.process.publish(wire::kState, wire::encode(state));
    trial.look(sample.utime);
  });
}

/// An instrument beside the one whose clock is STATE's: should its own jump, it is late, and nothing starts over.
template <class Message>
void hear_aid(Trial& trial, const std::string& channel) {
  trial.process.listens_to<Message>(channel, [&trial, channel](const Message& message) {
    const auto sample = wire::decode(message);
    if (!sample) return trial.process.reject(channel);
    trial.navigator.step(*sample);
    trial.look(sample->utime);
  });
}

/// A channel that the chosen filter has no use for. It is heard all the same: what a process hears shall not depend on
/// its configuration.
template <class Message>
void ignore(runtime::Process& process, const std::string& channel) {
  process.on<Message>(channel, wire::kDecode, [](const auto& /*sample*/) {});
}

/// A column has whosever clock: should it jump, nothing starts over.
template <class Use>
void hear_columns(runtime::Process& process, Use use) {
  process.listens_to<fathom_lcm::signal_t>(wire::kSignal, [&process, use](const fathom_lcm::signal_t& message) {
    const auto sample = wire::decode(message);
    if (!sample) return process.reject(wire::kSignal);
    use(*sample);
  });
}

void tell_refused(runtime::Process& process, const std::map<std::string, std::int64_t>& rejected) {
  for (const auto& [reason, count] : rejected) {
    process.log_info(std::to_string(count) + " samples not used: " + reason);
  }
}

void run_recorded(runtime::Process& process, const Config& config) {
  estimation::Estimator estimator{estimation::EstimatorSettings::from(config),
                                  estimation::load_corrections(process.config_path("corrections"))};
  hear<fathom_lcm::pose_capture_t>(process, estimator, wire::kPoseCapture);
  hear<fathom_lcm::ahrs_t>(process, estimator, wire::kAhrs);
  hear<fathom_lcm::dvl_t>(process, estimator, wire::kDvl);
  hear<fathom_lcm::depth_t>(process, estimator, wire::kDepth);
  ignore<fathom_lcm::usbl_t>(process, wire::kUsbl);
  ignore<fathom_lcm::tag_pose_t>(process, wire::kTagPose);
  ignore<fathom_lcm::optical_flow_t>(process, wire::kOpticalFlow);
  ignore<fathom_lcm::laser_range_t>(process, wire::kLaserRange);
  ignore<fathom_lcm::ranges_t>(process, wire::kRanges);
  hear_columns(process, [](const Signal& /*sample*/) {});
  process.on_restart([&] { estimator.reset(); });
  process.on_end([&] {
    for (const StateEstimate& state : estimator.finish()) process.publish(wire::kState, wire::encode(state));
    tell_refused(process, estimator.rejected());
  });
  process.run();
}

void run_trial(runtime::Process& process, const Config& config) {
  const model::Vehicle vehicle = model::Vehicle::load(process.config_path("dof"));
  const model::Site site = model::Site::load(process.config_path("site"));
  estimation::Navigator navigator{estimation::NavigatorSettings::from(config),
                                  estimation::NavigatorPlaces::of(vehicle.mounts, site)};
  Trial trial{.process = process, .navigator = navigator};
  hear_ahrs(trial);
  hear_aid<fathom_lcm::tag_pose_t>(trial, wire::kTagPose);
  hear_aid<fathom_lcm::optical_flow_t>(trial, wire::kOpticalFlow);
  hear_aid<fathom_lcm::laser_range_t>(trial, wire::kLaserRange);
  hear_aid<fathom_lcm::dvl_t>(trial, wire::kDvl);
  hear_aid<fathom_lcm::usbl_t>(trial, wire::kUsbl);
  hear_aid<fathom_lcm::depth_t>(trial, wire::kDepth);
  ignore<fathom_lcm::pose_capture_t>(process, wire::kPoseCapture);
  ignore<fathom_lcm::ranges_t>(process, wire::kRanges);
  hear_columns(process, [](const Signal& /*sample*/) {});
  process.on_health([&]() -> runtime::Process::Condition {
    const std::string complaint = navigator.complaint();
    std::string detail = complaint.empty() ? navigator.remark() : "";
    for (const auto& [reason, count] : navigator.rejected()) {
      detail += (detail.empty() ? "" : ", ") + reason + " " + std::to_string(count);
    }
    return {.unhealthy = complaint, .detail = detail};
  });
  process.on_restart([&] { navigator.reset(); });
  process.on_end([&] { tell_refused(process, navigator.rejected()); });
  process.run();
}

void run_kalman(runtime::Process& process, const Config& config) {
  auto settings = estimation::KalmanSettings::from(config);
  estimation::TrialFiles files;  // places that the section does not say
  for (const char* key : {"sensors", "site"}) {
    if (process.has_config(key)) files.add(Config::load(process.config_path(key)));
  }
  add_places(files, settings);
  if (config.has("ranges") && settings.transponders.empty())
    config.section("ranges").fail("transponders", "key 'transponders' is missing in 'estimator.ranges'");
  if (config.has("tags") && settings.tags.empty())
    config.section("tags").fail("known", "key 'known' is missing in 'estimator.tags'");
  estimation::KalmanEstimator estimator{settings};
  hear<fathom_lcm::pose_capture_t>(process, estimator, wire::kPoseCapture);
  hear<fathom_lcm::ahrs_t>(process, estimator, wire::kAhrs);
  hear<fathom_lcm::dvl_t>(process, estimator, wire::kDvl);
  hear<fathom_lcm::depth_t>(process, estimator, wire::kDepth);
  hear<fathom_lcm::usbl_t>(process, estimator, wire::kUsbl);
  hear<fathom_lcm::ranges_t>(process, estimator, wire::kRanges);
  hear<fathom_lcm::tag_pose_t>(process, estimator, wire::kTagPose);
  hear<fathom_lcm::optical_flow_t>(process, estimator, wire::kOpticalFlow);
  hear<fathom_lcm::laser_range_t>(process, estimator, wire::kLaserRange);
  hear_columns(process, [&](const Signal& sample) {
    for (const StateEstimate& state : estimator.step(sample)) process.publish(wire::kState, wire::encode(state));
  });
  process.on_restart([&] { estimator.reset(); });
  process.on_end([&] {
    for (const StateEstimate& state : estimator.finish()) process.publish(wire::kState, wire::encode(state));
    tell_refused(process, estimator.rejected());
  });
  process.run();
}

}  // namespace

int main(int argc, char** argv) {
  const runtime::Program program{"estimator", "Fuses the sensors into the state of the vehicle."};
  return runtime::main(program, argc, argv, [](runtime::Process& process) {
    process.publishes<fathom_lcm::state_t>(wire::kState);
    const Config config = process.config();
    const std::string filter = config.has("filter") ? config.text("filter") : "recorded";
    if (filter == "recorded") return run_recorded(process, config);
    if (filter == "complementary") return run_trial(process, config);
    if (filter == "ekf") return run_kalman(process, config);
    config.fail("filter", "'filter' must be recorded, complementary or ekf, not '" + filter + "'");
  });
}
