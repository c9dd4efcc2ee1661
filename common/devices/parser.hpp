// What all instruments share: an unbounded stream of bytes, cut anywhere, becomes frames and samples. No I/O, no clock;
// memory is taken once, when the parser is made.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "common/devices/bytes.hpp"
#include "common/samples/sensors.hpp"

namespace fathom::devices {

/// Since the start. Every byte is in a good frame, the end of its line, skipped, incomplete, or still waiting.
struct Counters {
  std::uint64_t bytes{};
  std::uint64_t frames{};        ///< whole, with a right checksum where the protocol has one
  std::uint64_t bad_checksum{};  ///< frames refused for their checksum
  std::uint64_t bad_frame{};     ///< refused for length, grammar or contents that no instrument sends
  std::uint64_t skipped{};       ///< bytes that belong to no frame
  std::uint64_t line_ends{};     ///< line feeds behind the carriage return that ends a frame of text
  std::uint64_t incomplete{};    ///< bytes of a frame that the end of the stream cut off
};

/// Takes the fields of a frame, in the instrument's own units and frame; what is absent is an empty text.
class Fields {
 public:
  virtual ~Fields() = default;
  virtual void add(std::string_view name, std::string_view text) = 0;
  void add(std::string_view name, const char* text) { add(name, std::string_view{text}); }
  void add(std::string_view name, double value);
  void add(std::string_view name, float value);
  void add(std::string_view name, std::int64_t value);
  template <std::integral T>
  void add(std::string_view name, T value) {
    add(name, static_cast<std::int64_t>(value));
  }
  template <class T>
  void add(std::string_view name, const std::optional<T>& value) {
    if (value) {
      add(name, *value);
    } else {
      add(name, std::string_view{});
    }
  }
  void add_hex(std::string_view name, std::uint64_t value, int digits);
  /// With a fixed number of decimals, as instruments that count in hundredths print.
  void add_fixed(std::string_view name, double value, int decimals);
};

/// What a frame says, in SI units and the body's frame; utime is for the driver to set.
using Sample = std::variant<std::monostate, const Ahrs*, const Dvl*, const Usbl*, const Ranges*, const Depth*,
                            const Loads*, const Battery*, const Thrusters*>;

/// One good frame. It and its sample live as long as the call that brings it.
struct Frame {
  std::uint64_t offset{};  ///< of its first byte in the stream
  Bytes bytes;
  std::optional<double> device_time{};  ///< s on the instrument's clock, whatever its origin
  Sample sample{};
  std::string_view
      lacks{};  ///< why a frame that could hold a measurement gives no sample; empty: it is of another kind
};

class Parser;

/// Receives frames as they are found.
class Output {
 public:
  virtual ~Output() = default;
  virtual void frame(const Parser& parser, const Frame& frame) = 0;
};

class Parser {
 public:
  virtual ~Parser() = default;
  Parser(const Parser&) = delete;
  Parser& operator=(const Parser&) = delete;

  /// The next piece of the stream, of any size.
  void feed(Bytes bytes, Output& output);
  /// The stream has ended: what still waits for more bytes is searched for frames once more.
  void finish(Output& output);
  /// Forgets a half-received frame: the line was interrupted. Counters stay.
  void restart();
  [[nodiscard]] const Counters& counters() const { return counters_; }

  /// What an operator could set right, as the latest frames tell; empty when there is nothing.
  [[nodiscard]] const std::string& complaint() const { return complaint_; }

  /// Fields of the latest frame; to be asked for inside Output::frame.
  virtual void describe(Fields& fields) const = 0;

 protected:
  /// What stands at the first byte.
  struct Look {
    enum class Verdict : std::uint8_t { kMore, kSkip, kBadChecksum, kBadFrame, kFrame };
    Verdict verdict{};
    std::size_t length{};  ///< of the frame, or bytes to skip
  };
  static constexpr Look kMore{Look::Verdict::kMore, 0};
  static constexpr Look kBadChecksum{Look::Verdict::kBadChecksum, 1};
  static constexpr Look kBadFrame{Look::Verdict::kBadFrame, 1};
  static constexpr Look skip(std::size_t length) { return {Look::Verdict::kSkip, length}; }
  static constexpr Look whole_frame(std::size_t length) { return {Look::Verdict::kFrame, length}; }

  /// `longest` frame in bytes: a frame that claims more is not believed, so that damage cannot stall the stream.
  explicit Parser(std::size_t longest);
  /// `bytes` is never empty. kMore only below `longest` bytes.
  [[nodiscard]] virtual Look look(Bytes bytes) const = 0;
  /// Decodes a frame; fills device_time and sample.
  virtual void take(Frame& frame) = 0;
  /// What to do at the bytes behind rubbish: how far the first byte that can begin a frame is.
  static Look skip_to(Bytes bytes, std::uint8_t sync);
  /// Only what is new is copied, so that a complaint in every frame costs nothing.
  void complain(std::string_view text) const {
    if (complaint_ != text) complaint_ = text;
  }

 private:
  void scan(Output& output, bool ended);

  std::size_t longest_;
  std::vector<std::uint8_t> buffer_;
  std::size_t begin_{};
  std::size_t end_{};
  std::uint64_t offset_{};  ///< of buffer_[begin_] in the stream
  bool returned_{false};    ///< a carriage return ended the frame before
  Counters counters_;
  mutable std::string complaint_;
};

}  // namespace fathom::devices
