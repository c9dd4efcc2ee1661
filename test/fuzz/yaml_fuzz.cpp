// Any text through the reader of configurations: keys that can be read in every way, or a complaint.
#include <string>

#include "common/base/config.hpp"
#include "common/base/error.hpp"

namespace {

template <class Read>
void attempt(Read&& read) {
  try {
    read();
  } catch (const fathom::InputError&) {
  }
}

void walk(const fathom::Config& config, int depth) {
  if (depth > 4) return;
  for (const std::string& key : config.keys()) {
    attempt([&] { (void)config.text(key); });
    attempt([&] { (void)config.texts(key); });
    attempt([&] { (void)config.flag(key); });
    attempt([&] { (void)config.integer(key); });
    attempt([&] { (void)config.quantity(key, "m/s^2"); });
    attempt([&] { (void)config.quantities(key, "rad"); });
    attempt([&] { (void)config.vector3(key, "N m"); });
    attempt([&] { walk(config.section(key), depth + 1); });
    attempt([&] {
      for (const fathom::Config& each : config.list(key)) walk(each, depth + 1);
    });
  }
}

}  // namespace

// NOLINTNEXTLINE(readability-identifier-naming): the name is libFuzzer's
extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  attempt([&] {
    const auto config = fathom::Config::parse({reinterpret_cast<const char*>(data), size}, "fuzz.yaml");
    attempt([&] { walk(config, 0); });
    config.finish();
  });
  return 0;
}
