// Any text as an .lcm file: types with fingerprints, or one complaint that names the line or the type.
#include <array>
#include <cstdlib>
#include <string>
#include <string_view>

#include "common/base/error.hpp"
#include "common/exports/definitions.hpp"

// NOLINTNEXTLINE(readability-identifier-naming): the name is libFuzzer's
extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  const std::array<std::string_view, 1> texts{std::string_view{reinterpret_cast<const char*>(data), size}};
  const std::array<std::string, 1> paths{"fuzz.lcm"};
  try {
    const fathom::exports::Definitions definitions{texts, paths};
    for (const auto& [name, type] : definitions.all()) {
      if (&definitions.type(type.package, type.name) != &type) std::abort();
      (void)definitions.fingerprint(type);
    }
  } catch (const fathom::InputError& error) {
    const std::string_view said{error.what()};  // where it stands, or which type is missing
    if (!said.starts_with("fuzz.lcm:") && !said.starts_with("message type ")) std::abort();
  }
  return 0;
}
