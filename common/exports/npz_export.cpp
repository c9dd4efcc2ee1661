// A log's channels as arrays of NumPy.
#include <algorithm>
#include <array>
#include <bit>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>

#include "common/base/version.hpp"
#include "common/exports/log_visit.hpp"
#include "common/recordings/numpy/writer.hpp"

namespace fathom::exports {
namespace {

using Json = nlohmann::ordered_json;
using recordings::numpy::Array;

/// One scalar of a message over the rows of its channel.
struct Column {
  enum class Kind { kWhole, kReal, kTruth, kText };
  Kind kind{};
  std::vector<std::size_t> place;  ///< indices of its lists: "parameters[2].value" has {2}
  std::vector<double> reals;
  std::vector<std::int64_t> wholes;  ///< kTruth: 0 or 1
  std::vector<std::string> texts;

  /// NaN and empty text where rows have nothing.
  void fill(std::size_t rows) {
    const std::size_t had = std::max({reals.size(), wholes.size(), texts.size()});
    if (had == rows) return;
    if (kind == Kind::kWhole || kind == Kind::kTruth) make_real();  // no whole number says "nothing"
    if (kind == Kind::kReal) reals.resize(rows, std::numeric_limits<double>::quiet_NaN());
    if (kind == Kind::kText) texts.resize(rows);
  }
  void put(const Json& value, std::size_t row) {
    fill(row);
    const bool whole = value.is_number_integer(), truth = value.is_boolean();
    if ((kind == Kind::kWhole && !whole) || (kind == Kind::kTruth && !truth)) make_real();  // another type's
    if (kind == Kind::kText) {
      texts.push_back(value.is_string() ? value.get<std::string>() : value.dump());
    } else if (kind == Kind::kReal) {
      reals.push_back(value.is_number() ? value.get<double>()
                      : truth           ? static_cast<double>(value.get<bool>())
                                        : std::numeric_limits<double>::quiet_NaN());
    } else {
      wholes.push_back(truth ? std::int64_t{value.get<bool>()} : value.get<std::int64_t>());
    }
  }

 private:
  void make_real() {
    kind = Kind::kReal;
    reals.assign(wholes.begin(), wholes.end());
    wholes.clear();
  }
};

Column::Kind kind_of(const Json& value) {
  if (value.is_string()) return Column::Kind::kText;
  if (value.is_boolean()) return Column::Kind::kTruth;
  return value.is_number_integer() ? Column::Kind::kWhole : Column::Kind::kReal;
}

/// "parameters[2].value" to "parameters.value" and {2}.
std::string without_places(const std::string& column, std::vector<std::size_t>& place) {
  std::string name;
  for (std::size_t i = 0; i < column.size(); ++i) {
    if (column[i] != '[') {
      name += column[i];
      continue;
    }
    const std::size_t end = column.find(']', i);
    place.push_back(std::stoul(column.substr(i + 1, end - i - 1)));
    i = end;
  }
  return name;
}

struct Channel {
  const Type* type{};
  std::vector<double> t;
  std::vector<std::string> fields;  ///< in the order in which they came
  std::map<std::string, std::vector<Column>> columns;
  std::map<std::string, std::pair<std::string, std::size_t>> known;  ///< by the column's name
};

template <class Number>
void put_bytes(std::vector<std::uint8_t>& into, std::size_t at, Number number) {
  const auto bytes = std::bit_cast<std::array<std::uint8_t, sizeof(Number)>>(number);
  std::ranges::copy(bytes, into.begin() + static_cast<std::ptrdiff_t>(at * sizeof(Number)));
}

/// All columns of a field as one array.
Array array_of(const std::string& name, std::vector<Column>& columns, std::size_t rows) {
  std::vector<std::size_t> shape{rows};
  bool real = false, text = false;
  shape.resize(1 + columns.front().place.size(), 0);
  for (Column& column : columns) {
    column.fill(rows);
    real = real || column.kind == Column::Kind::kReal;
    text = text || column.kind == Column::Kind::kText;
    for (std::size_t d = 0; d < column.place.size(); ++d) shape[d + 1] = std::max(shape[d + 1], column.place[d] + 1);
  }
  std::size_t width = 1;
  for (std::size_t d = 1; d < shape.size(); ++d) width *= shape[d];
  const auto offset = [&](const Column& column) {
    std::size_t at = 0;
    for (std::size_t d = 0; d < column.place.size(); ++d) at = at * shape[d + 1] + column.place[d];
    return at;
  };
  if (text) {
    std::vector<std::string> all(rows * width);
    for (const Column& column : columns) {
      for (std::size_t row = 0; row < column.texts.size(); ++row) all[row * width + offset(column)] = column.texts[row];
    }
    return recordings::numpy::text_array(name, all, shape);
  }
  // A list with holes in it (lists within lists of other lengths) has no whole number for them.
  real = real || columns.size() < width;
  const bool truth = !real && columns.front().kind == Column::Kind::kTruth;
  Array array{.name = name, .type = real ? "<f8" : truth ? "|b1" : "<i8", .shape = shape};
  array.bytes.resize(rows * width * (truth ? 1 : 8));
  if (real) {
    for (std::size_t i = 0; i < rows * width; ++i) put_bytes(array.bytes, i, std::numeric_limits<double>::quiet_NaN());
  }
  for (const Column& column : columns) {
    for (std::size_t row = 0; row < rows; ++row) {
      const std::size_t at = row * width + offset(column);
      if (truth) {
        put_bytes(array.bytes, at, static_cast<std::uint8_t>(column.wholes[row]));
      } else if (!real) {
        put_bytes(array.bytes, at, column.wholes[row]);
      } else {
        put_bytes(array.bytes, at,
                  column.kind == Column::Kind::kReal ? column.reals[row] : static_cast<double>(column.wholes[row]));
      }
    }
  }
  return array;
}

/// What stands in the brackets at a comment's begin; empty where none do.
std::string unit_of(const std::string& comment) {
  const std::size_t end = comment.find(']');
  return comment.starts_with("[") && end != std::string::npos ? comment.substr(1, end - 1) : "";
}

void describe(const Definitions& definitions, const Type& type, const std::string& before, Json& fields) {
  for (const Field& field : type.fields) {
    const std::string name = before + field.name;
    if (!field.primitive() && field.type != "string" && field.type != "double" && field.type != "boolean" &&
        field.type != "byte" && field.type != "float") {
      describe(definitions, definitions.type(type.package, field.type), name + ".", fields);
      continue;
    }
    fields[name] = {{"type", field.type}, {"unit", unit_of(field.comment)}, {"comment", field.comment}};
  }
}

}  // namespace

Exported to_npz(const std::string& log, const std::string& file, std::span<const std::string> channels) {
  std::map<std::string, Channel> all;
  std::optional<Utime> origin;
  if (EventLog events{log}; const auto first = events.next()) origin = first->time;
  Exported exported =
      visit(log, channels, Bytes::kCount, [&](const LogEvent& event, const Type& type, const Json& message) {
        Channel& channel = all[std::string{event.channel}];
        channel.type = &type;
        const std::size_t row = channel.t.size();
        channel.t.push_back(seconds_between(*origin, event.time));
        flatten(message, "", [&](const std::string& name, const Json& value) {
          auto found = channel.known.find(name);
          if (found == channel.known.end()) {
            Column column{.kind = kind_of(value)};
            const std::string field = without_places(name, column.place);
            std::vector<Column>& columns = channel.columns[field];
            if (columns.empty()) channel.fields.push_back(field);
            columns.push_back(std::move(column));
            found = channel.known.try_emplace(name, field, columns.size() - 1).first;
          }
          channel.columns[found->second.first][found->second.second].put(value, row);
        });
      });
  Json about{{"log", std::filesystem::path{log}.filename().string()}, {"fathom_version", std::string{version()}}};
  about["begin_us"] = origin ? Json(*origin) : Json(nullptr);
  about["channels"] = Json::object();
  std::vector<Array> arrays;
  for (auto& [name, channel] : all) {
    Array t{.name = name + "/t", .type = "<f8", .shape = {channel.t.size()}};
    t.bytes.resize(8 * channel.t.size());
    for (std::size_t i = 0; i < channel.t.size(); ++i) put_bytes(t.bytes, i, channel.t[i]);
    arrays.push_back(std::move(t));
    Json fields = Json::object();
    describe(Definitions::built_in(), *channel.type, "", fields);
    about["channels"][name] = {{"type", channel.type->package + "." + channel.type->name},
                               {"comment", channel.type->comment},
                               {"fields", fields}};
    for (const std::string& field : channel.fields)
      arrays.push_back(array_of(name + "/" + field, channel.columns.at(field), channel.t.size()));
    channel.columns.clear();
  }
  arrays.push_back(
      recordings::numpy::text_array("about", {about.dump(-1, ' ', false, Json::error_handler_t::replace)}, {}));
  recordings::numpy::write_npz(file, arrays);
  return exported;
}

}  // namespace fathom::exports
