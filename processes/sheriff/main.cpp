// sheriff: starts and stops what a configuration of procman names, on all its hosts, and shows how it fares. Speaks
// procman's protocol, so that either side may be procman's own.
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "common/launch/config.hpp"
#include "common/runtime/command_line.hpp"
#include "processes/sheriff/office.hpp"

namespace {

/// As given, or of those that are installed: "procman/tank.cfg" is found from anywhere.
std::string find_config(const std::string& given) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  if (fs::exists(given, ignored)) return given;
  const fs::path programs = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  const fs::path installed = programs.parent_path() / "share" / "fathom" / given;
  return fs::exists(installed, ignored) ? installed.string() : given;
}

int check(const fathom::launch::LaunchConfig& config) {
  const auto traps = config.traps();
  for (const std::string& each : traps) std::printf("%s\n", each.c_str());
  std::printf("%s: %zu commands on %zu hosts, %zu scripts\n", config.path.c_str(), config.commands.size(),
              config.deputies().size(), config.scripts.size());
  return traps.empty() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace fathom;
  runtime::CommandLine app{
      "Starts and stops what a procman configuration names, and shows how it fares. Without --script, --status or "
      "--stop it looks on until Ctrl-C. Exit 0: all that shall run does; 1: not; 130: interrupted.",
      "sheriff"};
  sheriff::Options options;
  bool only_check{false};
  app.add_option("config", options.config, "procman/*.cfg")->required();
  auto* script = app.add_option("--script", options.script, "run this script of the configuration");
  auto* status = app.add_flag("--status", options.status, "print the table once");
  auto* stop = app.add_flag("--stop", options.stop, "stop everything, by the script \"stop\" where there is one");
  app.add_flag("--stay", options.stay, "after the script: look on until Ctrl-C")->needs(script);
  app.add_flag("--local", options.local, "start missing deputies on this host; at the end stop all, and them");
  auto* checks = app.add_flag("--check", only_check, "read the configuration, tell what procman would stumble over");
  app.add_option("--logs", options.logs, "folder that gets what each program prints, NAME.txt");
  app.add_option("-u,--lcmurl", options.url, "bus of the orders (LCM_DEFAULT_URL)");
  app.add_flag("-v,--verbose", options.verbose, "print what the programs print");
  script->excludes(status)->excludes(stop)->excludes(checks);
  status->excludes(stop);
  if (const auto code = app.parse_or_tell(argc, argv)) return *code;
  try {
    launch::LaunchConfig config = launch::LaunchConfig::load(find_config(options.config));
    if (only_check) return check(config);
    if (!options.script.empty()) (void)config.require_script(options.script);
    const char* url = std::getenv("LCM_DEFAULT_URL");
    options.health_url = url != nullptr && *url != '\0' ? url : "udpm://239.255.76.67:7667?ttl=0";
    if (options.url.empty()) options.url = options.health_url;
    return sheriff::Office{options, std::move(config)}.run();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "sheriff: %s\n", error.what());
    return 1;
  }
}
