// The Beluga recordings as samples, for tests that must not depend on the import: forward-left-up to
// forward-right-down.
#pragma once

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "common/samples/recording.hpp"

namespace fathom::test {

inline Recording read_beluga(const std::string& run) {
  Recording recording;
  recording.name = run;
  std::ifstream file(std::string(FATHOM_SOURCE_DIR) + "/test/data/beluga/" + run + ".csv");
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::vector<double> c;
    std::stringstream stream(line);
    for (std::string cell; std::getline(stream, cell, ',');) c.push_back(std::stod(cell));
    const Utime utime = utime_after(0, c[0]);
    PoseCapture pose{.utime = utime,
                     .p_WB = {c[11], -c[12], -c[13]},
                     .q_WB = {c[7], c[8], -c[9], -c[10]},
                     .valid = c[29] + c[30] + c[31] < 0.5};
    recording.pose_capture.push_back(pose);
    Ahrs ahrs;
    ahrs.utime = utime;
    ahrs.w_WB_B = {c[14], -c[15], -c[16]};
    ahrs.has_rates = true;
    recording.ahrs.push_back(ahrs);
    recording.dvl.push_back(
        {.utime = utime, .v_WB_B = {c[17], -c[18], -c[19]}, .altitude = 0.0, .valid = true, .held = c[32] > 0.5});
    Thrusters thrusters;
    thrusters.utime = utime;
    thrusters.pwm_us.assign(c.begin() + 21, c.begin() + 29);
    thrusters.tau = {c[1], -c[2], -c[3], c[4], -c[5], -c[6]};
    thrusters.has_tau = true;
    recording.thrusters.push_back(thrusters);
    recording.battery.push_back({utime, c[20]});
  }
  return recording;
}

inline std::vector<Recording> read_all_beluga() {
  std::vector<Recording> all;
  for (const char* run : {"surge-1", "sway-1", "heave-1", "yaw-1", "random-1", "random-2"})
    all.push_back(read_beluga(run));
  return all;
}

}  // namespace fathom::test
