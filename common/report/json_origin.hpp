// What every result.json begins with: schema, kind, tool, command, files and the date of the data.
#pragma once

#include <nlohmann/json.hpp>
#include <string_view>

#include "common/samples/result_origin.hpp"

namespace fathom::report {

/// Versions of the schemas in docs/schema. Keys are only ever added under one number; a change of a key's meaning or
/// its removal raises it.
inline constexpr int kDiagnosisSchema = 2, kLiveTrialSchema = 1, kCheckSchema = 1;

/// Number, or null where it is not finite.
[[nodiscard]] nlohmann::ordered_json number_or_null(double value);

/// Writes schema, kind, fathom_version, command, data and files.
void begin_result(nlohmann::ordered_json& file, int schema, std::string_view kind, const ResultOrigin& origin);

}  // namespace fathom::report
