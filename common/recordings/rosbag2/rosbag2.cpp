#include "common/recordings/rosbag2/rosbag2.hpp"

#include <sqlite3.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "common/base/error.hpp"
#include "common/recordings/little.hpp"
#include "common/recordings/ros/channels.hpp"
#include "common/recordings/unpack.hpp"

namespace fathom::recordings::rosbag2 {
namespace {

constexpr std::string_view kMagic{"SQLite format 3\0", 16};
constexpr std::uint32_t kZstd = 0xFD2FB528;                  // a message packed by itself begins with this
constexpr std::size_t kMostMessage = std::size_t{1} << 30U;  // bytes

using Database = std::unique_ptr<sqlite3, decltype(&sqlite3_close)>;
using Statement = std::unique_ptr<sqlite3_stmt, decltype(&sqlite3_finalize)>;

Database open_database(const std::string& path) {
  std::string uri = "file:";
  for (const char c : path) {  // what means something in an address
    if (c == '%' || c == '?' || c == '#') {
      static constexpr std::string_view kHex = "0123456789ABCDEF";
      const auto byte = static_cast<unsigned char>(c);
      uri += std::string{'%'} + kHex[byte >> 4U] + kHex[byte & 0xFU];
    } else {
      uri += c;
    }
  }
  // A journal beside the file holds the last messages; without one the file is all, and is not touched.
  uri += std::filesystem::exists(path + "-wal") ? "?mode=ro" : "?mode=ro&immutable=1";
  sqlite3* made = nullptr;
  const int state = sqlite3_open_v2(uri.c_str(), &made, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
  Database database{made, sqlite3_close};
  if (state != SQLITE_OK) throw InputError(path + ": cannot be opened as a database: " + sqlite3_errmsg(made));
  return database;
}

Statement prepared(const Database& database, const char* query) {
  sqlite3_stmt* made = nullptr;
  if (sqlite3_prepare_v2(database.get(), query, -1, &made, nullptr) != SQLITE_OK) return {nullptr, sqlite3_finalize};
  return {made, sqlite3_finalize};
}

std::string text(const Statement& statement, int column) {
  const unsigned char* words = sqlite3_column_text(statement.get(), column);
  return words == nullptr ? "" : reinterpret_cast<const char*>(words);
}

Bytes blob(const Statement& statement, int column) {
  const auto* bytes = static_cast<const std::uint8_t*>(sqlite3_column_blob(statement.get(), column));
  return bytes == nullptr ? Bytes{}
                          : Bytes{bytes, static_cast<std::size_t>(sqlite3_column_bytes(statement.get(), column))};
}

struct Definition {
  std::string language, text;
};

std::map<std::string, Definition> definitions_in(const Database& database) {
  std::map<std::string, Definition> definitions;  // bags before 2023 have none
  const Statement rows =
      prepared(database, "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions");
  while (rows && sqlite3_step(rows.get()) == SQLITE_ROW)
    definitions[ros::short_name(text(rows, 0))] = {text(rows, 1), text(rows, 2)};
  return definitions;
}

}  // namespace

bool is_sqlite(Bytes head) {
  return head.size() >= kMagic.size() && std::equal(kMagic.begin(), kMagic.end(), head.begin());
}

void read(const std::string& path, Sink& sink, Damage& damage) {
  const std::string shared = path + "-shm";
  const bool was_shared = std::filesystem::exists(shared);
  {
    const Database database = open_database(path);
    const auto refuse = [&] {
      const std::string why = sqlite3_errmsg(database.get());
      throw InputError(path + (why.find("no such table") != std::string::npos
                                   ? ": a database, but no ROS 2 bag (" + why + ")"
                                   : ": cannot be read: " + why + "; 'sqlite3 FILE .recover' may save some of it"));
    };
    const std::map<std::string, Definition> definitions = definitions_in(database);
    const Statement topics = prepared(database, "SELECT id, name, type, serialization_format FROM topics");
    if (!topics) refuse();
    ros::Channels channels{sink, damage};
    std::map<std::int64_t, std::size_t> opened;
    int state = SQLITE_ROW;
    while ((state = sqlite3_step(topics.get())) == SQLITE_ROW) {
      const std::string name = text(topics, 1), type = text(topics, 2), format = text(topics, 3);
      const auto found = definitions.find(ros::short_name(type));
      const Definition definition = found == definitions.end() ? Definition{} : found->second;
      opened[sqlite3_column_int64(topics.get(), 0)] =
          format != "cdr" ? channels.open_unread(name, type, "whose encoding '" + format + "' is not read here")
                          : channels.open(name, type, definition.text,
                                          definition.language == "ros2idl" ? ros::Language::kIdl : ros::Language::kMsg,
                                          ros::Layout::kCdr);
    }
    if (state != SQLITE_DONE) refuse();
    const Statement messages = prepared(database, "SELECT topic_id, timestamp, data FROM messages");
    if (!messages) refuse();
    Unpacked unpacked;
    std::uint64_t read_so_far = 0;
    while ((state = sqlite3_step(messages.get())) == SQLITE_ROW) {
      ++read_so_far;
      const auto channel = opened.find(sqlite3_column_int64(messages.get(), 0));
      if (channel == opened.end()) {
        damage.add("messages of a topic that is not listed");
        continue;
      }
      Bytes bytes = blob(messages, 2);
      if (bytes.size() >= 4 && little<std::uint32_t>(bytes) == kZstd) {
        unpack(Packing::kZstd, bytes, kMostMessage, unpacked);
        if (!unpacked.whole) {
          damage.add("messages that cannot be unpacked");
          continue;
        }
        bytes = unpacked.bytes;
      }
      channels.message(channel->second, sqlite3_column_int64(messages.get(), 1) / 1000, bytes);
    }
    if (state != SQLITE_DONE) {
      if (read_so_far == 0) refuse();
      damage.add("messages behind number " + std::to_string(read_so_far) + ": " + sqlite3_errmsg(database.get()));
    }
  }
  std::error_code ignored;
  if (!was_shared) std::filesystem::remove(shared, ignored);
}

}  // namespace fathom::recordings::rosbag2
