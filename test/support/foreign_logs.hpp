// Recordings of other projects' formats, written by hand as their documents say: what readers are tried with. They
// share no code with the readers.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace fathom::test {

/// Least byte first, as all of these formats have it.
template <class T>
void put(std::string& bytes, T value) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  bytes.append(raw, sizeof(T));
}

template <class... T>
std::string packed(T... values) {
  std::string bytes;
  (put(bytes, values), ...);
  return bytes;
}

inline std::string padded(std::string_view text, std::size_t size) {
  std::string bytes{text.substr(0, size)};
  bytes.resize(size, '\0');
  return bytes;
}

/// ArduPilot DataFlash.
struct DataFlashLog {
  std::string bytes;

  DataFlashLog() { format(128, 89, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns"); }
  void format(int type, int length, std::string_view name, std::string_view letters, std::string_view columns) {
    record(128, packed(static_cast<std::uint8_t>(type), static_cast<std::uint8_t>(length)) + padded(name, 4) +
                    padded(letters, 16) + padded(columns, 64));
  }
  void record(int type, const std::string& payload) {
    bytes += "\xA3\x95";
    bytes += static_cast<char>(type);
    bytes += payload;
  }
};

/// PX4 ULog.
struct UlogLog {
  std::string bytes;

  explicit UlogLog(std::uint64_t start = 0) {
    bytes = std::string("\x55\x4C\x6F\x67\x01\x12\x35\x01", 8) + packed(start);
    message('B', std::string(40, '\0'));
  }
  void message(char kind, const std::string& payload) {
    put(bytes, static_cast<std::uint16_t>(payload.size()));
    bytes += kind;
    bytes += payload;
  }
  void format(const std::string& text) { message('F', text); }
  void subscribe(std::uint8_t instance, std::uint16_t id, const std::string& name) {
    message('A', packed(instance, id) + name);
  }
  void data(std::uint16_t id, const std::string& payload) { message('D', packed(id) + payload); }
  void sync() { message('S', "\x2F\x73\x13\x20\x25\x0C\xBB\x12"); }
};

/// A CDR message, least byte first; alignment counts from behind the first four bytes.
struct CdrMessage {
  std::string bytes{std::string("\0\1\0\0", 4)};

  template <class T>
  CdrMessage& add(T value) {
    while ((bytes.size() - 4) % sizeof(T) != 0) bytes += '\0';
    put(bytes, value);
    return *this;
  }
  CdrMessage& text(const std::string& words) {
    add(static_cast<std::uint32_t>(words.size() + 1));
    bytes += words + '\0';
    return *this;
  }
  /// A std_msgs/Header.
  CdrMessage& header(double seconds, const std::string& frame = "base") {
    const auto whole = static_cast<std::int32_t>(seconds);
    add(whole);
    add(static_cast<std::uint32_t>((seconds - whole) * 1e9 + 0.5));
    return text(frame);
  }
};

/// MCAP; messages wait for a chunk until chunk() is called.
struct McapLog {
  std::string bytes{"\x89MCAP0\r\n"};
  std::string waiting;

  McapLog() { record(bytes, 1, text("ros2") + text("by hand")); }
  static std::string text(const std::string& words) { return packed(static_cast<std::uint32_t>(words.size())) + words; }
  static void record(std::string& to, std::uint8_t opcode, const std::string& body) {
    to += static_cast<char>(opcode);
    put(to, static_cast<std::uint64_t>(body.size()));
    to += body;
  }
  void schema(std::uint16_t id, const std::string& name, const std::string& language, const std::string& definition) {
    record(waiting, 3, packed(id) + text(name) + text(language) + text(definition));
  }
  void channel(std::uint16_t id, std::uint16_t schema, const std::string& topic, const std::string& encoding = "cdr") {
    record(waiting, 4, packed(id, schema) + text(topic) + text(encoding) + packed(std::uint32_t{0}));
  }
  void message(std::uint16_t channel, double log, const std::string& data) {
    const auto time = static_cast<std::uint64_t>(log * 1e9 + 0.5);
    record(waiting, 5, packed(channel, std::uint32_t{0}, time, time) + data);
  }
  /// Not packed, without a checksum unless one is given.
  void chunk(std::uint32_t checksum = 0) {
    record(bytes, 6,
           packed(std::uint64_t{0}, std::uint64_t{0}, static_cast<std::uint64_t>(waiting.size()), checksum) + text("") +
               packed(static_cast<std::uint64_t>(waiting.size())) + waiting);
    waiting.clear();
  }
  void plain() { bytes += std::exchange(waiting, {}); }
  void end() {
    record(bytes, 15, packed(std::uint32_t{0}));
    record(bytes, 2, packed(std::uint64_t{0}, std::uint64_t{0}, std::uint32_t{0}));
    bytes += "\x89MCAP0\r\n";
  }
};

/// ROS 1 bag.
struct BagLog {
  std::string bytes{"#ROSBAG V2.0\n"};
  std::string waiting;

  using Fields = std::vector<std::pair<std::string, std::string>>;
  static std::string fields(const Fields& all) {
    std::string text;
    for (const auto& [name, value] : all)
      text += packed(static_cast<std::uint32_t>(name.size() + 1 + value.size())) + name + "=" + value;
    return text;
  }
  static void record(std::string& to, const Fields& header, const std::string& data) {
    const std::string text = fields(header);
    to +=
        packed(static_cast<std::uint32_t>(text.size())) + text + packed(static_cast<std::uint32_t>(data.size())) + data;
  }
  void connection(std::uint32_t id, const std::string& topic, const std::string& type, const std::string& definition) {
    record(waiting, {{"op", "\x07"}, {"conn", packed(id)}, {"topic", topic}},
           fields({{"topic", topic}, {"type", type}, {"md5sum", "*"}, {"message_definition", definition}}));
  }
  void message(std::uint32_t id, std::uint32_t seconds, std::uint32_t nanoseconds, const std::string& data) {
    record(waiting, {{"op", "\x02"}, {"conn", packed(id)}, {"time", packed(seconds, nanoseconds)}}, data);
  }
  void chunk() {
    record(bytes,
           {{"op", "\x05"}, {"compression", "none"}, {"size", packed(static_cast<std::uint32_t>(waiting.size()))}},
           waiting);
    waiting.clear();
  }
};

}  // namespace fathom::test
