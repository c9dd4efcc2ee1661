// All minds in one process against the simulator with the noise of every sensor: estimator, identifier and supervisor
// hear what the processes would hear, in the same order.
#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "common/excitation/supervisor.hpp"
#include "common/samples/estimates.hpp"
#include "common/samples/recording.hpp"
#include "common/simulation/simulator.hpp"

namespace fathom::test {

/// One parameter at a trial's end.
struct Learnt {
  std::string name;
  double value{}, std{}, truth{};  ///< SI
};

/// What MODEL says after so many seconds under way.
struct Progress {
  double seconds{};  ///< since arming
  std::vector<Learnt> learnt;
  /// RMS of the wrench that these numbers foretell for the true motion so far, less the one that acted, over the RMS of
  /// the latter: forces together, moments together.
  double force{}, moment{};
  double nees{};  ///< of all parameters together, by MODEL's covariance
};

struct FullTrial {
  std::string text;
  excitation::Phase phase{};
  std::vector<excitation::Supervisor::Visit> visits;
  simulation::ContactCounts contacts;
  ModelEstimate model;
  Eigen::Vector3d position{Eigen::Vector3d::Zero()}, velocity{Eigen::Vector3d::Zero()};  // RMS errors
  Eigen::Vector3d velocity_mean{Eigen::Vector3d::Zero()};  // of the velocity's errors, m/s
  Eigen::Vector3d nees_position{Eigen::Vector3d::Zero()}, nees_velocity{Eigen::Vector3d::Zero()};
  double ended{};
  int within{}, covered{};  ///< parameters: within 5 % of the truth, inside the 95 % interval
  std::vector<Learnt> learnt;
  std::vector<Progress> progress;
  std::vector<EffectRanking> rankings;  ///< of the live diagnoser
};

struct FullTrialOptions {
  unsigned seed{1};
  bool optimal{false};
  bool diagnose{false};        ///< with the live diagnoser, whose rankings the identifier hears
  bool joint{false};           ///< state and parameters in one filter, beside the recursive estimate
  std::vector<double> when{};  ///< s since arming, rising: FullTrial::progress
  double limit{700.0};         ///< s
  std::string site{"tank"};
  std::vector<std::string> hide{};
  std::string vehicle{"seabotix_lbv150"};
  /// Changes to the text of the site's pipeline file: what must be there once, and what stands in its place.
  std::vector<std::pair<std::string, std::string>> pipeline{};
  /// The same for config/simulation/VEHICLE.yaml: which error of an instrument makes which error of the model.
  std::vector<std::pair<std::string, std::string>> simulation{};
  /// Takes what a recorder would: instruments, thrusters, STATE, MODEL, EXCITATION, TRUTH, and PROCESS_INFO of the
  /// estimator.
  Recording* recording{};
};

/// From the simulator's first command to the schedule's end or the limit.
[[nodiscard]] FullTrial run_trial(const FullTrialOptions& options);

}  // namespace fathom::test
