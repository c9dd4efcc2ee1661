// Recordings that are far longer than a trial: the commands that read them hold what they look at, not all of them.
#include <doctest/doctest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <string>

#include "common/wire/log_writer.hpp"
#include "test/support/scratch.hpp"
#include "test/support/shell.hpp"
#include "test/support/synthetic_recording.hpp"

namespace fathom {
namespace {

using test::file;
using test::program;

#ifdef __SANITIZE_ADDRESS__
constexpr bool kMemoryTells = false;  // what was freed is kept for a while, to be watched
#else
constexpr bool kMemoryTells = true;
#endif

struct Measured {
  int code{-1};
  long peak{};  ///< kB
};

Measured run(const std::string& command) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::execl("/bin/sh", "sh", "-c", ("exec " + command).c_str(), nullptr);
    ::_exit(127);
  }
  int status = 0;
  rusage used{};
  if (::wait4(child, &status, 0, &used) != child) return {};
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), used.ru_maxrss};
}

/// A velocity log that reads 8 % too much along the keel, every stream at 100 Hz.
Recording recorded(double seconds) {
  test::SyntheticOptions options;
  options.duration = seconds;
  options.pose_rate = options.gyro_rate = options.dvl_rate = 100.0;
  options.dvl_matrix = Eigen::Vector3d(1.08, 1.0, 1.0).asDiagonal();
  return test::synthetic_recording(options, "dive");
}

}  // namespace

TEST_CASE("long runs: a check holds a part of a recording, whatever its length, and finds what the whole shows") {
  constexpr double kShort = 200.0, kLong = 1000.0, kRate = 100.0;  // s, s, Hz
  const test::Scratch scratch;
  Measured measured[2];
  std::string said[2];
  for (const int which : {0, 1}) {
    const std::string log = scratch.path(which == 0 ? "short.lcmlog" : "long.lcmlog");
    wire::write_log(recorded(which == 0 ? kShort : kLong), log);
    const std::string out = scratch.path("said");
    measured[which] = run(program("fathom") + " check --memory 3 --vehicle " + file("config/vehicles/bluerov2.yaml") +
                          " " + log + " >" + out + " 2>&1");
    REQUIRE(measured[which].code == 0);
    said[which] = test::read_bytes(out);
    CHECK_MESSAGE(said[which].find(" parts, one after the other") != std::string::npos, said[which]);
    CHECK_MESSAGE(said[which].find("dvl.u          pose_capture   scale") != std::string::npos, said[which]);
  }
  CHECK_MESSAGE(said[1].find("parts (long, long from") != std::string::npos, said[1]);
  // Held as a whole, a moment takes some 1000 bytes: samples, signals, what is reconstructed of them.
  const double added = 1024.0 * static_cast<double>(measured[1].peak - measured[0].peak) / ((kLong - kShort) * kRate);
  MESSAGE(added << " bytes for a moment that was added, " << measured[1].peak << " kB at most");
  if (kMemoryTells) CHECK(added < 60.0);
}

}  // namespace fathom
