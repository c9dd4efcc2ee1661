// NMEA sentences: "$" body "*hh" CR LF. Families derive and read the fields.
#pragma once

#include <cstdint>
#include <string_view>

#include "common/devices/parser.hpp"
#include "common/devices/text.hpp"

namespace fathom::devices {

class NmeaParser : public Parser {
 public:
  void describe(Fields& fields) const final;

 protected:
  enum class Checksum : std::uint8_t { kRight, kAbsent };

  explicit NmeaParser(bool checksum_required);
  /// words[0] is the sentence's name ("INHDT"). Fills frame.device_time and frame.sample where it says something, and
  /// frame.lacks for every sentence that it reads.
  virtual void sentence(const Words& words, Frame& frame) = 0;
  /// The decoded values beside the raw fields.
  virtual void describe_values(Fields& fields) const = 0;

 private:
  Look look(Bytes bytes) const final;
  void take(Frame& frame) final;

  bool checksum_required_;
  Checksum checksum_{};
  std::string_view body_;  ///< of the latest sentence, inside the parser's buffer
};

}  // namespace fathom::devices
