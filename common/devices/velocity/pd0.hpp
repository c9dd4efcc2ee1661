// Teledyne RDI PD0: binary ensembles of Workhorse, Navigator, Explorer and Pathfinder.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/devices/parser.hpp"
#include "common/devices/settings.hpp"
#include "common/devices/velocity/janus.hpp"

namespace fathom::devices {

/// Data types are looked up by their names in any order; unknown ones are passed over. A Dvl sample comes from bottom
/// track; ensembles without it give frames only. PD0 says how the bottom moves: the vehicle's velocity is minus that.
class Pd0 final : public Parser {
 public:
  explicit Pd0(const Settings& settings);
  void describe(Fields& fields) const override;

  static constexpr std::int16_t kBad = -32768;  ///< "no velocity"
  /// Water profile of the latest ensemble, mm/s, counts.
  [[nodiscard]] std::size_t cells() const;
  [[nodiscard]] std::int16_t velocity(std::size_t cell, std::size_t beam) const;
  [[nodiscard]] std::uint8_t correlation(std::size_t cell, std::size_t beam) const;
  [[nodiscard]] std::uint8_t echo(std::size_t cell, std::size_t beam) const;

 private:
  Look look(Bytes bytes) const override;
  void take(Frame& frame) override;
  void find_blocks();
  void read_pose();
  [[nodiscard]] bool read_velocity();
  [[nodiscard]] std::optional<double> clock() const;
  void describe_leaders(Fields& fields) const;
  void describe_profile(Fields& fields) const;
  void describe_bottom(Fields& fields) const;

  Eigen::Matrix3d R_BS_;
  std::optional<double> stated_beam_angle_;
  std::uint64_t offset_{};
  Bytes bytes_;
  Bytes fixed_, variable_, velocity_, correlation_, echo_, good_, bottom_, fine_bottom_, fine_range_;
  Janus janus_;
  DvlPose pose_;
  Dvl sample_;
};

}  // namespace fathom::devices
