// How fast the parsers of instruments are, over a megabyte of what an emulated instrument of each kind sends.
#include <benchmark/benchmark.h>

#include <string>

#include "common/devices/emulation/emulation.hpp"
#include "common/devices/protocols.hpp"

namespace {

using namespace fathom;

class Count final : public devices::Output {
 public:
  void frame(const devices::Parser&, const devices::Frame& frame) override {
    benchmark::DoNotOptimize(frame.sample);
    ++frames;
  }
  std::uint64_t frames{};
};

void parse(benchmark::State& state, const devices::Protocol& protocol) {
  std::string bytes;
  for (int i = 0; bytes.size() < 1'000'000; ++i) {
    const double t = 0.1 * i;
    bytes += devices::emulate(protocol.name, devices::emulated_motion(1.7e9 + t, t, {}), {});
  }
  const auto parser = protocol.make({});
  Count count;
  for (auto _ : state) parser->feed(devices::as_bytes(bytes), count);
  state.SetBytesProcessed(static_cast<std::int64_t>(bytes.size()) * static_cast<std::int64_t>(state.iterations()));
  state.SetItemsProcessed(static_cast<std::int64_t>(count.frames));
}

// A name per protocol without a list to be kept: registered before main() runs.
const bool kRegistered = [] {
  for (const devices::Protocol& protocol : devices::protocols()) {
    benchmark::RegisterBenchmark(("parse/" + std::string{protocol.name}).c_str(),
                                 [&protocol](benchmark::State& state) { parse(state, protocol); });
  }
  return true;
}();

}  // namespace
