// Any bytes as a damaged log: what is kept and what is lost is all there was, and what is kept is whole.
#include <cstdlib>
#include <vector>

#include "common/base/log_salvage.hpp"

// NOLINTNEXTLINE(readability-identifier-naming): the name is libFuzzer's
extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  std::vector<std::uint8_t> kept;
  const auto first = fathom::salvage(
      {data, size}, [&](auto event, std::size_t) { kept.insert(kept.end(), event.begin(), event.end()); });
  if (first.bytes + first.lost() != size || first.bytes != kept.size()) std::abort();
  return 0;
}
