#include "common/recordings/import.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/near_name.hpp"
#include "common/recordings/clocks.hpp"
#include "common/recordings/joined_parts.hpp"
#include "common/tables/import.hpp"
#include "common/tables/readers.hpp"

namespace fathom::recordings {
namespace {

template <class Sample>
void append(std::vector<Sample>& to, std::vector<Sample>&& from) {
  to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
  if (!std::ranges::is_sorted(to, {}, &Sample::utime)) std::ranges::stable_sort(to, {}, &Sample::utime);
}

void append(Recording& to, Recording&& from) {
  append(to.pose_capture, std::move(from.pose_capture));
  append(to.ahrs, std::move(from.ahrs));
  append(to.dvl, std::move(from.dvl));
  append(to.depth, std::move(from.depth));
  append(to.thrusters, std::move(from.thrusters));
  append(to.battery, std::move(from.battery));
  append(to.usbl, std::move(from.usbl));
  append(to.ranges, std::move(from.ranges));
  append(to.loads, std::move(from.loads));
  append(to.tag_pose, std::move(from.tag_pose));
  append(to.optical_flow, std::move(from.optical_flow));
  append(to.laser_range, std::move(from.laser_range));
}

std::string topics_of(const Content& content) {
  std::string text;
  for (const TopicAccount& each : content.topics->topics()) text += (text.empty() ? "" : ", ") + each.topic.name;
  return text;
}

[[noreturn]] void no_such_column(const std::string& column, const tables::MappedStream& stream,
                                 const Content& content) {
  const std::string begin = stream.where + ": column '" + column + "' ";
  for (const TopicAccount& each : content.topics->topics()) {
    if (!column.starts_with(each.topic.name + ".")) continue;
    const std::string wanted = column.substr(each.topic.name.size() + 1);
    std::string fields;
    for (const Field& field : each.topic.fields) {
      if (looks_like(wanted, field.name))
        throw InputError(begin + "is not in " + content.path() + " (did you mean '" + each.topic.name + "." +
                         field.name + "'?)");
      fields += (fields.empty() ? "" : ", ") + field.name;
    }
    throw InputError(begin + "is not in " + content.path() + "; fields of " + each.topic.name + " are: " + fields);
  }
  throw InputError(begin + "is of no topic of " + content.path() + "; topics are: " + topics_of(content));
}

/// The topic that holds all columns of a stream.
std::optional<std::size_t> topic_of(const tables::MappedStream& stream, const Content& content, bool strict) {
  std::optional<std::size_t> topic;
  const auto& rows = content.topics->rows();
  for (const std::string& column : stream.columns) {
    const auto found = std::ranges::find_if(
        rows, [&](const TopicRows& one) { return std::ranges::find(one.names, column) != one.names.end(); });
    if (found == rows.end()) {
      if (!strict) return std::nullopt;
      no_such_column(column, stream, content);
    }
    const auto number = static_cast<std::size_t>(found - rows.begin());
    if (topic && *topic != number)
      throw InputError(stream.where + ": '" + stream.columns.front() + "' and '" + column +
                       "' come from two topics, which have times of their own; write '" + stream.name +
                       ":' as a list of one entry per topic");
    topic = number;
  }
  return topic;
}

/// Rows of one recording of a topic as a table, in the order of time. A message that stands there twice, as in bags
/// whose index was made anew and in files that were joined to themselves, is one; `twice` counts them.
tables::CsvTable table_of(const Content& content, std::size_t topic, std::uint32_t recording,
                          const std::vector<std::int64_t>& times, std::size_t& twice) {
  const TopicRows& rows = content.topics->rows()[topic];
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < rows.stamps.size(); ++i) {
    if (rows.recording[i] == recording) order.push_back(i);
  }
  std::vector<std::size_t> sorted(order.size());
  std::iota(sorted.begin(), sorted.end(), std::size_t{0});
  std::ranges::stable_sort(sorted, {}, [&](std::size_t i) { return times[i]; });
  const auto same = [&](std::size_t a, std::size_t b) {
    return times[a] == times[b] && std::ranges::all_of(rows.columns, [&](const std::vector<double>& column) {
             const double x = column[order[a]], y = column[order[b]];
             return x == y || (std::isnan(x) && std::isnan(y));
           });
  };
  const auto repeated = std::ranges::unique(sorted, same);
  twice = repeated.size();
  sorted.erase(repeated.begin(), repeated.end());
  tables::CsvTable table;
  table.path = content.path() + ": " + content.topics->topics()[topic].topic.name;
  table.names.push_back(tables::kOwnTime);
  table.columns.emplace_back();
  for (const std::size_t i : sorted) {
    table.columns.back().push_back(1e-6 * static_cast<double>(times[i]));
    table.lines.push_back(order[i] + 1);
  }
  for (std::size_t c = 0; c < rows.names.size(); ++c) {
    table.names.push_back(rows.names[c]);
    table.columns.emplace_back();
    for (const std::size_t i : sorted) table.columns.back().push_back(rows.columns[c][order[i]]);
  }
  table.faults.resize(table.names.size());
  return table;
}

/// Streams of one recording, all on one clock.
std::optional<ImportedRun> import_run(Content& content, const std::vector<tables::MappedStream>& streams,
                                      const std::vector<std::optional<std::size_t>>& topics, std::uint32_t recording,
                                      const std::optional<tables::SimulatedAxes>& simulated, bool strict,
                                      std::vector<std::string>& reasons) {
  ImportedRun run;
  std::vector<TopicStamps> stamps;
  std::map<std::size_t, std::size_t> place;  // of a topic among `stamps`
  for (const auto& topic : topics) {
    if (!topic || place.contains(*topic)) continue;
    const TopicRows& rows = content.topics->rows()[*topic];
    place[*topic] = stamps.size();
    TopicStamps& one = stamps.emplace_back();
    one.topic = content.topics->topics()[*topic].topic.name;
    for (std::size_t i = 0; i < rows.stamps.size(); ++i) {
      if (rows.recording[i] == recording) one.stamps.push_back(rows.stamps[i]);
    }
  }
  const AlignedClocks aligned = align_clocks(stamps);
  run.notes = aligned.notes;
  bool any = false;
  for (std::size_t s = 0; s < streams.size(); ++s) {
    if (!topics[s]) continue;
    const TopicStamps& own = stamps[place[*topics[s]]];
    if (own.stamps.empty()) {
      run.notes.push_back(streams[s].name + ": no message of " + own.topic);
      continue;
    }
    std::size_t twice = 0;
    const tables::CsvTable table = table_of(content, *topics[s], recording, aligned.times[place[*topics[s]]], twice);
    if (twice > 0)
      run.notes.push_back(own.topic + ": " + std::to_string(twice) +
                          " messages stand there twice (same time, same numbers) and are taken once");
    const bool last =
        recording + 1 == content.topics->recordings() &&
        std::ranges::count(topics.begin() + static_cast<std::ptrdiff_t>(s) + 1, topics.end(), topics[s]) == 0;
    if (last) content.topics->release(*topics[s]);  // an hour at 400 Hz must not stand in memory three times
    tables::ColumnMap map = streams[s].map;
    if (map.time.columns.empty()) map.time.columns = {{tables::kOwnTime, ""}};
    try {
      tables::Imported imported = tables::import_table(table, std::move(map), simulated);
      append(run.recording, std::move(imported.recording));
      for (const std::string& note : imported.notes) {
        if (!note.starts_with("columns not used")) run.notes.push_back(own.topic + ": " + note);
      }
      any = true;
    } catch (const InputError& error) {
      if (strict) throw;
      reasons.push_back(streams[s].name + " left out: " + error.what());
      run.notes.push_back(reasons.back());
    }
  }
  if (!any) return std::nullopt;
  return run;
}

}  // namespace

Content read_files(const Files& files, std::set<std::string> columns, Collector::Take take) {
  Content content{.files = files, .topics = {}, .damage = {}};
  content.topics = std::make_unique<Collector>(files.format->clock, std::move(columns), take);
  JoinedParts joined{*content.topics};
  for (const std::string& path : files.paths) {
    Sink* sink = content.topics.get();
    if (files.paths.size() > 1) {
      joined.next_part();
      sink = &joined;
    }
    if (files.read) {
      files.read(path, *sink, content.damage);
    } else {
      files.format->read(path, *sink, content.damage);
    }
  }
  content.topics->finish();
  return content;
}

std::vector<std::string> remarks(const Content& content) {
  std::vector<std::string> notes;
  for (const std::string& sentence : content.damage.sentences()) notes.push_back("not read: " + sentence);
  if (const std::uint64_t refused = content.topics->refused(); refused > 0) {
    std::string topics;
    for (const TopicAccount& each : content.topics->topics()) {
      if (each.refused > 0)
        topics += (topics.empty() ? "" : ", ") + each.topic.name + " " + std::to_string(each.refused);
    }
    notes.push_back("left out: " + std::to_string(refused) + " messages whose time fits nothing around them (" +
                    topics + ")");
  }
  return notes;
}

void require_messages(const Content& content) {
  if (content.topics->messages() > 0) return;
  std::string why;
  for (const std::string& remark : remarks(content)) why += "; " + remark;
  throw InputError(content.path() + ": holds no message that can be read" + why);
}

ImportedFiles import_files(const Files& files, const std::vector<tables::MappedStream>& streams,
                           const std::optional<tables::SimulatedAxes>& simulated, bool strict) {
  std::set<std::string> columns;
  for (const tables::MappedStream& stream : streams) columns.insert(stream.columns.begin(), stream.columns.end());
  Content content = read_files(files, std::move(columns), Collector::Take::kColumns);
  ImportedFiles out;
  for (const std::string& note : remarks(content)) out.notes.push_back(content.path() + ": " + note);
  require_messages(content);
  std::vector<std::optional<std::size_t>> topics;
  for (const tables::MappedStream& stream : streams) {
    topics.push_back(topic_of(stream, content, strict));
    if (!topics.back()) out.notes.push_back(stream.name + " left out: no topic holds all columns of " + stream.where);
  }
  const std::uint32_t recordings = content.topics->recordings();
  std::string why;
  for (std::uint32_t r = 0; r < recordings; ++r) {
    // A short start that lacks what a long one has is no reason to refuse the long one.
    std::vector<std::string> reasons;
    std::optional<ImportedRun> run =
        import_run(content, streams, topics, r, simulated, strict && recordings == 1, reasons);
    if (!run) {
      if (why.empty() && !reasons.empty()) why = ": " + reasons.front();
      out.notes.push_back(content.path() + ": recording " + std::to_string(r + 1) + " of " +
                          std::to_string(recordings) + " holds nothing that the map names");
      continue;
    }
    run->recording.name = std::filesystem::path(content.path()).stem().string();
    if (recordings > 1) run->recording.name += "-" + std::to_string(r + 1);
    out.runs.push_back(std::move(*run));
  }
  if (out.runs.empty())
    throw InputError(content.path() + ": holds nothing of what the map names" + why +
                     "; 'fathom import --describe' lists what is there");
  return out;
}

}  // namespace fathom::recordings
