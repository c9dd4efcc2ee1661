#include "common/runtime/arguments.hpp"

#include <cstdlib>
#include <filesystem>
#include <iostream>

#include "common/base/error.hpp"
#include "common/runtime/command_line.hpp"

namespace fathom::runtime {
namespace {

std::string default_bus() {
  const char* stated = std::getenv("LCM_DEFAULT_URL");
  return stated != nullptr && *stated != '\0' ? stated : "udpm://239.255.76.67:7667?ttl=0";
}

}  // namespace

std::optional<Arguments> Arguments::parse(const Program& program, int argc, const char* const* argv,
                                          const MoreOptions& more) {
  Arguments arguments;
  std::vector<std::string> in;
  std::string out;
  CommandLine app{program.sentence + " docs/messages.md tells what it hears and says.", program.name};
  app.add_option("--config", arguments.config, "YAML files: vehicle, site, pipeline");
  app.add_option("--in", in, "udpm://ADDRESS:PORT or file://RUN.lcmlog; several logs are merged by time")
      ->take_all()
      ->expected(1);
  app.add_option("--out", out, "udpm://ADDRESS:PORT or file://RESULT.lcmlog; default: the bus of --in");
  app.add_option("--log-level", arguments.log_level, "what to print on stderr")
      ->one_of({"trace", "debug", "info", "warning", "error", "critical", "off"});
  app.add_flag("--interface", arguments.interface_only, "print channels and types, then exit");
  app.add_flag("--lockstep", arguments.lockstep,
               "go on only when the simulator says so (it is started with --wait-for)");
  if (more) more(app);
  if (!app.parse(argc, argv)) return {};

  if (in.empty()) in.push_back(default_bus());
  for (const std::string& text : in) {
    arguments.in.push_back(Url::parse(text, "--in"));
    if (arguments.in.back().live() != arguments.in.front().live()) {
      throw InputError("--in " + text + ": logs and live buses do not mix; replay the log with lcm-logplayer");
    }
  }
  if (arguments.lockstep && !arguments.in.front().live()) {
    throw InputError(
        "--lockstep: only a live bus has a simulator to wait for; a log is read as fast as possible anyway");
  }
  if (out.empty() && !arguments.in.front().live() && !arguments.interface_only) {
    throw InputError("--in " + in.front() + ": say where the results go with --out file://RESULT.lcmlog");
  }
  arguments.out = Url::parse(out.empty() ? default_bus() : out, "--out");
  if (out.empty() && arguments.in.front().live()) arguments.out = arguments.in.front();
  for (const Url& url : arguments.in) {
    std::error_code ignored;
    if (!url.live() && std::filesystem::equivalent(url.path, arguments.out.path, ignored)) {
      throw InputError("--out " + arguments.out.text + ": would overwrite its own input; name another file");
    }
  }
  return arguments;
}

}  // namespace fathom::runtime
