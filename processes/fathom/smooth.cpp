// fathom smooth: a recorded run through the Kalman filter and back through the smoother.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <type_traits>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/base/progress_line.hpp"
#include "common/consistency/consistency.hpp"
#include "common/estimation/corrected_recording.hpp"
#include "common/estimation/smoothing/state_reconstruction.hpp"
#include "common/report/smoothed_page.hpp"
#include "common/report/text.hpp"
#include "common/runtime/command_line.hpp"
#include "common/tables/writer.hpp"
#include "common/wire/log_writer.hpp"
#include "common/wire/streams.hpp"
#include "processes/fathom/bus/trial_files.hpp"
#include "processes/fathom/commands.hpp"
#include "processes/fathom/inputs.hpp"
#include "processes/fathom/recordings.hpp"

namespace fathom::tool {
namespace {

constexpr double kConverged = 30.0;   // s after which filter and smoother are compared, as Pereira and Duncan did
constexpr double kMostRefused = 0.2;  // of an instrument's numbers: more are no outliers

struct SmoothOptions {
  std::string run, out, model, map, page;
  TrialFileOptions files;
  bool stated{false}, without_position{false}, despite_state{false};
};

double refused_share(const estimation::InnovationStatistics& one) {
  const auto refused = static_cast<double>(one.refused), all = static_cast<double>(one.used + one.refused);
  return all > 0.0 ? refused / all : 0.0;
}

void print(const estimation::SmoothedTrial& trial, const std::vector<estimation::SingleInertial>& singles) {
  std::printf("%-18s %9s %9s %9s %8s\n", "instrument", "used", "refused", "not heard", "NIS");
  for (const estimation::InnovationStatistics& one : trial.statistics) {
    if (one.used + one.refused + one.dropped == 0) continue;
    std::printf("%-18s %9lld %9lld %9lld %8.3f\n", one.name.c_str(), static_cast<long long>(one.used),
                static_cast<long long>(one.refused), static_cast<long long>(one.dropped), one.nis());
  }
  for (const estimation::InnovationStatistics& one : trial.statistics) {
    if (refused_share(one) <= kMostRefused) continue;
    std::printf("%s: %.0f %% refused; its noise is stated too small, or it contradicts the others (fathom check)\n",
                one.name.c_str(), 100.0 * refused_share(one));
  }
  Eigen::Vector3d early = Eigen::Vector3d::Zero(), sum = Eigen::Vector3d::Zero();
  double count = 0.0;
  for (std::size_t k = 0; k < trial.smoothed.size(); ++k) {
    const Eigen::Vector3d apart = trial.apart[k].cast<double>().cwiseAbs();
    if (seconds_between(trial.smoothed.front().utime, trial.smoothed[k].utime) < kConverged) {
      early = early.cwiseMax(apart);
    } else {
      sum += apart;
      ++count;
    }
  }
  std::printf("filter against smoother, X Y Z: within %.0f s at most %.2f %.2f %.2f m", kConverged, early.x(),
              early.y(), early.z());
  if (count > 0.0)
    std::printf(", after that %.1f %.1f %.1f cm on average", 100 * sum.x() / count, 100 * sum.y() / count,
                100 * sum.z() / count);
  std::printf("\nbiases: accelerometer %.4f %.4f %.4f m/s^2, gyro %.5f %.5f %.5f rad/s", trial.biases[18],
              trial.biases[19], trial.biases[20], trial.biases[21], trial.biases[22], trial.biases[23]);
  for (std::size_t i = 0; i < singles.size(); ++i) {
    std::printf(", %s %.4f %s", singles[i].mount.signal.c_str(),
                trial.biases[model::at::kSingleBias + static_cast<Eigen::Index>(i)], singles[i].mount.unit());
  }
  std::printf("\n");
}

StateEstimate estimate_of(const SmoothedState& smoothed) {
  return {.utime = smoothed.utime,
          .p_WB = smoothed.p_WB,
          .q_WB = smoothed.q_WB,
          .nu = smoothed.nu,
          .sigma = smoothed.sigma.head<12>(),
          .valid = true};
}

/// The run with SMOOTHED, and STATE from it, a minute after the other: STATE never stands in memory as a whole.
std::uint64_t write(const Recording& recording, const std::string& path) {
  constexpr Utime kPart = 60'000'000;  // us
  std::vector<std::size_t> taken;      // of each stream
  wire::LogWriter log{path};
  for (bool more = true; more;) {
    std::optional<Utime> first;
    std::size_t stream = 0;
    wire::visit_streams(recording, [&](const char*, const auto& from) {
      if (stream == taken.size()) taken.push_back(0);
      if (const std::size_t at = taken[stream++]; at < from.size())
        first = std::min(from[at].utime, first.value_or(from[at].utime));
    });
    Recording part{.name = recording.name};
    stream = 0;
    more = false;
    wire::visit_streams(recording, [&](const char*, const auto& from) {
      std::size_t& at = taken[stream++];
      const std::size_t begin = at;
      while (at < from.size() && from[at].utime < *first + kPart) ++at;
      more = more || at < from.size();
      wire::visit_streams(part, [&](const char*, auto& to) {
        if constexpr (std::is_same_v<std::decay_t<decltype(to)>, std::decay_t<decltype(from)>>)
          to.assign(from.begin() + static_cast<std::ptrdiff_t>(begin), from.begin() + static_cast<std::ptrdiff_t>(at));
      });
    });
    for (const SmoothedState& one : part.smoothed) part.state.push_back(estimate_of(one));
    log.append(part);
  }
  return log.finish();
}

/// Share of an instrument's numbers that was refused, of the one that most of was.
double most_refused(const estimation::SmoothedTrial& trial) {
  double most = 0.0;
  for (const estimation::InnovationStatistics& one : trial.statistics) most = std::max(most, refused_share(one));
  return most;
}

/// As recorded. Where the instruments contradict each other, so that this is refused or refuses more of one than
/// outliers are, once more with what the comparison of sensors corrects: axes, clocks, scales.
estimation::Reconstruction reconstructed(const Recording& recording, const estimation::TrialFiles& files,
                                         const estimation::ReconstructionOptions& asked,
                                         std::vector<std::string>& notes, const Progress& progress) {
  std::optional<estimation::Reconstruction> first;
  std::string why;
  try {
    first = estimation::reconstruct_state(recording, files, asked, notes, progress);
    if (most_refused(first->trial) <= kMostRefused) return std::move(*first);
    why = recording.name + ": much of one instrument is refused";
  } catch (const InputError& refused) {
    why = refused.what();
  }
  const consistency::ConsistencyResult checked = consistency::check_consistency({&recording, 1});
  std::string what;
  for (const ConsistencyFinding& one : checked.findings) {
    if (one.action.starts_with("corrected"))
      what += (what.empty() ? "" : ", ") + one.signal + " (" + report::effect_title(one.finding) + ")";
  }
  if (!what.empty()) {
    notes.push_back(why + "; once more with what the comparison of sensors corrects: " + what);
    try {
      auto again = estimation::reconstruct_state(estimation::corrected(recording, checked.corrections.front()), files,
                                                 asked, notes, progress);
      if (!first || most_refused(again.trial) < most_refused(first->trial)) return again;
      notes.push_back(recording.name + ": that refuses no less; as recorded");
    } catch (const InputError& error) {
      if (!first) throw InputError(std::string{error.what()} + " (corrected: " + what + ")");
    }
  }
  if (!first) throw InputError(why);
  return std::move(*first);
}

void run_smooth(const SmoothOptions& options) {
  refuse_over(options.out, options.run);
  std::vector<std::string> notes;
  Recording recording = std::move(read_recordings({options.run}, options.map, notes).front());
  const estimation::TrialFiles files = trial_files(options.files, recording, notes);
  estimation::ReconstructionOptions asked{.stated = options.stated,
                                          .without_position = options.without_position,
                                          .despite_state = options.despite_state,
                                          .filtered = !options.page.empty()};
  if (!options.model.empty()) {
    asked.model =
        options.model == "printed" ? estimation::KinematicModel::kPrinted : estimation::KinematicModel::kCoupled;
  }
  std::optional<ProgressLine> line{std::in_place};
  const auto tell = [&] {
    for (const std::string& note : notes) line->say(note);
    notes.clear();
  };
  tell();
  estimation::SmoothedTrial trial;
  bool attitude_used = false;
  std::vector<estimation::SingleInertial> singles;
  try {
    auto found = reconstructed(recording, files, asked, notes, line->progress());
    attitude_used = found.settings.attitude == estimation::AttitudeUse::kEverything;
    singles = found.settings.singles;
    trial = std::move(found.trial);
  } catch (const InputError&) {
    tell();
    throw;
  }
  tell();
  line.reset();
  print(trial, singles);
  recording.state.clear();
  recording.smoothed = std::move(trial.smoothed);
  const auto events = write(recording, options.out);
  if (!options.page.empty())
    tables::write_file(options.page, report::smoothed_page(recording, trial.filtered, attitude_used));
  std::printf("%s: %llu events, %zu of them SMOOTHED\n", options.out.c_str(), static_cast<unsigned long long>(events),
              recording.smoothed.size());
}

}  // namespace

void add_smooth(runtime::CommandLine& app) {
  auto options = std::make_shared<SmoothOptions>();
  runtime::CommandLine* command = app.add_subcommand("smooth", "reconstruct a recorded run with a Kalman smoother");
  command->add_option("run", options->run, ".lcmlog or .csv file")->required();
  command->add_option("--out", options->out, "LCM log to write: the run with SMOOTHED, and STATE from it")->required();
  add_trial_files(*command, options->files);
  command->add_option("--map", options->map, "YAML file that says what the columns of a .csv file are");
  command->add_option("--model", options->model, "kinematic model")->one_of({"printed", "coupled"});
  command->add_option("--page", options->page, "HTML file to write: the run drawn, filter and smoother");
  command->add_flag("--stated", options->stated, "keep the noises of the settings: nothing from rest, nothing tuned");
  command->add_flag("--without-position", options->without_position,
                    "velocity and attitude alone, where nothing tells the position");
  command->add_flag("--despite-state", options->despite_state, "the log's own STATE is known to be wrong");
  command->callback([options] { run_smooth(*options); });
}

}  // namespace fathom::tool
