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
  append(to.signals, std::move(from.signals));
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

/// The topic that holds all columns of a stream; what a name was taken for goes to `notes`.
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

/// Rows of one recording of a topic as a table, in the order of time. A message that stands there twice, as in bags
/// whose index was made anew and in files that were joined to themselves, is one; `twice` counts them. Of the last
/// recording the rows are taken over: an hour at 400 Hz must not stand in memory three times.
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

/// Takes the samples until `end` out of `from`.
void split(Recording& from, Utime end, Recording& out) {
  const auto take = [&](auto& stream, auto& into) {
    const auto beyond = std::ranges::upper_bound(stream, end, {}, [](const auto& sample) { return sample.utime; });
    into.insert(into.end(), std::make_move_iterator(stream.begin()), std::make_move_iterator(beyond));
    stream.erase(stream.begin(), beyond);
  };
  take(from.ahrs, out.ahrs);  // those that an attitude turns
  take(from.dvl, out.dvl);
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

/// One recording: its tables, and the streams that are made of them.
class PartedImport::Run {
 public:
  Run(Content& content, const std::vector<tables::MappedStream>& streams,
      const std::vector<std::optional<std::size_t>>& topics, std::uint32_t recording,
      const std::optional<tables::SimulatedAxes>& simulated, bool strict)
      : strict_{strict} {
    std::vector<TopicStamps> stamps;
    std::map<std::size_t, std::size_t> place;  // of a topic among `stamps` and `tables_`
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
    AlignedClocks aligned = align_clocks(stamps);
    notes_ = std::move(aligned.notes);
    tables_.resize(stamps.size());
    for (const auto& [topic, at] : place) {
      std::size_t twice = 0;
      if (stamps[at].stamps.empty()) continue;
      tables_[at] = std::make_unique<tables::CsvTable>(table_of(content, topic, recording, aligned.times[at], twice));
      aligned.times[at] = {};
      if (twice > 0)
        notes_.push_back(stamps[at].topic + ": " + std::to_string(twice) +
                         " messages stand there twice (same time, same numbers) and are taken once");
    }
    for (std::size_t s = 0; s < streams.size(); ++s) {
      if (!topics[s]) continue;
      const std::size_t at = place[*topics[s]];
      if (tables_[at] == nullptr) {
        notes_.push_back(streams[s].name + ": no message of " + stamps[at].topic);
        continue;
      }
      tables::ColumnMap map = streams[s].map;
      if (map.time.columns.empty()) map.time.columns = {{tables::kOwnTime, ""}};
      try {
        streams_.push_back({.name = streams[s].name,
                            .topic = stamps[at].topic,
                            .import = std::make_unique<tables::TableImport>(*tables_[at], std::move(map), simulated),
                            .held = {}});
      } catch (const InputError& error) {
        leave_out(streams[s].name, error);
      }
    }
  }

  bool next(std::size_t rows, Recording& out) {
    std::optional<Utime> end;
    bool left = false;
    for (Stream& one : streams_) {
      if (one.import->all_at_once()) {
        if (one.import->rows_left() > 0) (void)one.import->next(rows, one.held);
        left = left || !one.held.ahrs.empty() || !one.held.dvl.empty();
      } else if (const auto own = one.import->end_of_next(rows)) {
        end = std::min(end.value_or(*own), *own);
      }
    }
    if (!end && !left) return false;
    for (Stream& one : streams_) {
      Recording some;
      if (one.import->all_at_once()) {
        split(one.held, end.value_or(kLatest), some);
      } else {
        (void)one.import->next_until(end.value_or(kLatest), some);
      }
      append(out, std::move(some));
    }
    return true;
  }

  /// What was refused; whether anything came.
  bool finish() {
    bool any = false;
    for (Stream& one : streams_) {
      try {
        for (const std::string& note : one.import->finish()) {
          if (!note.starts_with("columns not used")) notes_.push_back(one.topic + ": " + note);
        }
        any = true;
      } catch (const InputError& error) {
        leave_out(one.name, error);
      }
    }
    return any;
  }

  [[nodiscard]] double share() const {
    double all = 0.0, left = 0.0;
    for (const Stream& one : streams_) {
      all += static_cast<double>(one.import->rows());
      left += static_cast<double>(one.import->rows_left());
    }
    return all > 0.0 ? 1.0 - left / all : 1.0;
  }
  std::vector<std::string> notes() { return std::move(notes_); }
  [[nodiscard]] const std::vector<std::string>& reasons() const { return reasons_; }

 private:
  struct Stream {
    std::string name, topic;
    std::unique_ptr<tables::TableImport> import;
    Recording held;  ///< of what comes all at once, the samples that are not given yet
  };

  void leave_out(const std::string& stream, const InputError& error) {
    if (strict_) throw InputError(error);
    reasons_.push_back(stream + " left out: " + error.what());
    notes_.push_back(reasons_.back());
  }

  bool strict_;
  std::vector<std::unique_ptr<tables::CsvTable>> tables_;
  std::vector<Stream> streams_;
  std::vector<std::string> notes_, reasons_;
};

PartedImport::PartedImport(const Files& files, std::vector<tables::MappedStream> streams,
                           std::optional<tables::SimulatedAxes> simulated, bool strict)
    : streams_{std::move(streams)}, simulated_{std::move(simulated)}, strict_{strict} {
  std::set<std::string> columns;
  for (const tables::MappedStream& stream : streams_) columns.insert(stream.columns.begin(), stream.columns.end());
  content_ = read_files(files, std::move(columns), Collector::Take::kColumns);
  for (const std::string& note : remarks(content_)) notes_.push_back(content_.path() + ": " + note);
  require_messages(content_);
  for (const tables::MappedStream& stream : streams_) {
    topics_.push_back(topic_of(stream, content_, strict_, notes_));
    if (!topics_.back()) notes_.push_back(stream.name + " left out: no topic holds all columns of " + stream.where);
  }
}

PartedImport::~PartedImport() = default;

std::size_t PartedImport::recordings() const { return content_.topics->recordings(); }

std::unique_ptr<PartedImport::Run> PartedImport::run(std::uint32_t recording) {
  // A short start that lacks what a long one has is no reason to refuse the long one.
  return std::make_unique<Run>(content_, streams_, topics_, recording, simulated_, strict_ && recordings() == 1);
}

bool PartedImport::next(std::size_t rows, Recording& out) {
  if (run_ == nullptr) run_ = run(0);
  return run_->next(rows, out);
}

double PartedImport::share() const { return run_ == nullptr ? 0.0 : run_->share(); }

std::vector<std::string> PartedImport::finish() {
  if (run_ == nullptr) run_ = run(0);
  if (!run_->finish()) nothing(run_->reasons());
  std::vector<std::string> notes = std::move(notes_);
  for (const std::string& note : run_->notes()) notes.push_back(content_.path() + ": " + note);
  return notes;
}

void PartedImport::nothing(const std::vector<std::string>& reasons) const {
  throw InputError(content_.path() + ": holds nothing of what the map names" +
                   (reasons.empty() ? "" : ": " + reasons.front()) +
                   "; 'fathom import --describe' lists what is there");
}

ImportedFiles PartedImport::all() {
  constexpr std::size_t kRows = 50'000;
  ImportedFiles out{.runs = {}, .notes = std::move(notes_)};
  std::vector<std::string> why;
  for (std::uint32_t r = 0; r < recordings(); ++r) {
    const std::unique_ptr<Run> one = run(r);
    ImportedRun done;
    for (Recording part; one->next(kRows, part); part = {}) append(done.recording, std::move(part));
    const bool any = one->finish();
    done.notes = one->notes();
    if (!any) {
      if (why.empty()) why = one->reasons();
      out.notes.push_back(content_.path() + ": recording " + std::to_string(r + 1) + " of " +
                          std::to_string(recordings()) + " holds nothing that the map names");
      continue;
    }
    done.recording.name = std::filesystem::path(content_.path()).stem().string();
    if (recordings() > 1) done.recording.name += "-" + std::to_string(r + 1);
    out.runs.push_back(std::move(done));
  }
  if (out.runs.empty()) nothing(why);
  return out;
}

ImportedFiles import_files(const Files& files, const std::vector<tables::MappedStream>& streams,
                           const std::optional<tables::SimulatedAxes>& simulated, bool strict) {
  return PartedImport{files, streams, simulated, strict}.all();
}

}  // namespace fathom::recordings
