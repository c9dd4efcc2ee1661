// fathom vehicle: the vehicle files that come with Fathom, to begin one's own with.
#include "common/model/vehicle.hpp"

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <sstream>
#include <string>

#include "common/base/error.hpp"
#include "common/base/near_name.hpp"
#include "common/runtime/command_line.hpp"
#include "processes/fathom/commands.hpp"

namespace fathom::tool {
namespace {

namespace fs = std::filesystem;

/// config/vehicles beside the installed programs, or in the tree in which they were built.
fs::path folder() {
  std::error_code unknown;
  const fs::path programs = fs::read_symlink("/proc/self/exe", unknown).parent_path();
  const fs::path installed = programs.parent_path() / "share" / "fathom" / "config" / "vehicles";
  if (fs::is_directory(installed, unknown)) return installed;
  for (fs::path each = programs; each != each.root_path(); each = each.parent_path()) {
    if (fs::is_directory(each / "config" / "vehicles", unknown)) return each / "config" / "vehicles";
  }
  throw InputError(programs.string() +
                   ": the vehicle files (share/fathom/config/vehicles) are not where this program is");
}

/// By the name under which it is asked for.
std::map<std::string, fs::path> files() {
  std::map<std::string, fs::path> found;
  for (const auto& entry : fs::directory_iterator{folder()}) {
    if (entry.path().extension() == ".yaml") found[entry.path().stem().string()] = entry.path();
  }
  return found;
}

std::string motions(const model::Vehicle& vehicle) {
  constexpr std::array<const char*, 6> kMotions{"surge", "sway", "heave", "roll", "pitch", "yaw"};
  std::string text;
  for (std::size_t i = 0; i < kMotions.size(); ++i) {
    if (vehicle.dof[i]) text += (text.empty() ? "" : " ") + std::string{kMotions[i]};
  }
  return text;
}

void list() {
  for (const auto& [name, path] : files()) {
    const model::Vehicle vehicle = model::Vehicle::load(path.string());
    const std::string driven =
        vehicle.has_thrusters() ? std::to_string(vehicle.thrusters.size()) + " thrusters" : "wrench";
    std::printf("%-16s %-24s %6.1f kg  %-11s  %s\n", name.c_str(), vehicle.name.c_str(), vehicle.mass, driven.c_str(),
                motions(vehicle).c_str());
  }
  std::printf("\nfathom vehicle NAME > my.yaml: sources and certainty of the numbers stand in the file\n");
}

void print(const std::string& name) {
  const std::map<std::string, fs::path> known = files();
  const auto found = known.find(name);
  if (found == known.end()) {
    std::string all, near;
    for (const auto& [each, path] : known) {
      all += (all.empty() ? "" : ", ") + each;
      if (near.empty() && looks_like(name, each)) near = " (did you mean " + each + "?)";
    }
    throw InputError("no vehicle file is called " + name + near + "; there are: " + all);
  }
  std::ifstream file{found->second, std::ios::binary};
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) throw InputError(found->second.string() + ": cannot be read");
  std::fputs(text.str().c_str(), stdout);
}

}  // namespace

void add_vehicle(runtime::CommandLine& app) {
  auto name = std::make_shared<std::string>();
  runtime::CommandLine* command = app.add_subcommand("vehicle", "vehicle files to begin with: all of them, or one");
  command->add_option("name", *name, "which file to print; without: a list");
  command->callback([name] { name->empty() ? list() : print(*name); });
}

}  // namespace fathom::tool
