// One picture from a file, and what is wrong with it where it is none.
#pragma once

#include <filesystem>

#include "common/pictures/source.hpp"

namespace fathom::pictures {

class FileReader {
 public:
  /// Fills in the picture, or the problem.
  void read(const std::filesystem::path& path, Frame& frame);

 private:
  /// Cameras put 10, 12 or 14 bits into the lower ones of 16, and files do not say so: as many as were needed so far.
  int bits_{8};
};

}  // namespace fathom::pictures
