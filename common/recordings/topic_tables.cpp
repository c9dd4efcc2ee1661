#include "common/recordings/topic_tables.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/base/error.hpp"
#include "common/base/near_name.hpp"
#include "common/tables/readers.hpp"

namespace fathom::recordings {
namespace {

std::string topics_of(const Content& content) {
  std::string text;
  for (const TopicAccount& each : content.topics->topics()) text += (text.empty() ? "" : ", ") + each.topic.name;
  return text;
}

[[noreturn]] void no_such_column(const std::string& column, const tables::MappedStream& stream,
                                 const Content& content) {
  const std::string begin = stream.where + ": column '" + column + "' ";
  for (const TopicAccount& each : content.topics->topics()) {
    const std::vector<std::string> names = names_of_topic(each.topic.name);
    const auto own =
        std::ranges::find_if(names, [&](const std::string& name) { return column.starts_with(name + "."); });
    if (own == names.end()) continue;
    const std::string wanted = column.substr(own->size() + 1);
    std::string fields;
    for (const Field& field : each.topic.fields) {
      if (looks_like(wanted, field.name))
        throw InputError(begin + "is not in " + content.path() + " (did you mean '" + *own + "." + field.name + "'?)");
      fields += (fields.empty() ? "" : ", ") + field.name;
    }
    throw InputError(begin + "is not in " + content.path() + "; fields of " + each.topic.name + " are: " + fields);
  }
  throw InputError(begin + "is of no topic of " + content.path() + "; topics are: " + topics_of(content));
}

/// Places of the topics that hold a column: the one that is called so, or those that have a number besides.
std::vector<std::size_t> topics_with(const std::string& column, const Content& content) {
  std::vector<std::size_t> found;
  const auto& rows = content.topics->rows();
  const auto& topics = content.topics->topics();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (std::ranges::find(rows[i].names, column) == rows[i].names.end()) continue;
    if (column.starts_with(topics[i].topic.name + ".")) return {i};
    found.push_back(i);
  }
  std::ranges::sort(found, {}, [&](std::size_t i) { return instance_of(topics[i].topic.name); });
  return found;
}

/// Which of several columns of numbers' rows are of one recording, in the order of time.
std::vector<std::size_t> in_time(const TopicRows& rows, std::uint32_t recording, const Paged<std::int64_t>& times,
                                 std::size_t& twice) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < rows.stamps.size(); ++i) {
    if (rows.recording[i] == recording) order.push_back(i);
  }
  std::vector<std::size_t> sorted(order.size());
  std::iota(sorted.begin(), sorted.end(), std::size_t{0});
  std::ranges::stable_sort(sorted, {}, [&](std::size_t i) { return times[i]; });
  const auto same = [&](std::size_t a, std::size_t b) {
    return times[a] == times[b] && std::ranges::all_of(rows.columns, [&](const Paged<double>& column) {
             const double x = column[order[a]], y = column[order[b]];
             return x == y || (std::isnan(x) && std::isnan(y));
           });
  };
  const auto repeated = std::unique(sorted.begin(), sorted.end(), same);
  twice = static_cast<std::size_t>(sorted.end() - repeated);
  sorted.erase(repeated, sorted.end());
  return sorted;
}

}  // namespace

std::optional<std::size_t> topic_of(const tables::MappedStream& stream, const Content& content, bool strict,
                                    std::vector<std::string>& notes) {
  std::optional<std::size_t> topic;
  for (const std::string& column : stream.columns) {
    const std::vector<std::size_t> found = topics_with(column, content);
    if (found.empty()) {
      if (!strict) return std::nullopt;
      no_such_column(column, stream, content);
    }
    const std::size_t number = found.front();
    const std::string& name = content.topics->topics()[number].topic.name;
    if (!topic && !column.starts_with(name + "."))
      notes.push_back(stream.name + ": '" + column + "' is taken from " + name +
                      (found.size() > 1 ? ", the first of " + std::to_string(found.size()) +
                                              "; write its number in the map to take another"
                                        : ""));
    if (topic && *topic != number)
      throw InputError(stream.where + ": '" + stream.columns.front() + "' and '" + column +
                       "' come from two topics, which have times of their own; write '" + stream.name +
                       ":' as a list of one entry per topic");
    topic = number;
  }
  return topic;
}

tables::CsvTable table_of(Content& content, std::size_t topic, std::uint32_t recording,
                          const Paged<std::int64_t>& times, std::size_t& twice) {
  tables::CsvTable table;
  table.path = content.path() + ": " + content.topics->topics()[topic].topic.name;
  table.names.push_back(tables::kOwnTime);
  table.columns.emplace_back();
  Paged<double>& seconds = table.columns.front();
  const bool last = recording + 1 == content.topics->recordings();
  bool rises = content.topics->recordings() == 1;
  for (std::size_t i = 1; rises && i < times.size(); ++i) rises = times[i - 1] < times[i];
  if (rises) {
    TopicRows rows = content.topics->take(topic);
    for (std::size_t i = 0; i < times.size(); ++i) {
      seconds.push_back(1e-6 * static_cast<double>(times[i]));
      table.lines.push_back(i + 1);
    }
    for (std::size_t c = 0; c < rows.names.size(); ++c) {
      table.names.push_back(std::move(rows.names[c]));
      table.columns.push_back(std::move(rows.columns[c]));
    }
  } else {
    const TopicRows& rows = content.topics->rows()[topic];
    const std::vector<std::size_t> sorted = in_time(rows, recording, times, twice);
    std::vector<std::size_t> place;  // of the recording's rows among all
    for (std::size_t i = 0; i < rows.stamps.size(); ++i) {
      if (rows.recording[i] == recording) place.push_back(i);
    }
    for (const std::size_t i : sorted) {
      seconds.push_back(1e-6 * static_cast<double>(times[i]));
      table.lines.push_back(place[i] + 1);
    }
    for (std::size_t c = 0; c < rows.names.size(); ++c) {
      table.names.push_back(rows.names[c]);
      Paged<double>& column = table.columns.emplace_back();
      for (const std::size_t i : sorted) column.push_back(rows.columns[c][place[i]]);
    }
    if (last) static_cast<void>(content.topics->take(topic));
  }
  table.faults.resize(table.names.size());
  return table;
}

}  // namespace fathom::recordings
