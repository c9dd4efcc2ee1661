// fathom arm, fly, abort, order, status: the operator's console. Orders carry the token of the vehicle's operator file,
// the vehicle's time and a sequence number; an abort needs none of these.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/operator_token.hpp"
#include "common/excitation/preflight.hpp"
#include "common/excitation/supervisor.hpp"
#include "processes/fathom/commands.hpp"
#include "processes/fathom/console.hpp"

namespace fathom::tool {
namespace {

struct Options {
  std::string url{"udpm://239.255.76.67:7667?ttl=0"};
  std::string operator_file;
  std::string word, segment;
  double seconds{};
  std::vector<std::string> needs = excitation::usual_needs();
};

Utime wall_clock() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

void print(const Excitation& e) {
  std::printf("%-10s %s\n", e.phase.c_str(), e.reason.c_str());
  if (e.mode.empty()) return;
  std::printf("mode %s, %.0f of at most %.0f s", e.mode.c_str(), e.elapsed, e.duration);
  if (e.metric >= 0.0) std::printf(", certainty %.3g of %.3g", e.metric, e.threshold);
  std::printf("%s\n", e.bent ? ", bent by the fence" : "");
  if (!e.missing.empty()) std::printf("still missing: %s\n", e.missing.c_str());
}

/// Line by line what must hold before anything moves; InputError where it does not.
void go_through(Console& console, const std::vector<std::string>& needs) {
  constexpr double kLongest = 2.5;  // s: HEALTH comes each second
  const auto lines = [&] { return excitation::preflight(console.heard(), needs); };
  console.listen(kLongest, [&] { return excitation::all_ok(lines()); });
  for (const excitation::PreflightLine& line : lines()) std::printf("%s\n", excitation::shown(line).c_str());
  std::fflush(stdout);
  if (!excitation::all_ok(lines())) throw InputError("not armed: see to what is NOT OK above, then arm again");
}

void order(const Options& options, bool enable, const std::string& word) {
  const std::string token = operator_token(options.operator_file);
  Console console{options.url};
  console.listen(1.0, [&] { return console.vehicle_time.has_value(); });
  if (!console.vehicle_time)
    throw InputError("no THRUSTERS on the bus: is the thruster driver (or the simulator) running?");
  if (enable) go_through(console, options.needs);
  const std::string before = console.excitation ? console.excitation->phase : "";
  const auto give = [&] {
    console.say({.utime = *console.vehicle_time,
                 .enable = enable,
                 .order = word,
                 .segment = options.segment,
                 .duration = options.seconds,
                 .token = token,
                 .sequence = wall_clock()});
  };
  give();
  // What is refused changes the reason only.
  const std::string said = console.excitation ? console.excitation->reason : "";
  const auto moved = [&] {
    return console.excitation && (console.excitation->phase != before || console.excitation->reason != said);
  };
  console.listen(1.5, moved);
  if (!console.excitation)
    throw InputError("no EXCITATION on the bus: are supervisor and estimator running? fathom status tells");
  print(*console.excitation);
  if (console.excitation->reason.find(excitation::kNotFlown) != std::string::npos)
    throw InputError("the supervisor goes on as before; see above");
  if (enable && console.excitation->phase == "disarmed") throw InputError("the supervisor did not arm; see above");
}

void abort_now(const Options& options) {
  Console console{options.url};
  for (int i = 0; i < 5; ++i) {  // one may be lost
    console.say({.utime = wall_clock(), .abort = true});
    console.listen(0.05);
  }
  console.listen(0.5, [&] { return console.excitation && console.excitation->phase == "aborted"; });
  if (console.excitation) print(*console.excitation);
}

void status(const Options& options) {
  Console console{options.url};
  console.listen(1.6);
  if (console.health.empty())
    throw InputError("nobody says HEALTH on this bus; check --bus and that processes are running");
  if (console.excitation) print(*console.excitation);
  if (console.state) {
    const Eigen::Vector3d& p = console.state->p_WB;
    std::printf("state %s, at %.2f %.2f %.2f m\n", console.state->valid ? "valid" : "NOT VALID", p.x(), p.y(), p.z());
  }
  for (const auto& [name, health] : console.health) {
    std::printf("%-16s %-10s busy %3.0f %%, dropped %lld, rejected %lld  %s\n", name.c_str(), health.state.c_str(),
                100.0 * health.busy, static_cast<long long>(health.dropped), static_cast<long long>(health.rejected),
                health.detail.c_str());
  }
}

CLI::App* add(CLI::App& app, const char* name, const char* what, const std::shared_ptr<Options>& options) {
  CLI::App* command = app.add_subcommand(name, what);
  if (const char* url = std::getenv("LCM_DEFAULT_URL"); url != nullptr && *url != '\0') options->url = url;
  command->add_option("--bus", options->url, "LCM URL (LCM_DEFAULT_URL)");
  return command;
}

}  // namespace

void add_operator(CLI::App& app) {
  auto options = std::make_shared<Options>();
  const auto with_token = [&](CLI::App* command) {
    command->add_option("--operator", options->operator_file, "file with the token that the vehicle knows")->required();
  };
  CLI::App* arm = add(app, "arm", "let the thrusters obey the supervisor, and begin", options);
  with_token(arm);
  const auto with_needs = [&](CLI::App* command) {
    command->add_option("--needs", options->needs,
                        "processes that must be well, as in the supervisor's section; left out: estimator, "
                        "identifier, thruster_driver or simulator, recorder or simulator");
  };
  with_needs(arm);
  arm->callback([options] { order(*options, true, "identify"); });
  CLI::App* say = add(app, "order", "say hold, identify, skip or retry to an armed supervisor", options);
  with_token(say);
  say->add_option("word", options->word)->required()->check(CLI::IsMember({"hold", "identify", "skip", "retry"}));
  say->callback([options] { order(*options, false, options->word); });
  CLI::App* fly = add(
      app, "fly", "one segment by its name, as fathom plan and diagnose give it; without one the diagnoser's proposal",
      options);
  with_token(fly);
  fly->add_option("segment", options->segment, "for instance 'full steps in surge'");
  fly->add_option("--seconds", options->seconds, "of it, again and again (as proposed, else once)")
      ->check(CLI::Range(1.0, 600.0));
  with_needs(fly);
  fly->callback([options] { order(*options, true, "fly"); });
  CLI::App* abort = add(app, "abort", "thrusters to zero at once; needs no token", options);
  abort->callback([options] { abort_now(*options); });
  CLI::App* ask = add(app, "status", "what runs, in which mode, and what is missing", options);
  ask->callback([options] { status(*options); });
}

}  // namespace fathom::tool
