#include "common/recordings/formats.hpp"

#include <array>

#include "common/recordings/dataflash/dataflash.hpp"
#include "common/recordings/matlab/matlab.hpp"
#include "common/recordings/mcap/mcap.hpp"
#include "common/recordings/numpy/numpy.hpp"
#include "common/recordings/packed/packed.hpp"
#include "common/recordings/rosbag1/rosbag1.hpp"
#include "common/recordings/rosbag2/rosbag2.hpp"
#include "common/recordings/tlog/tlog.hpp"
#include "common/recordings/ulog/ulog.hpp"

namespace fathom::recordings {
namespace {

constexpr ClockRules kSinceBoot{.back = 1'000'000};  // counts from power-on, and is written nearly in order
constexpr ClockRules kOfDay{};                       // a clock of the day: what goes back was only written late

constexpr std::array kFormats{
    Format{"dataflash", "ArduPilot DataFlash", kSinceBoot, dataflash::is_binary, dataflash::read_binary},
    Format{"dataflash_text", "ArduPilot DataFlash as text", kSinceBoot, dataflash::is_text, dataflash::read_text},
    Format{"ulog", "PX4 ULog", kSinceBoot, ulog::is_ulog, ulog::read},
    Format{"mcap", "MCAP", kOfDay, mcap::is_mcap, mcap::read},
    Format{"rosbag2", "ROS 2 bag (SQLite)", kOfDay, rosbag2::is_sqlite, rosbag2::read},
    Format{"rosbag1", "ROS 1 bag", kOfDay, rosbag1::is_bag, rosbag1::read},
    Format{"packed", "one of these packed by zstd", kOfDay, packed::is_zstd, packed::read},
    Format{"tlog", "MAVLink telemetry log", kOfDay, tlog::is_tlog, tlog::read},
    Format{"npz", "NumPy arrays (.npz)", kOfDay, numpy::is_npz, numpy::read_npz},
    Format{"npy", "a NumPy array (.npy)", kOfDay, numpy::is_npy, numpy::read_npy},
    Format{"mat", "MATLAB .mat", kOfDay, matlab::is_mat, matlab::read},
};

}  // namespace

std::span<const Format> formats() { return kFormats; }

const Format* format_of(const std::string& path) {
  constexpr std::size_t kHead = 65536;
  FileWindow file{path};
  const Bytes head = file.at(0, kHead);
  for (const Format& format : kFormats) {
    if (format.recognises(head)) return &format;
  }
  return nullptr;
}

}  // namespace fathom::recordings
