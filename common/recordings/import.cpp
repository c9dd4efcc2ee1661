#include "common/recordings/import.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <utility>

#include "common/base/error.hpp"
#include "common/recordings/clocks.hpp"
#include "common/recordings/topic_tables.hpp"
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
