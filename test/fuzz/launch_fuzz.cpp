// Any text as a configuration of procman, and as a command line: read, or one complaint.
#include <cstdlib>
#include <string>

#include "common/base/error.hpp"
#include "common/launch/config.hpp"
#include "common/launch/exec_line.hpp"

// NOLINTNEXTLINE(readability-identifier-naming): the name is libFuzzer's
extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  const std::string text{reinterpret_cast<const char*>(data), size};
  try {
    (void)fathom::launch::LaunchConfig::parse(text, "fuzz.cfg").traps();
  } catch (const fathom::InputError& error) {
    if (!std::string{error.what()}.starts_with("fuzz.cfg:")) std::abort();
  }
  (void)fathom::launch::parse_exec(text, [](const std::string& name) { return std::optional<std::string>{name}; });
  return 0;
}
