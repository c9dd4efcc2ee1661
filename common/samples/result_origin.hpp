// Where a result comes from: the command, and every file that was read, with its hash and the time of its data.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.hpp"

namespace fathom {

/// A file that the result rests on.
struct OriginFile {
  std::string
      role;  ///< "vehicle", "map", "site", "config", "train", "validate", "log", "pipeline", "diagnosis", "truth"
  std::string run;     ///< of a recording: the name under which `train` and `validate` list it; else empty
  std::string path;    ///< as it was given
  std::string sha256;  ///< of its bytes, hexadecimal
  std::uint64_t bytes{};
  std::optional<Utime> begin{}, end{};  ///< of its data [us], on the recording's clock; none for other files
};

struct ResultOrigin {
  /// As a shell takes it, files in the order of their time. Without what the result does not depend on (--out,
  /// --threads), so that equal inputs leave equal files.
  std::string command;
  std::vector<OriginFile> files;
};

}  // namespace fathom
