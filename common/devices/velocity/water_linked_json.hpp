// Water Linked A50 and A125 over TCP: one JSON object per line. Forward, starboard, down; the vehicle's sign.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "common/devices/parser.hpp"
#include "common/devices/settings.hpp"

namespace fathom::devices {

/// Reports from json_v1 (which say no type) to json_v3.3. Only velocity_valid decides: reports that are not valid often
/// carry velocities that are not zero. TCP has no checksum of the line, so an object must be whole and say what it is.
class WaterLinkedJson final : public Parser {
 public:
  explicit WaterLinkedJson(const Settings& settings);
  void describe(Fields& fields) const override;

 private:
  struct Transducer {
    std::optional<double> velocity, distance, rssi, nsd;
    std::optional<bool> valid;
  };
  struct Report {
    std::string_view type, format, response_to, error;
    std::optional<double> time_ms, vx, vy, vz, fom, altitude, status;
    std::optional<bool> valid, success;
    std::optional<std::int64_t> time_of_validity, time_of_transmission;  // us
    std::optional<double> ts, x, y, z, std_m, roll, pitch, yaw;
    std::array<std::optional<double>, 9> covariance;
    std::array<Transducer, 4> transducer;
  };

  Look look(Bytes bytes) const override;
  void take(Frame& frame) override;
  [[nodiscard]] static bool read(std::string_view text, Report& report);
  [[nodiscard]] static bool known(std::string_view format);

  Eigen::Matrix3d R_BS_;
  mutable Report report_;  ///< read by look(), to see that the object is whole, and used by take()
  Dvl sample_;
};

}  // namespace fathom::devices
