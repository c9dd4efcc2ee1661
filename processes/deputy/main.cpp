// deputy: starts, watches and stops programs on this host as sheriffs order. Speaks procman's protocol, so that either
// may be replaced by procman's own.
#include <sys/prctl.h>

#include <csignal>
#include <cstdio>

#include "common/runtime/command_line.hpp"
#include "common/runtime/self.hpp"
#include "processes/deputy/environment.hpp"
#include "processes/deputy/service.hpp"

int main(int argc, char** argv) {
  using namespace fathom;
  runtime::CommandLine app{"Starts, watches and stops programs on this host as a sheriff orders; procman's protocol.",
                           "deputy"};
  deputy::Options options{.name = runtime::host_name(), .url = {}, .allow = {}};
  std::string log;
  app.add_option("-i,--id", options.name, "this deputy's name in configurations (the host's)");
  app.add_option("-u,--lcmurl", options.url, "bus of the orders (LCM_DEFAULT_URL); programs get LCM_DEFAULT_URL");
  app.add_option("--allow", options.allow,
                 "run only the command lines that these procman configurations name for this deputy (FATHOM_ALLOW)")
      ->envname("FATHOM_ALLOW");
  app.add_option("-l,--log", log, "append what it says to this file");
  bool leave{false};
  app.add_flag("--leave-with-parent", leave, "stop everything and end when whoever started it is gone");
  app.add_flag("-v,--verbose", options.verbose, "print what the programs print");
  if (const auto code = app.parse_or_tell(argc, argv)) return *code;
  if (leave) prctl(PR_SET_PDEATHSIG, SIGTERM);
  try {
    if (!log.empty() && std::freopen(log.c_str(), "a", stderr) == nullptr) {
      std::printf("deputy: %s cannot be written\n", log.c_str());
      return 1;
    }
    deputy::set_environment();
    if (options.url.empty()) options.url = deputy::variable("LCM_DEFAULT_URL");
    return deputy::Service{options}.run();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "deputy: %s\n", error.what());
    return 1;
  }
}
