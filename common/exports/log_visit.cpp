#include "common/exports/log_visit.hpp"

#include <algorithm>
#include <set>

#include "common/base/error.hpp"

namespace fathom::exports {

using Json = nlohmann::ordered_json;

Exported visit(const std::string& log, std::span<const std::string> channels, Bytes bytes, const VisitMessage& take,
               const Definitions& definitions) {
  Exported exported;
  EventLog events{log};
  std::set<std::string> seen;
  while (const auto event = events.next()) {
    const std::string channel{event->channel};
    seen.insert(channel);
    if (!channels.empty() && std::ranges::find(channels, channel) == channels.end()) continue;
    const Type* type = definitions.type_of(event->data);
    if (type == nullptr) {
      ++exported.unknown[channel];
      continue;
    }
    const std::optional<Json> message = decoded(definitions, *type, event->data, bytes);
    if (!message) {
      ++exported.damaged[channel];
      continue;
    }
    ++exported.written[channel];
    take(*event, *type, *message);
  }
  for (const std::string& channel : channels) {
    if (seen.contains(channel)) continue;
    std::string all;
    for (const std::string& one : seen) all += (all.empty() ? "" : ", ") + one;
    throw InputError(log + ": has no channel " + channel + "; it has " + all);
  }
  exported.warning = events.warning();
  return exported;
}

void flatten(const Json& value, const std::string& name,
             const std::function<void(const std::string&, const Json&)>& put) {
  if (value.is_object()) {
    for (const auto& [key, inner] : value.items()) flatten(inner, name.empty() ? key : name + "." + key, put);
  } else if (value.is_array()) {
    for (std::size_t i = 0; i < value.size(); ++i) flatten(value[i], name + "[" + std::to_string(i) + "]", put);
  } else {
    put(name, value);
  }
}

}  // namespace fathom::exports
