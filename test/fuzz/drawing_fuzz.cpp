// Any bytes as the drawing of a robot, SDF or URDF: the draft of a vehicle file, or one complaint that names the file.
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "common/base/error.hpp"
#include "common/drafts/robot.hpp"

namespace {

using namespace fathom;

const std::string& scratch() {
  static const std::string path =
      (std::filesystem::temp_directory_path() / ("fathom-fuzz-" + std::to_string(::getpid()))).string();
  return path;
}

void attempt(drafts::Robot (*read)(const std::string&)) {
  try {
    if (drafts::vehicle_file(drafts::draft_of(read(scratch()), "fuzz")).empty()) std::abort();
  } catch (const InputError& error) {
    if (std::string_view{error.what()}.empty()) std::abort();
  }
}

}  // namespace

// NOLINTNEXTLINE(readability-identifier-naming): the name is libFuzzer's
extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  std::ofstream{scratch(), std::ios::binary}.write(reinterpret_cast<const char*>(data),
                                                   static_cast<std::streamsize>(size));
  attempt(drafts::read_sdf);
  attempt(drafts::read_urdf);
  return 0;
}
