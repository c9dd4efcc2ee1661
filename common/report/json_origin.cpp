#include "common/report/json_origin.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/base/utc.hpp"
#include "common/base/version.hpp"

namespace fathom::report {
namespace {

using Json = nlohmann::ordered_json;

Json date(const std::optional<Utime>& utime) {
  const std::optional<std::string> text = utime ? utc_text(*utime) : std::nullopt;
  return text ? Json(*text) : Json(nullptr);
}

Json file_entry(const OriginFile& file) {
  Json entry{{"role", file.role}, {"path", file.path}, {"sha256", file.sha256}, {"bytes", file.bytes}};
  if (file.run.empty()) return entry;
  entry["run"] = file.run;
  entry["begin"] = date(file.begin);
  entry["end"] = date(file.end);
  entry["seconds"] = file.begin && file.end ? number_or_null(seconds_between(*file.begin, *file.end)) : Json(nullptr);
  return entry;
}

}  // namespace

Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

void begin_result(Json& file, int schema, std::string_view kind, const ResultOrigin& origin) {
  std::optional<Utime> begin, end;
  Json files = Json::array();
  for (const OriginFile& one : origin.files) {
    files.push_back(file_entry(one));
    if (one.begin) begin = std::min(begin.value_or(*one.begin), *one.begin);
    if (one.end) end = std::max(end.value_or(*one.end), *one.end);
  }
  file["schema"] = schema;
  file["kind"] = kind;
  file["fathom_version"] = version();
  file["command"] = origin.command;
  file["data"] = {{"begin", date(begin)}, {"end", date(end)}};
  file["files"] = files;
}

}  // namespace fathom::report
