// fathom spy: lcm-spy with every message decoded. The windows are those of LCM's own program; what is missing for them
// is told, or installed.
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>

#include "common/base/error.hpp"
#include "common/runtime/command_line.hpp"
#include "processes/fathom/commands.hpp"

namespace fathom::tool {
namespace {

namespace fs = std::filesystem;

/// procman/spy beside the installed programs, or in the tree in which they were built.
std::string script() {
  std::error_code unknown;
  const fs::path programs = fs::read_symlink("/proc/self/exe", unknown).parent_path();
  const fs::path installed = programs.parent_path() / "share" / "fathom" / "procman" / "spy";
  if (fs::exists(installed, unknown)) return installed;
  for (fs::path each = programs; each != each.root_path(); each = each.parent_path()) {
    const fs::path found = each / "procman" / "spy";
    if (fs::exists(found, unknown)) return found;
  }
  throw InputError(programs.string() + ": procman/spy (share/fathom/procman) is not where this program is");
}

struct SpyOptions {
  bool check{false}, install{false};
};

void spy(const SpyOptions& options) {
  const std::string path = script();
  const char* order = options.check ? "--check" : options.install ? "--install" : nullptr;
  ::execl("/bin/bash", "bash", path.c_str(), order, nullptr);
  throw InputError(std::string{"/bin/bash: "} + std::strerror(errno));
}

}  // namespace

void add_spy(runtime::CommandLine& app) {
  auto options = std::make_shared<SpyOptions>();
  runtime::CommandLine* command = app.add_subcommand(
      "spy", "watch a running system, every message decoded: lcm-spy with pictures and plots (Java)");
  command->add_flag("--check", options->check, "say what is missing for it, open nothing");
  command->add_flag("--install", options->install, "install what is missing for it first (apt-get, by sudo)");
  command->callback([options] { spy(*options); });
}

}  // namespace fathom::tool
