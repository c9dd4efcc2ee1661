// fuzz_seeds FOLDER: a folder per protocol with bytes that its instrument could send, and one per format of recordings
// with small files of it, for the fuzzer to begin with.
#include <filesystem>
#include <fstream>
#include <string>

#include "common/devices/emulation/emulation.hpp"
#include "common/devices/protocols.hpp"
#include "test/support/foreign_logs.hpp"

using namespace fathom;

namespace {

using test::packed;

void seed(const std::filesystem::path& folder, const std::string& name, const std::string& bytes) {
  std::filesystem::create_directories(folder);
  std::ofstream file{folder / name, std::ios::binary};
  file << bytes;
}

std::string dataflash() {
  test::DataFlashLog log;
  log.format(20, 44, "FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds");
  log.format(6, 16, "BARO", "QBf", "TimeUS,I,Alt");
  log.record(20, packed(std::uint64_t{1}, std::uint8_t{6}) + test::padded("s#m", 16) + test::padded("F--", 16));
  for (unsigned i = 0; i < 4; ++i)
    log.record(6, packed(std::uint64_t{1'000'000} + 1000U * i, static_cast<std::uint8_t>(i % 2), 1.5F));
  return log.bytes;
}

std::string ulog() {
  test::UlogLog log;
  log.format("inner:float[3] x;char[4] word;");
  log.format("outer:uint64_t timestamp;inner[2] in;uint8_t flag;uint8_t[3] _padding0;");
  log.subscribe(0, 1, "outer");
  for (unsigned i = 0; i < 3; ++i) log.data(1, packed(std::uint64_t{1000} * (i + 1)) + std::string(33, '\1'));
  log.sync();
  return log.bytes;
}

constexpr const char* kTypes =
    "package a;\n// what\nstruct one_t { const int32_t kTwo = 2; int64_t utime; // [us]\n int32_t n; double x[n][3]; "
    "two_t two[2]; }\nstruct two_t { string name; byte b; }\n";
constexpr const char* kDefinition = "float64 value\nint16[] list\nstring word";

std::string mcap() {
  test::McapLog log;
  log.schema(1, "test_msgs/msg/Reading", "ros2msg", kDefinition);
  log.channel(1, 1, "/reading");
  for (const double t : {1.0, 2.0}) {
    log.message(
        1, t,
        test::CdrMessage{}.add(t).add(std::uint32_t{2}).add(std::int16_t{7}).add(std::int16_t{8}).text("x").bytes);
    log.chunk();
  }
  log.end();
  return log.bytes;
}

std::string bag() {
  test::BagLog log;
  log.connection(0, "/reading", "test_msgs/Reading", kDefinition);
  for (unsigned i = 0; i < 2; ++i) {
    log.message(0, i, 0, packed(1.0, std::uint32_t{1}, std::int16_t{7}, std::uint32_t{1}) + "x");
    log.chunk();
  }
  return log.bytes;
}

std::string npy() {
  const std::string header = "{'descr': [('t', '<f8'), ('x', '>i2', (2,))], 'fortran_order': False, 'shape': (3,), }\n";
  return std::string{"\x93NUMPY\1\0", 8} + packed(static_cast<std::uint16_t>(header.size())) + header +
         std::string(36, '\1');
}

constexpr const char* kDrawing =
    "<sdf version='1.9'><model name='r'><link name='b'><pose>0 0 0 0 0 1</pose><inertial><mass>3</mass><inertia>"
    "<ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial></link><link name='p'/><joint name='j' type='revolute'>"
    "<parent>b</parent><child>p</child><axis><xyz>1 0 0</xyz></axis></joint><plugin filename='thruster' name='t'>"
    "<joint_name>j</joint_name><max_thrust_cmd>9</max_thrust_cmd></plugin></model></sdf>";

/// The beginnings of recorded files, by what their names end in.
void recorded(const std::filesystem::path& to) {
  constexpr std::size_t kMost = 4096;  // bytes: what a fuzzer is given
  for (const auto& [extension, format] : {std::pair{".BIN", "dataflash"},
                                          {".tlog", "tlog"},
                                          {".ulg", "ulog"},
                                          {".mcap", "mcap"},
                                          {".bag", "rosbag1"},
                                          {".db3", "rosbag2"},
                                          {".npz", "npz"}}) {
    for (const auto& entry : std::filesystem::directory_iterator{FATHOM_SOURCE_DIR "/test/data/recordings"}) {
      if (entry.path().extension() != extension) continue;
      std::ifstream file{entry.path(), std::ios::binary};
      std::string bytes(kMost, '\0');
      file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
      bytes.resize(static_cast<std::size_t>(file.gcount()));
      seed(to / format, entry.path().filename().string(), bytes);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const std::filesystem::path folder{argv[1]};
  for (const devices::Protocol& protocol : devices::protocols()) {
    for (int i = 0; i < 5; ++i) {
      std::string bytes(1, static_cast<char>(13 * i));  // pieces and settings
      for (int report = 0; report < 3; ++report) {
        const double t = 10.0 * i + report;
        const devices::EmulatedDvl dvl{.frame = static_cast<devices::DvlFrame>(i % 4)};
        bytes += devices::emulate(protocol.name, devices::emulated_motion(1.7e9 + t, t, {}), {}, dvl);
      }
      seed(folder / protocol.name, "seed" + std::to_string(i), bytes);
    }
  }
  recorded(folder);
  for (const auto& [format, bytes] : {std::pair<std::string, std::string>{"dataflash", dataflash()},
                                      {"dataflash_text", "FMT, 6, 16, BARO, QBf, TimeUS,I,Alt\nBARO, 1000, 0, 1.5\n"},
                                      {"ulog", ulog()},
                                      {"mcap", mcap()},
                                      {"rosbag1", bag()},
                                      {"npy", npy()},
                                      {"drawing", kDrawing},
                                      {"lcm_types", kTypes},
                                      {"channel_table", "t,utime,z\n0,1000000,1.5\n0.1,1100000,1.6\n"},
                                      {"ros_definition", std::string{"\0\4\0", 3} + kDefinition}})
    seed(folder / format, "seed", bytes);
  return 0;
}
