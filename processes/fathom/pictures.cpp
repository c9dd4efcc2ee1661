// fathom track, fathom calibrate: run by the program fathom-pictures, which lies beside this one and brings what reads
// pictures and videos.
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/runtime/command_line.hpp"
#include "processes/fathom/commands.hpp"

namespace fathom::tool {
namespace {

[[noreturn]] void run(const std::string& subcommand, const std::vector<std::string>& rest) {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  const auto program = self.parent_path() / "fathom-pictures";
  std::vector<std::string> words{program.string(), subcommand};
  words.insert(words.end(), rest.begin(), rest.end());
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& each : words) arguments.push_back(each.data());
  arguments.push_back(nullptr);
  execv(program.c_str(), arguments.data());
  throw InputError(program.string() +
                   ": cannot be started; it belongs beside fathom: cmake --build --preset release --target pictures");
}

void add(runtime::CommandLine& app, const std::string& name, const std::string& what) {
  app.add_subcommand(name, what)->hand_on([name](const std::vector<std::string>& words) { run(name, words); });
}

}  // namespace

void add_pictures(runtime::CommandLine& app) {
  add(app, "track", "tags, camera pose, velocity and laser range from recorded pictures");
  add(app, "calibrate", "lens and map of tags from a sequence of pictures");
}

}  // namespace fathom::tool
