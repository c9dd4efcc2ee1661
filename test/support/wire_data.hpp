// Recorded bytes of real instruments (test/data/wire) and what a parser makes of them, as tables of text.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "common/devices/protocols.hpp"

namespace fathom::test {

/// One frame: its place, its bytes and every field by name, in the order of describe().
struct WireRow {
  std::uint64_t offset{};
  std::string bytes;
  std::vector<std::pair<std::string, std::string>> fields;
  bool has_sample{};
  /// Empty text when there is no such field.
  [[nodiscard]] const std::string& at(const std::string& name) const;
  [[nodiscard]] bool has(const std::string& name) const;
  [[nodiscard]] double value(const std::string& name) const;
  bool operator==(const WireRow&) const = default;
};

/// Feeds a parser in pieces of `piece` bytes (0: all at once). Instrument fields first, then those of the SI sample.
[[nodiscard]] std::vector<WireRow> decode_wire(devices::Parser& parser, const devices::Protocol& protocol,
                                               const devices::Settings& settings, const std::string& bytes,
                                               std::size_t piece = 0);

/// One recording with the protocol and settings that read it.
struct WireRecording {
  std::string protocol;
  std::string file;      ///< under test/data/wire
  std::string expected;  ///< under test/data/wire; empty: none
  devices::Settings settings{};
  bool checksum{true};  ///< damage of one bit in a frame cannot pass
};
[[nodiscard]] const std::vector<WireRecording>& wire_recordings();
[[nodiscard]] std::string wire_bytes(const std::string& file);
/// Comma-separated text with quotes, by column name.
[[nodiscard]] std::vector<std::vector<std::pair<std::string, std::string>>> wire_table(const std::string& file);

}  // namespace fathom::test
