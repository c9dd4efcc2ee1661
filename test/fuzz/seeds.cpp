// fuzz_seeds FOLDER: a folder per protocol with bytes that its instrument could send, for the fuzzer to begin with.
#include <filesystem>
#include <fstream>
#include <string>

#include "common/devices/emulation.hpp"
#include "common/devices/protocols.hpp"

using namespace fathom;

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  for (const devices::Protocol& protocol : devices::protocols()) {
    const std::filesystem::path folder = std::filesystem::path{argv[1]} / protocol.name;
    std::filesystem::create_directories(folder);
    for (int i = 0; i < 5; ++i) {
      std::ofstream file{folder / ("seed" + std::to_string(i)), std::ios::binary};
      file.put(static_cast<char>(13 * i));  // pieces and settings
      for (int report = 0; report < 3; ++report) {
        const double t = 10.0 * i + report;
        const devices::EmulatedDvl dvl{.frame = static_cast<devices::DvlFrame>(i % 4)};
        file << devices::emulate(protocol.name, devices::emulated_motion(1.7e9 + t, t, {}), {}, dvl);
      }
    }
  }
  return 0;
}
