// No memory is taken per frame: counted by replacing the global operators of this executable.
#include <doctest/doctest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "common/devices/emulation/emulation.hpp"
#include "test/support/wire_data.hpp"

namespace {
std::atomic<long> taken{0};
}

void* operator new(std::size_t size) {
  ++taken;
  if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc{};
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

using namespace fathom;

namespace {

class Nowhere final : public devices::Output {
 public:
  void frame(const devices::Parser&, const devices::Frame&) override { ++frames; }
  int frames{};
};

}  // namespace

TEST_CASE("parsers: no memory is taken per frame") {
  for (const devices::Protocol& protocol : devices::protocols()) {
    CAPTURE(protocol.name);
    std::string bytes;
    for (int i = 0; i < 50; ++i) {
      bytes += devices::emulate(protocol.name, devices::emulated_motion(1.7e9 + i, i, {}), {});
    }
    const auto parser = protocol.make({});
    Nowhere nowhere;
    parser->feed(devices::as_bytes(bytes), nowhere);
    const int frames = nowhere.frames;
    CHECK(frames >= 50);
    const long before = taken;
    parser->feed(devices::as_bytes(bytes), nowhere);
    CHECK(taken == before);
    CHECK(nowhere.frames == 2 * frames);
  }
}
