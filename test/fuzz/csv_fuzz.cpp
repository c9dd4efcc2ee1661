// Any text through the reader of tables: a table or a complaint.
#include <string_view>

#include "common/base/error.hpp"
#include "common/tables/csv.hpp"

// NOLINTNEXTLINE(readability-identifier-naming): the name is libFuzzer's
extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  try {
    (void)fathom::tables::parse_csv({reinterpret_cast<const char*>(data), size}, "fuzz.csv");
  } catch (const fathom::InputError&) {
  }
  return 0;
}
