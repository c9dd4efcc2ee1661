#include "common/exports/channel_tables.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/event_format.hpp"
#include "common/exports/separated_text.hpp"
#include "common/exports/table_message.hpp"

namespace fathom::exports {
namespace {

namespace fs = std::filesystem;

constexpr const char* kOrigin = "first message logged at [us since the epoch]: ";

/// "OPERATOR" of "Channel OPERATOR: what the human wants."; empty for a part of other types.
std::string channel_of(const Type& type) {
  constexpr std::string_view kBegin = "Channel ";
  if (!type.comment.starts_with(kBegin)) return {};
  return type.comment.substr(kBegin.size(), type.comment.find(':') - kBegin.size());
}

bool is_fixed(const Field& field) {
  return std::ranges::all_of(field.sizes, [](const std::string& size) {
    return std::ranges::all_of(size, [](char c) { return c >= '0' && c <= '9'; });
  });
}

/// An array of bytes with a length of its own: only that length stands in a table.
bool is_only_counted(const Field& field) { return field.type == "byte" && !field.sizes.empty() && !is_fixed(field); }

/// Whether the columns are those of a type: each of its fields, and no other. An array may be without any element.
bool fits(const Type& type, const std::set<std::string>& fields) {
  std::size_t known = 0;
  for (const Field& field : type.fields) {
    const bool there = fields.contains(field.name);
    if (!there && is_fixed(field)) return false;
    known += there ? 1 : 0;
  }
  return known == fields.size();
}

std::optional<Utime> origin_of(const fs::path& folder) {
  std::ifstream about{folder / "columns.txt", std::ios::binary};
  for (std::string line; std::getline(about, line);) {
    if (!line.starts_with(kOrigin)) continue;
    return whole_of(line.substr(std::string_view{kOrigin}.size()));
  }
  return std::nullopt;
}

/// A table on its way to messages; the next one is looked at before it is taken.
class Outgoing {
 public:
  explicit Outgoing(const ChannelTable& table)
      : channel_{table.channel}, text_{table.path}, origin_{origin_of(fs::path{table.path}.parent_path())} {
    static_cast<void>(text_.next(cells_));
    message_ = std::make_unique<TableMessage>(Definitions::built_in(), *table.type, table.path, cells_);
    advance();
  }
  [[nodiscard]] bool done() const { return done_; }
  [[nodiscard]] Utime time() const { return time_; }
  [[nodiscard]] const std::string& channel() const { return channel_; }
  [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }
  void advance() {
    done_ = !text_.next(cells_);
    if (done_) return;
    message_->encode(cells_, text_.line(), bytes_);
    time_ = origin_ ? *origin_ + message_->microseconds("t", cells_, text_.line())
                    : message_->whole("utime", cells_, text_.line());
  }

 private:
  std::string channel_;
  SeparatedText text_;
  std::optional<Utime> origin_;
  std::vector<std::string> cells_;
  std::unique_ptr<TableMessage> message_;
  std::vector<std::uint8_t> bytes_;
  Utime time_{};
  bool done_{};
};

/// Writes beside its place, and takes it when all is written.
class EventFile {
 public:
  explicit EventFile(std::string path) : path_{std::move(path)}, file_{path_ + ".part", std::ios::binary} {
    if (!file_) throw InputError(path_ + ": cannot be written; check that the folder exists and is yours");
  }
  ~EventFile() {
    std::error_code ignored;
    if (file_.is_open()) fs::remove(path_ + ".part", ignored);
  }
  EventFile(const EventFile&) = delete;
  EventFile& operator=(const EventFile&) = delete;

  void write(const Outgoing& event) {
    std::vector<std::uint8_t> head{event_format::kSync.begin(), event_format::kSync.end()};
    append_big(head, events_++);
    append_big(head, static_cast<std::uint64_t>(event.time()));
    append_big(head, static_cast<std::uint32_t>(event.channel().size()));
    append_big(head, static_cast<std::uint32_t>(event.bytes().size()));
    put(head.data(), head.size());
    put(event.channel().data(), event.channel().size());
    put(event.bytes().data(), event.bytes().size());
  }
  void finish() {
    file_.close();
    std::error_code failed;
    if (file_) fs::rename(path_ + ".part", path_, failed);
    if (!file_ || failed) throw InputError(path_ + ": writing failed; is the disk full?");
  }

 private:
  void put(const void* bytes, std::size_t count) {
    file_.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(count));
  }

  std::string path_;
  std::ofstream file_;
  std::uint64_t events_{};
};

}  // namespace

std::string line_of_origin(Utime origin) { return kOrigin + std::to_string(origin); }

std::optional<ChannelTable> channel_table(const std::string& path) {
  std::vector<std::string> names;
  try {
    if (SeparatedText text{path}; !text.next(names)) return std::nullopt;
  } catch (const InputError&) {
    return std::nullopt;
  }
  if (names.size() < 3 || names[0] != "t" || names[1] != "utime") return std::nullopt;
  std::set<std::string> fields;
  for (std::size_t i = 1; i < names.size(); ++i) fields.insert(names[i].substr(0, names[i].find_first_of("[.")));
  for (const auto& [name, type] : Definitions::built_in().all()) {
    const std::string channel = channel_of(type);
    if (!channel.empty() && fits(type, fields)) return ChannelTable{path, channel, &type};
  }
  return std::nullopt;
}

Restored from_csv(std::span<const ChannelTable> tables, const std::string& log) {
  Restored restored;
  std::vector<std::unique_ptr<Outgoing>> events;
  for (const ChannelTable& table : tables) {
    if (std::ranges::any_of(table.type->fields, is_only_counted)) {
      restored.note += (restored.note.empty() ? "left out: " : ", ") + table.channel +
                       " (a table counts its bytes and does not hold them)";
      continue;
    }
    events.push_back(std::make_unique<Outgoing>(table));
  }
  if (events.empty()) throw InputError(tables.front().path + ": no table holds whole messages; " + restored.note);
  EventFile file{log};
  while (true) {
    Outgoing* next = nullptr;
    for (const auto& one : events) {
      if (!one->done() && (next == nullptr || one->time() < next->time())) next = one.get();
    }
    if (next == nullptr) break;
    file.write(*next);
    ++restored.written[next->channel()];
    next->advance();
  }
  file.finish();
  return restored;
}

}  // namespace fathom::exports
