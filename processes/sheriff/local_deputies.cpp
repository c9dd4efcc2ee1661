#include "processes/sheriff/local_deputies.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <filesystem>

#include "common/base/error.hpp"

namespace fathom::sheriff {

void LocalDeputies::start(const std::string& name, const std::string& url, const std::string& config) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  const fs::path folder = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  const fs::path installed = folder / "fathom-deputy";
  std::string program = fs::exists(installed, ignored) ? installed.string() : (folder / "deputy").string();
  std::vector<std::string> words{program, "--id", name, "--lcmurl", url, "--allow", config, "--leave-with-parent"};
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& each : words) arguments.push_back(each.data());
  arguments.push_back(nullptr);

  // Out of the terminal's reach: Ctrl-C is the sheriff's, who then stops all in order.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);  // its words come over the bus
  posix_spawn_file_actions_adddup2(&actions, 1, 2);
  posix_spawn_file_actions_addclosefrom_np(&actions, 3);
  pid_t pid{};
  const int error = posix_spawn(&pid, program.c_str(), &actions, &attributes, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  if (error != 0) throw InputError(program + ": cannot be run: " + std::strerror(error));
  pids_.push_back(pid);
}

void LocalDeputies::stop() {
  for (const pid_t each : pids_) kill(each, SIGTERM);
  for (const pid_t each : pids_) waitpid(each, nullptr, 0);
  pids_.clear();
}

}  // namespace fathom::sheriff
