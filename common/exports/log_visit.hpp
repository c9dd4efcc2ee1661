// What all exports of a log's channels share: every message decoded, and its numbers by the names of their columns.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "common/base/event_log.hpp"
#include "common/exports/any_message.hpp"
#include "common/exports/log_export.hpp"

namespace fathom::exports {

using VisitMessage = std::function<void(const LogEvent&, const Type&, const nlohmann::ordered_json&)>;

/// Every message of these channels (empty: of all) that can be decoded. InputError when a channel is not in the log.
Exported visit(const std::string& log, std::span<const std::string> channels, Bytes bytes, const VisitMessage& take,
               const Definitions& definitions = Definitions::built_in());

/// Scalars by the names of their columns: "utime", "nu[0]", "parameters[2].value".
void flatten(const nlohmann::ordered_json& value, const std::string& name,
             const std::function<void(const std::string&, const nlohmann::ordered_json&)>& put);

}  // namespace fathom::exports
