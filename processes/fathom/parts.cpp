#include "processes/fathom/parts.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <memory>
#include <set>
#include <sstream>
#include <type_traits>
#include <utility>

#include "common/base/error.hpp"
#include "common/estimation/run_signals.hpp"
#include "common/tables/import.hpp"
#include "common/wire/log_parts.hpp"
#include "common/wire/streams.hpp"
#include "processes/fathom/inputs.hpp"

namespace fathom::tool {
namespace {

/// visit(stream, stream of the other) for each.
template <class One, class Other, class Visit>
void visit_both(One& one, Other& other, Visit visit) {
  wire::visit_streams(one, [&](const char*, auto& mine) {
    wire::visit_streams(other, [&](const char*, auto& theirs) {
      if constexpr (std::is_same_v<std::decay_t<decltype(mine)>, std::decay_t<decltype(theirs)>>) visit(mine, theirs);
    });
  });
}

/// One source, part after part.
class Parts {
 public:
  Parts(const Source& source, const GroupOptions& options) : source_{source}, options_{options} {
    const std::string& path = source.files.front();
    if (source.lcm) {
      log_ = std::make_unique<wire::LogParts>(path);
    } else if (source.is_table()) {
      mapped_ = std::make_unique<tables::MappedTable>(tables::read_mapped(path, options.map));
      table_ = std::make_unique<tables::TableImport>(mapped_->table, std::move(mapped_->map), options.simulated);
    } else if (source.has_topics()) {
      topics_ = parted_import(source, options.map, options.simulated, said_);
      if (topics_->recordings() != 1) refuse_several(topics_->recordings());
    }
  }

  bool next(Recording& part) {
    part = {};
    const double before = share();
    if (before > 0.0 && before < 1.0) even(before);
    if (log_) return log_->next(most_, part);
    if (table_ || topics_) return next_rows(part);
    if (std::exchange(read_, true)) return false;
    FromSource all = read_source(source_, options_.map, options_.simulated);
    said_ = std::move(all.notes);
    if (all.runs.size() != 1) refuse_several(all.runs.size());
    part = std::move(all.runs.front());
    return true;
  }

  [[nodiscard]] bool ended() const { return log_ || table_ || topics_ ? share() >= 1.0 : read_; }

  /// After the last part.
  [[nodiscard]] std::vector<std::string> notes() {
    const std::string& path = source_.files.front();
    if (log_) {
      std::istringstream lines{wire::complaints(path, log_->report())};
      for (std::string line; std::getline(lines, line);) said_.push_back(line);
    } else if (table_) {
      for (const auto& some : {mapped_->notes, table_->finish()}) {
        for (const std::string& note : some) said_.push_back(path + ": " + note);
      }
    } else if (topics_) {
      for (std::string& note : topics_->finish()) said_.push_back(std::move(note));
    }
    return std::move(said_);
  }

 private:
  [[noreturn]] void refuse_several(std::size_t count) const {
    throw InputError(source_.files.front() + ": holds " + std::to_string(count) +
                     " recordings, one behind the other; 'fathom import' writes each to a log of its own");
  }
  /// Of the source that has been read, 0 to 1.
  [[nodiscard]] double share() const {
    if (log_) return log_->share();
    if (topics_) return read_ ? 1.0 : topics_->share();
    if (!table_) return 0.0;
    const auto rows = static_cast<double>(mapped_->table.rows());
    return read_ || rows == 0.0 ? 1.0 : std::min(static_cast<double>(rows_) / rows, 1.0);
  }
  /// After the first part: the others alike, so that the last is no splinter of which nothing can be said.
  void even(double taken) {
    if (std::exchange(evened_, true)) return;
    const double left = (1.0 - taken) / taken;
    most_ = static_cast<std::size_t>(static_cast<double>(most_) * std::max(left / std::ceil(left), 0.05));
  }
  bool next_rows(Recording& part) {
    constexpr std::size_t kRows = 5'000;
    bool any = false;
    Recording some;
    while (!read_ && wire::bytes_of(part) < most_) {
      some = {};
      read_ = !(table_ ? table_->next(kRows, some) : topics_->next(kRows, some));
      if (read_) break;
      any = true;
      rows_ += kRows;
      part.one_estimate = part.one_estimate || some.one_estimate;
      visit_both(part, some, [](auto& all, auto& more) {
        all.insert(all.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
      });
    }
    return any;
  }

  const Source& source_;
  const GroupOptions& options_;
  std::unique_ptr<wire::LogParts> log_;
  std::unique_ptr<tables::MappedTable> mapped_;
  std::unique_ptr<tables::TableImport> table_;
  std::unique_ptr<recordings::PartedImport> topics_;
  std::size_t most_{options_.most}, rows_{};
  bool read_{}, evened_{};
  std::vector<std::string> said_;
};

std::string name_of(const std::string& run, Utime origin, Utime begin) {
  char text[48];
  std::snprintf(text, sizeof text, " from %.0f s", seconds_between(origin, begin));
  return run + text;
}

}  // namespace

std::vector<std::string> names_of_runs(const std::vector<std::string>& paths) {
  std::vector<std::string> names;
  std::set<std::string> known;
  for (const std::string& path : paths) {
    const std::vector<Source> found = sources_of({path});
    if (found.size() != 1) throw InputError(path + ": holds " + std::to_string(found.size()) + " recordings");
    std::string name = found.front().name;
    if (known.contains(name))
      name = (std::filesystem::path{path}.parent_path().filename() / name).string();  // day2/run
    if (!known.insert(name).second)
      throw InputError(path + ": a second recording named " + name + "; give each run once, under its own name");
    for (const std::string& other : paths) {
      if (&other == &path) break;
      std::error_code unknown;
      if (std::filesystem::equivalent(other, path, unknown)) throw InputError(path + ": this is " + other + " again");
    }
    names.push_back(std::move(name));
  }
  return names;
}

void in_groups(const std::vector<std::string>& paths, const GroupOptions& options, std::vector<std::string>& notes,
               const std::function<void(std::vector<RunPart>&)>& use) {
  const std::vector<std::string> names = names_of_runs(paths);
  std::vector<RunPart> group;
  std::size_t held = 0;
  const auto close = [&] {
    if (!group.empty()) use(group);
    group.clear();
    held = 0;
  };
  for (std::size_t run = 0; run < paths.size(); ++run) {
    const Source source = sources_of({paths[run]}).front();
    Parts parts{source, options};
    Recording part, before;
    Utime origin = 0;
    bool more = parts.next(part);
    for (bool first = true; more; first = false) {
      const std::size_t bytes = wire::bytes_of(part);
      if (bytes == 0 && !first) break;
      if (held + bytes > options.most) close();
      RunPart one{.recording = std::move(part), .run = run};
      visit_both(before, one.recording, [](auto& last, auto& stream) {
        if (!last.empty()) stream.insert(stream.begin(), last.back());
        if (!stream.empty()) last.assign(1, stream.back());
      });
      const Utime begin = estimation::first_stamp(one.recording);
      if (first) origin = begin;
      one.recording.name = first ? names[run] : name_of(names[run], origin, begin);
      held += bytes;
      group.push_back(std::move(one));
      // What was read is looked at before more is read: no two parts of a long recording are held.
      if (!parts.ended()) close();
      more = parts.next(part);
    }
    for (std::string& note : parts.notes()) notes.push_back(std::move(note));
  }
  close();
}

namespace {

constexpr double kShortestStretch = 120.0;  // s: longer than what a vehicle remembers, with a part of it to judge by

/// What is kept of a recording, part after part: of each of n parts the n-th share, from its beginning.
class Kept {
 public:
  void take(Recording part) {
    const std::size_t number = parts_++;
    if (number % every_ != 0) return;
    const Utime begin = estimation::first_stamp(part);
    Utime end = begin;
    wire::visit_streams(part, [&](const char*, const auto& stream) {
      if (!stream.empty()) end = std::max(end, stream.back().utime);
    });
    length_ = std::max(length_, seconds_between(begin, end));
    stretches_.push_back({std::move(part), begin, end});
    if (parts_ == 1) return;
    while (length_ < kShortestStretch * static_cast<double>(stretches_.size()) && stretches_.size() > 1) {
      std::vector<Stretch> half;
      for (std::size_t i = 0; i < stretches_.size(); i += 2) half.push_back(std::move(stretches_[i]));
      stretches_ = std::move(half);
      every_ *= 2;
    }
    for (Stretch& one : stretches_) {
      const auto to = one.begin + (one.end - one.begin) / static_cast<Utime>(stretches_.size());
      wire::visit_streams(one.recording, [&](const char*, auto& stream) {
        const auto beyond = std::ranges::upper_bound(stream, to, {}, [](const auto& sample) { return sample.utime; });
        stream.erase(beyond, stream.end());
        stream.shrink_to_fit();
      });
    }
  }
  [[nodiscard]] bool whole() const { return parts_ <= 1; }
  [[nodiscard]] std::size_t count() const { return stretches_.size(); }
  [[nodiscard]] double seconds() const { return length_ / static_cast<double>(std::max<std::size_t>(1, count())); }
  /// The last part may be short, and its share of no use.
  void finish() {
    const auto count = static_cast<double>(stretches_.size());
    std::erase_if(stretches_, [&](const Stretch& one) {
      return count > 1.0 && seconds_between(one.begin, one.end) < 0.5 * kShortestStretch * count;
    });
  }
  void move_to(std::vector<Recording>& recordings) {
    for (Stretch& one : stretches_) recordings.push_back(std::move(one.recording));
  }

 private:
  struct Stretch {
    Recording recording;
    Utime begin{}, end{};  ///< of the part that it is the beginning of
  };
  std::vector<Stretch> stretches_;
  std::size_t parts_{}, every_{1};
  double length_{};  ///< s, of the longest part
};

}  // namespace

Stretched read_stretches(const std::vector<std::string>& paths, const GroupOptions& options,
                         std::vector<std::string>& notes) {
  std::vector<Kept> kept(paths.size());
  in_groups(paths, options, notes, [&](std::vector<RunPart>& group) {
    for (RunPart& part : group) kept[part.run].take(std::move(part.recording));
  });
  Stretched all;
  for (std::size_t run = 0; run < kept.size(); ++run) {
    if (!kept[run].whole()) {
      kept[run].finish();
      char text[160];
      std::snprintf(text, sizeof text,
                    ": %zu stretches of some %.0f s, spread evenly over it, stand for all of it: more would not fit "
                    "into memory",
                    kept[run].count(), kept[run].seconds());
      notes.push_back(paths[run] + text);
    }
    all.run.insert(all.run.end(), kept[run].count(), run);
    kept[run].move_to(all.recordings);
  }
  return all;
}

}  // namespace fathom::tool
