// What is known of a run's instruments, as the Kalman filter and its smoother need it: places from the vehicle's and
// the site's files, noises from the section `estimator` of any pipeline, whichever filter that section chose. A log of
// Fathom's own holds all three, in PROCESS_INFO of the estimator that wrote STATE.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/base/config.hpp"
#include "common/estimation/online/kalman_settings.hpp"
#include "common/model/mounts.hpp"
#include "common/model/site.hpp"
#include "common/samples/recording.hpp"

namespace fathom::estimation {

struct TrialFiles {
  std::optional<Config> estimator;   ///< the section
  std::optional<Config> identifier;  ///< the section, which no instrument asks for
  std::optional<model::Mounts> mounts;
  std::optional<model::Site> site;
  bool in_the_log{false};

  [[nodiscard]] bool empty() const { return !estimator && !mounts && !site; }
  /// Takes what a file of any of the three kinds says.
  void add(const Config& file);
};

/// From PROCESS_INFO of the newest estimator (and identifier, for its section); empty without one.
[[nodiscard]] TrialFiles files_in(const Recording& recording);

/// What the files say of places goes into settings that do not say it themselves: instruments on the vehicle; tags,
/// transponders, floor, walls and gravity of the site.
void add_places(const TrialFiles& files, KalmanSettings& settings);

struct TrialInstruments {
  KalmanSettings settings;
  bool noises_stated{false};   ///< by the pipeline, for a filter that knows lasting errors: no rest may replace them
  bool process_stated{false};  ///< likewise the process noise
  std::string note;            ///< what was found of them, a line; may be empty
  std::vector<std::string> unrecorded;  ///< accelerometers and gyros of the vehicle file that the recording lacks
};

/// White noises of the inertial package are measured in the recording where no file states them. InputError when a file
/// is wrong.
[[nodiscard]] TrialInstruments instruments_of(const Recording& recording, const TrialFiles& files);

/// One line for each stream of the recording that could tell of the motion and does not: why, and what is missing.
[[nodiscard]] std::vector<std::string> unused_instruments(const Recording& recording, const KalmanSettings& settings);

}  // namespace fathom::estimation
