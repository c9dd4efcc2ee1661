#include "common/launch/allow_list.hpp"

#include "common/base/error.hpp"
#include "common/launch/config.hpp"

namespace fathom::launch {

AllowList AllowList::load(const std::vector<std::string>& paths, const std::string& deputy) {
  AllowList list;
  for (const std::string& path : paths) {
    list.files_ += (list.files_.empty() ? "" : ", ") + path;
    for (const ConfiguredCommand& each : LaunchConfig::load(path).commands) {
      if (each.deputy == deputy) list.lines_.emplace(each.command.id, each.command.exec);
    }
  }
  if (list.lines_.empty()) {
    throw InputError("--allow " + list.files_ + ": has no command for deputy '" + deputy +
                     "'; is this the deputy's --id, and the file that its sheriff uses?");
  }
  return list;
}

}  // namespace fathom::launch
