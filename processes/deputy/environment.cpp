#include "processes/deputy/environment.hpp"

#include <stdlib.h>

#include <cstdlib>
#include <filesystem>

namespace fathom::deputy {
namespace {

namespace fs = std::filesystem;

/// The folder that holds config/: beside the installed programs, or the tree they were built in.
std::string share_of(const fs::path& programs) {
  std::error_code ignored;
  const fs::path installed = programs.parent_path() / "share" / "fathom";
  if (fs::is_directory(installed / "config", ignored)) return installed.string();
  for (fs::path each = programs; each != each.root_path(); each = each.parent_path()) {
    if (fs::is_directory(each / "config" / "pipelines", ignored)) return each.string();
  }
  return {};
}

void set_default(const char* name, const std::string& value) {
  if (!value.empty() && variable(name).empty()) setenv(name, value.c_str(), 1);
}

}  // namespace

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

void set_environment() {
  std::error_code ignored;
  const fs::path programs = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  const std::string path = variable("PATH");
  setenv("PATH", (programs.string() + (path.empty() ? "" : ":" + path)).c_str(), 1);
  set_default("FATHOM_SHARE", share_of(programs));
  set_default("FATHOM_RUN", fs::current_path(ignored).string());
  const auto set_file = [&](const char* name, const std::string& own, const std::string& simulated) {
    const std::string file = variable("FATHOM_RUN") + "/" + own;
    set_default(name, fs::exists(file, ignored) ? file : variable("FATHOM_SHARE") + "/config/" + simulated);
  };
  set_file("FATHOM_OPERATOR", "operator.yaml", "operators/simulated.yaml");
  set_file("FATHOM_VEHICLE", "vehicle.yaml", "vehicles/seabotix_lbv150.yaml");
  set_default("LCM_DEFAULT_URL", "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=2097152");
}

}  // namespace fathom::deputy
