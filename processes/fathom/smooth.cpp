// fathom smooth: a recorded run through the Kalman filter and back through the smoother.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>

#include "common/report/smoothed_page.hpp"
#include "common/runtime/command_line.hpp"
#include "common/tables/writer.hpp"
#include "common/wire/log_writer.hpp"
#include "common/wire/streams.hpp"
#include "processes/fathom/commands.hpp"
#include "processes/fathom/inputs.hpp"
#include "processes/fathom/recordings.hpp"
#include "processes/fathom/smoothing.hpp"

namespace fathom::tool {
namespace {

constexpr double kConverged = 30.0;  // s after which filter and smoother are compared, as Pereira and Duncan did

struct SmoothOptions {
  std::string run, out, model, map, page;
  TrialFileOptions files;
  bool stated{false}, without_position{false}, despite_state{false};
};

void print(const Recording& recording, const estimation::Reconstruction& found) {
  const estimation::SmoothedTrial& trial = found.trial;
  const std::vector<SmoothedState>& smoothed = recording.smoothed;
  std::printf("%-18s %9s %9s %9s %8s\n", "instrument", "used", "refused", "not heard", "NIS");
  for (const estimation::InnovationStatistics& one : trial.statistics) {
    if (one.used + one.refused + one.dropped == 0) continue;
    std::printf("%-18s %9lld %9lld %9lld %8.3f\n", one.name.c_str(), static_cast<long long>(one.used),
                static_cast<long long>(one.refused), static_cast<long long>(one.dropped), one.nis());
  }
  Eigen::Vector3d early = Eigen::Vector3d::Zero(), sum = Eigen::Vector3d::Zero();
  double count = 0.0;
  for (std::size_t k = 0; k < smoothed.size(); ++k) {
    const Eigen::Vector3d apart = trial.apart[k].cast<double>().cwiseAbs();
    if (seconds_between(smoothed.front().utime, smoothed[k].utime) < kConverged) {
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
  for (std::size_t i = 0; i < found.settings.singles.size(); ++i) {
    std::printf(", %s %.4f %s", found.settings.singles[i].mount.signal.c_str(),
                trial.biases[model::at::kSingleBias + static_cast<Eigen::Index>(i)],
                found.settings.singles[i].mount.unit());
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

void run_smooth(const SmoothOptions& options) {
  refuse_over(options.out, options.run);
  std::vector<std::string> notes;
  Recording read = std::move(read_recordings({options.run}, options.map, notes).front());
  estimation::ReconstructionOptions asked{.stated = options.stated,
                                          .without_position = options.without_position,
                                          .despite_state = options.despite_state,
                                          .filtered = !options.page.empty()};
  if (!options.model.empty()) {
    asked.model =
        options.model == "printed" ? estimation::KinematicModel::kPrinted : estimation::KinematicModel::kCoupled;
  }
  auto [recording, found] = smoothed_run(std::move(read), options.files, asked, std::move(notes));
  print(recording, found);
  const auto events = write(recording, options.out);
  if (!options.page.empty())
    tables::write_file(options.page, report::smoothed_page(recording, smoothing_of(std::move(found))));
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
