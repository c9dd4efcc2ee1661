// fathom watch: how far a live trial is, a line at a time, until it ends or is stopped. It only listens.
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>

#include "common/runtime/command_line.hpp"
#include "common/runtime/stop_signal.hpp"
#include "processes/fathom/commands.hpp"
#include "processes/fathom/operator/console.hpp"

namespace fathom::tool {
namespace {

constexpr double kTerminalPeriod = 0.2;  // s between two looks where a line can be written over
constexpr double kFilePeriod = 1.0;

struct WatchOptions {
  std::string url{"udpm://239.255.76.67:7667?ttl=0"};
};

/// Variances fall as one over time, so what is left follows from how far the sum is above its threshold.
std::optional<double> time_left(const Excitation& e) {
  if (!e.active || !(e.metric > 0.0) || !(e.threshold > 0.0) || !(e.elapsed > 0.0)) return {};
  const double left = e.elapsed * (e.metric / e.threshold - 1.0);
  return std::clamp(left, 0.0, std::max(e.duration - e.elapsed, 0.0));
}

std::string line(const Excitation& e, double t) {
  char text[200];
  const auto add = [&](const char* format, auto... values) {
    std::snprintf(text, sizeof text, format, values...);
    return std::string{text};
  };
  std::string said = add("%6.1f s  %-9s %-6s", t, e.phase.c_str(), e.mode.c_str());
  if (e.mode.empty()) return said + " " + e.reason;
  said += add(" %5.1f s", e.elapsed);
  if (e.metric >= 0.0) said += add(", metric %.3g against %.3g", e.metric, e.threshold);
  if (const auto left = time_left(e)) said += add(", about %.0f s left", *left);
  if (e.metric >= 0.0 && e.metric < e.threshold && !e.missing.empty()) said += "; missing: " + e.missing;
  return said;
}

void watch(const WatchOptions& options) {
  runtime::StopSignal stop;
  const bool terminal = isatty(STDERR_FILENO) != 0;
  Console console{options.url, Console::Hears::kExcitation};
  std::optional<Utime> origin;
  std::string said, stage;
  while (!stop.raised()) {
    console.listen(terminal ? kTerminalPeriod : kFilePeriod, [&] { return stop.raised(); });
    if (!console.excitation) continue;
    const Excitation& e = *console.excitation;
    if (!origin) origin = e.utime;
    std::string now = line(e, seconds_between(*origin, e.utime));
    if (now == said) continue;
    said = now;
    if (!terminal) {
      std::fprintf(stderr, "%s\n", now.c_str());
      continue;
    }
    const std::string here = e.phase + e.mode;
    if (here != stage && !stage.empty()) std::fprintf(stderr, "\n");
    stage = here;
    now.resize(std::min<std::size_t>(now.size(), 110));
    std::fprintf(stderr, "\r\033[K%s", now.c_str());
  }
  if (terminal && !said.empty()) std::fprintf(stderr, "\n");
}

}  // namespace

void add_watch(runtime::CommandLine& app) {
  auto options = std::make_shared<WatchOptions>();
  if (const char* url = std::getenv("LCM_DEFAULT_URL"); url != nullptr && *url != '\0') options->url = url;
  runtime::CommandLine* command = app.add_subcommand("watch", "how far a live trial is, until Ctrl-C");
  command->add_option("--bus", options->url, "LCM URL (LCM_DEFAULT_URL)");
  command->callback([options] { watch(*options); });
}

}  // namespace fathom::tool
