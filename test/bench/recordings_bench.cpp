// How fast an autopilot's log is read, with the columns of a usual map.
#include <benchmark/benchmark.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "common/recordings/import.hpp"
#include "common/tables/mapped_streams.hpp"
#include "test/support/foreign_logs.hpp"

namespace {

using namespace fathom;
using test::packed;

/// A minute of what ArduSub logs at 400 Hz: 4 MB.
std::string dataflash() {
  test::DataFlashLog log;
  log.format(1, 3 + 8 + 1 + 24, "IMU", "QBffffff", "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ");
  log.format(2, 3 + 8 + 48, "RATE", "Qffffffffffff", "TimeUS,a,b,c,d,e,f,g,h,i,j,k,l");
  log.format(3, 3 + 8 + 28, "RCOU", "QHHHHHHHHHHHHHH", "TimeUS,C1,C2,C3,C4,C5,C6,C7,C8,C9,C10,C11,C12,C13,C14");
  for (std::uint64_t k = 0; k < 24'000; ++k) {
    const std::uint64_t time = 1'000'000 + 2500 * k;
    const auto swing = static_cast<float>(std::sin(1e-3 * static_cast<double>(k)));
    std::string inertial = packed(time, std::uint8_t{0}), rate = packed(time + 100);
    for (int i = 0; i < 6; ++i) inertial += packed(swing);
    for (int i = 0; i < 12; ++i) rate += packed(swing);
    log.record(1, inertial);
    log.record(2, rate);
    if (k % 8 != 0) continue;
    std::string outputs = packed(time + 200);
    for (int i = 0; i < 14; ++i) outputs += packed(static_cast<std::uint16_t>(1500 + static_cast<int>(100 * swing)));
    log.record(3, outputs);
  }
  return log.bytes;
}

void import_dataflash(benchmark::State& state) {
  const std::filesystem::path path = std::filesystem::temp_directory_path() / "fathom_bench.BIN";
  const std::string bytes = dataflash();
  std::ofstream{path, std::ios::binary} << bytes;
  const auto streams = tables::parse_streams(
      "source: s\nlicence: l\nahrs:\n  rates: {columns: ['IMU[0].GyrX', 'IMU[0].GyrY', 'IMU[0].GyrZ'], unit: rad/s, "
      "frame: FRD}\n"
      "  specific_force: {columns: ['IMU[0].AccX', 'IMU[0].AccY', 'IMU[0].AccZ'], unit: m/s^2, frame: FRD}\n"
      "thrusters: {pwm: {columns: [RCOU.C1, RCOU.C2, RCOU.C3, RCOU.C4, RCOU.C5, RCOU.C6], unit: us}}\n",
      "map.yaml");
  for (auto _ : state)
    benchmark::DoNotOptimize(
        recordings::import_files({{path.string()}, recordings::format_of(path.string())}, streams, {}, true));
  state.SetBytesProcessed(static_cast<std::int64_t>(bytes.size()) * static_cast<std::int64_t>(state.iterations()));
  std::filesystem::remove(path);
}
BENCHMARK(import_dataflash)->Unit(benchmark::kMillisecond);

}  // namespace
