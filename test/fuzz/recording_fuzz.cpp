// Any bytes as a recording of one format: topics and messages that fit each other, or one complaint that names the
// file.
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "common/recordings/formats.hpp"

#ifndef FATHOM_FORMAT
#define FATHOM_FORMAT "mcap"  // the build names one per executable
#endif

namespace {

using namespace fathom;

void require(bool good) {
  if (!good) std::abort();
}

struct Check final : recordings::Sink {
  std::vector<std::size_t> fields;
  bool topic(std::size_t number, const recordings::Topic& topic) override {
    require(number == fields.size());
    fields.push_back(topic.fields.size());
    return true;
  }
  void further_field(std::size_t topic, const recordings::Field&) override { ++fields.at(topic); }
  void message(std::size_t topic, recordings::Stamp, std::span<const double> values) override {
    require(values.size() <= fields.at(topic));
  }
  void text(std::size_t topic, std::string_view, std::string_view) override { require(topic < fields.size()); }
};

const std::string& scratch() {
  static const std::string path =
      (std::filesystem::temp_directory_path() / ("fathom-fuzz-" + std::to_string(::getpid()))).string();
  return path;
}

}  // namespace

// NOLINTNEXTLINE(readability-identifier-naming): the name is libFuzzer's
extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  const recordings::Format* format = nullptr;
  for (const recordings::Format& each : recordings::formats()) {
    if (std::string_view{each.name} == FATHOM_FORMAT) format = &each;
  }
  require(format != nullptr);
  std::FILE* file = std::fopen(scratch().c_str(), "wb");
  require(file != nullptr);
  std::fwrite(data, 1, size, file);
  std::fclose(file);
  Check check;
  recordings::Damage damage;
  try {
    format->read(scratch(), check, damage);
  } catch (const InputError& error) {
    require(std::string_view{error.what()}.starts_with(scratch()));
  }
  require(damage.bytes() <= size * 2);
  return 0;
}
