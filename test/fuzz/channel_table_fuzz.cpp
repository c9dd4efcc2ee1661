// Any text as the table of a channel: a log that can be read again, or one complaint that names the table.
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "common/exports/channel_tables.hpp"
#include "common/exports/log_export.hpp"

// NOLINTNEXTLINE(readability-identifier-naming): the name is libFuzzer's
extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  static const std::string path =
      (std::filesystem::temp_directory_path() / ("fathom-fuzz-" + std::to_string(::getpid()) + ".csv")).string();
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) std::abort();
  std::fwrite(data, 1, size, file);
  std::fclose(file);
  const auto table = fathom::exports::channel_table(path);
  if (!table) return 0;
  try {
    const std::vector<fathom::exports::ChannelTable> tables{*table};
    std::uint64_t written = 0;
    for (const auto& [channel, count] : fathom::exports::from_csv(tables, path + ".lcmlog").written) written += count;
    if (fathom::exports::summary_of(path + ".lcmlog").events != written) std::abort();
  } catch (const fathom::InputError& error) {
    if (std::string_view{error.what()}.find(path) == std::string_view::npos) std::abort();
  }
  return 0;
}
