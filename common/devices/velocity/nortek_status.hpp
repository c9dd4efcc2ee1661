// What text and binary of Nortek's velocity logs share: the status word and how four beams' distances become one.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>

#include "common/samples/sensors.hpp"

namespace fathom::devices {

constexpr double kNortekNone = -32.0;    // m/s; -32.768 is "no velocity", and no log measures the like
constexpr double kNortekNoMerit = 10.0;  // m/s, figure of merit of a velocity that is none

/// One report: X, Y, Z1, Z2 [m/s], distances of the beams along Z [m], and the status word where there is one.
struct NortekReport {
  std::array<std::optional<double>, 2> horizontal;  ///< X, Y
  std::array<std::optional<double>, 2> vertical;    ///< of beams 1 and 3, of beams 2 and 4
  std::array<double, 4> distance{};                 ///< 0: none
  std::optional<std::uint32_t> status;
};

/// Bits 12 to 15 of the status: X, Y, Z1, Z2 are valid; bits 4 to 7: the distances.
[[nodiscard]] inline Dvl nortek_sample(const NortekReport& report, const Eigen::Matrix3d& R_BS) {
  const auto holds = [&](unsigned bit) { return !report.status || (*report.status >> bit & 1U) != 0; };
  const auto good = [](const std::optional<double>& v) { return v && *v > kNortekNone && *v < -kNortekNone; };
  Eigen::Vector3d v = Eigen::Vector3d::Zero();
  int verticals = 0;
  for (unsigned i = 0; i < 2; ++i) {
    if (!good(report.vertical[i]) || !holds(14 + i)) continue;
    v.z() += *report.vertical[i];
    ++verticals;
  }
  Dvl sample;
  sample.valid = good(report.horizontal[0]) && good(report.horizontal[1]) && holds(12) && holds(13) && verticals > 0;
  if (sample.valid) {
    v.x() = *report.horizontal[0];
    v.y() = *report.horizontal[1];
    v.z() /= verticals;
    sample.v_WB_B = R_BS * v;
  }
  double sum = 0.0;
  int beams = 0;
  for (unsigned i = 0; i < 4; ++i) {
    const double distance = report.distance[i];
    if (!(distance > 0.0 && distance < 1e4) || !holds(4 + i)) continue;
    sum += distance;
    ++beams;
  }
  sample.altitude = beams > 0 ? sum / beams : 0.0;
  return sample;
}

}  // namespace fathom::devices
