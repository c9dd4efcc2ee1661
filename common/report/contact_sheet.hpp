// Pictures of a trial on its page, with what was measured in them.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "common/samples/vision.hpp"

namespace fathom::report {

/// A section of HTML; empty without pictures. The files stand in the page itself.
[[nodiscard]] std::string contact_sheet(std::span<const Camera> pictures, Utime origin);

/// RFC 4648, padded.
[[nodiscard]] std::string base64(std::span<const std::uint8_t> bytes);

}  // namespace fathom::report
