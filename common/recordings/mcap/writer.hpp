// Writes MCAP (mcap.dev/spec): chunks with an index and a summary, so that Foxglove and PlotJuggler open a long file at
// once. What the messages are is the caller's business.
#pragma once

#include <cstdint>
#include <fstream>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace fathom::recordings::mcap {

class Writer {
 public:
  /// InputError when the file cannot be written.
  explicit Writer(const std::string& path);
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
  ~Writer() = default;  ///< without close() the file is cut off

  /// A channel of JSON messages; its number. `schema`: JSON Schema.
  std::uint16_t open(const std::string& topic, const std::string& schema_name, const std::string& schema);
  /// Times in ns since the epoch.
  void message(std::uint16_t channel, std::uint64_t logged, std::uint64_t published, std::string_view data);
  /// A table of words, as Foxglove lists it.
  void metadata(const std::string& name, const std::map<std::string, std::string>& words);
  /// Writes what is left, index and end. InputError when the disk is full.
  void close();
  [[nodiscard]] std::uint64_t messages() const { return messages_; }

 private:
  struct Chunk {
    std::uint64_t begin{}, end{}, offset{}, length{}, packed{}, size{};
    std::map<std::uint16_t, std::uint64_t> index;  ///< offset of each channel's message index
    std::uint64_t index_length{};
  };

  void record(std::uint8_t opcode, const std::string& body, std::string& into) const;
  void put(const std::string& bytes);
  void end_chunk();

  std::string path_;
  std::ofstream file_;
  std::uint64_t at_{};
  std::string chunk_, schemas_, channels_;                                               ///< records
  std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> index_;  ///< of the open chunk
  std::map<std::uint16_t, std::uint64_t> counts_;
  std::uint64_t chunk_begin_{}, chunk_end_{}, begin_{}, end_{}, messages_{};
  std::uint32_t metadata_{};
  std::vector<Chunk> chunks_;
  std::uint16_t opened_{};
};

}  // namespace fathom::recordings::mcap
