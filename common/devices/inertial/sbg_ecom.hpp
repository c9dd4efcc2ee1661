// SBG Systems Ellipse and Ekinox (protocol sbgECom): frames FF 5A ... 33, little endian.
#pragma once

#include "common/devices/parser.hpp"
#include "common/devices/settings.hpp"

namespace fathom::devices {

/// EKF_EULER, EKF_QUAT (attitude) and IMU_DATA (rates and specific force) give samples, one where both are of the same
/// moment; other messages are frames only.
class SbgEcom final : public Parser {
 public:
  explicit SbgEcom(const Settings& settings);
  void describe(Fields& fields) const override;

 private:
  Look look(Bytes bytes) const override;
  void take(Frame& frame) override;
  void take_imu();
  void join_imu();

  Eigen::Matrix3d R_BS_;
  std::uint8_t message_{}, class_{};
  std::uint16_t crc_{};
  Bytes data_;
  Ahrs sample_;
  Ahrs imu_;                ///< newest, to join the attitude of its moment
  std::uint32_t moment_{};  ///< us, of imu_
  bool alone_{false};       ///< imu_ waits for an attitude
  int joined_{};            ///< how many in a row found theirs
};

}  // namespace fathom::devices
