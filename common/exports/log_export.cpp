#include "common/exports/log_export.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>

#include "common/base/error.hpp"
#include "common/base/event_log.hpp"
#include "common/base/version.hpp"
#include "common/exports/any_message.hpp"
#include "common/exports/channel_tables.hpp"
#include "common/exports/log_visit.hpp"
#include "common/recordings/mcap/writer.hpp"

namespace fathom::exports {
namespace {

using Json = nlohmann::ordered_json;

struct Columns {
  std::vector<std::string> names;
  std::map<std::string, std::size_t> places;
};

/// As RFC 4180 has it; nothing where there is no number.
std::string cell(const Json& value) {
  if (value.is_null()) return "";
  if (!value.is_string()) return value.dump();
  const std::string& text = value.get_ref<const std::string&>();
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string{"\"\""} : std::string(1, c);
  return quoted + "\"";
}

std::string file_name(const std::string& channel) {
  std::string name = channel;
  std::ranges::replace(name, '/', '_');
  return name;
}

void describe(std::ostream& out, const std::string& channel, const Type& type) {
  out << channel << ".csv: " << type.package << "." << type.name << (type.comment.empty() ? "" : ". " + type.comment)
      << "\n"
      << "  t: [s] since the log's first message, when this one was logged\n";
  for (const Field& field : type.fields) {
    out << "  " << field.name;
    for (const std::string& size : field.sizes) out << "[" << size << "]";
    out << ": " << field.type << (field.comment.empty() ? "" : ", " + field.comment)
        << (field.type == "byte" && !field.sizes.empty() ? " (their number alone)" : "") << "\n";
  }
  out << "\n";
}

}  // namespace

Exported to_csv(const std::string& log, const std::string& folder, std::span<const std::string> channels) {
  std::map<std::string, Columns> columns;
  std::map<std::string, const Type*> types;
  std::optional<Utime> origin;
  if (EventLog events{log}; const auto first = events.next()) origin = first->time;
  // Lists may grow while the log goes on: the columns are known at its end.
  (void)visit(log, channels, Bytes::kCount, [&](const LogEvent& event, const Type& type, const Json& message) {
    const std::string channel{event.channel};
    types[channel] = &type;
    Columns& known = columns[channel];
    flatten(message, "", [&](const std::string& name, const Json&) {
      if (known.places.try_emplace(name, known.names.size()).second) known.names.push_back(name);
    });
  });
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed) throw InputError(folder + ": cannot be made (" + failed.message() + "); choose another --out");
  std::map<std::string, std::ofstream> files;
  const auto path_of = [&](const std::string& name) { return (std::filesystem::path{folder} / name).string(); };
  for (const auto& [channel, known] : columns) {
    std::ofstream& file = files[channel];
    file.open(path_of(file_name(channel) + ".csv"), std::ios::binary);
    file << "t";
    for (const std::string& name : known.names) file << "," << name;
    file << "\n";
  }
  Exported exported = visit(log, channels, Bytes::kCount, [&](const LogEvent& event, const Type&, const Json& message) {
    const std::string channel{event.channel};
    const Columns& known = columns.at(channel);
    std::vector<std::string> row(known.names.size());
    flatten(message, "", [&](const std::string& name, const Json& value) { row[known.places.at(name)] = cell(value); });
    std::ofstream& file = files[channel];
    file << Json(seconds_between(*origin, event.time)).dump();
    for (const std::string& text : row) file << "," << text;
    file << "\n";
  });
  std::ofstream about{path_of("columns.txt"), std::ios::binary};
  if (origin) about << line_of_origin(*origin) << "\n\n";
  for (const auto& [channel, type] : types) describe(about, channel, *type);
  files["columns.txt"] = std::move(about);
  for (auto& [channel, file] : files) {
    if (!file.flush()) throw InputError(path_of(channel) + ": cannot be written; check permissions and free space");
  }
  return exported;
}

Exported to_mcap(const std::string& log, const std::string& file, std::span<const std::string> channels,
                 const Definitions& definitions) {
  static_cast<void>(EventLog{log});  // refuses what is no log before anything is written
  recordings::mcap::Writer writer{file};
  writer.metadata("fathom",
                  {{"log", std::filesystem::path{log}.filename().string()}, {"version", std::string{version()}}});
  std::map<std::pair<std::string, const Type*>, std::uint16_t> opened;
  const auto nanoseconds = [](Utime time) { return static_cast<std::uint64_t>(std::max<Utime>(time, 0)) * 1000; };
  Exported exported = visit(
      log, channels, Bytes::kBase64,
      [&](const LogEvent& event, const Type& type, const Json& message) {
        const auto [place, fresh] = opened.try_emplace({std::string{event.channel}, &type});
        if (fresh)
          place->second = writer.open(std::string{event.channel}, type.package + "." + type.name,
                                      json_schema(definitions, type).dump());
        const bool stamped = message.contains("utime");
        writer.message(place->second, nanoseconds(event.time),
                       nanoseconds(stamped ? message.at("utime").get<Utime>() : event.time),
                       message.dump(-1, ' ', false, Json::error_handler_t::replace));
      },
      definitions);
  writer.close();
  return exported;
}

}  // namespace fathom::exports
