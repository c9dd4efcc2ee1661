// Xsens MTi: binary messages, of which MTData2 (36) holds measurements.
#pragma once

#include <array>
#include <optional>

#include "common/devices/parser.hpp"
#include "common/devices/settings.hpp"

namespace fathom::devices {

/// Orientation (quaternion, Euler angles or matrix; east-north-up, north-east-down or north-west-up), rate of turn and
/// acceleration, in any of the four number formats. The sensor's axes are those on its label, x ahead, y to port, z up,
/// in whichever frame the orientation is told; `rotation` is for its forward, right, down.
class Xsens final : public Parser {
 public:
  explicit Xsens(const Settings& settings);
  void describe(Fields& fields) const override;

 private:
  /// What of MTData2 is read: place of the first number, and its identifier for the format; 0: not there.
  struct Item {
    std::uint16_t id{};
    std::size_t at{};
  };
  Look look(Bytes bytes) const override;
  void take(Frame& frame) override;
  void find_items();
  [[nodiscard]] double real(const Item& item, std::size_t i) const;
  [[nodiscard]] Eigen::Vector3d vector(const Item& item) const;
  [[nodiscard]] std::optional<Eigen::Matrix3d> orientation() const;
  [[nodiscard]] std::optional<bool> filter_valid() const;

  Eigen::Matrix3d R_BS_;
  std::uint8_t message_{};
  Bytes bytes_;
  Item quaternion_, matrix_, euler_, acceleration_, rate_, counter_, time_, status_byte_, status_word_;
  Ahrs sample_;
};

}  // namespace fathom::devices
