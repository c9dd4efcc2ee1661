// Instruments that send plain lines without a checksum: all that protects them is a strict grammar.
#pragma once

#include <string_view>

#include "common/devices/parser.hpp"

namespace fathom::devices {

class TextLines : public Parser {
 protected:
  static constexpr std::size_t kLongestLine = 256;
  TextLines() : Parser{kLongestLine} {}
  /// Whether a line (without its end and the blanks around) is one of this protocol.
  [[nodiscard]] virtual bool accepts(std::string_view line) const = 0;
  virtual void line(std::string_view line, Frame& frame) = 0;

 private:
  Look look(Bytes bytes) const final;
  void take(Frame& frame) final;
};

}  // namespace fathom::devices
