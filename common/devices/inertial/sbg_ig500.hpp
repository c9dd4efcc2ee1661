// SBG Systems IG-500A (protocol sbgCom): frames FF 02 ... 03 and the commands that set the instrument up.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/devices/parser.hpp"
#include "common/devices/settings.hpp"

namespace fathom::devices {

namespace ig500 {
constexpr std::uint8_t kAck = 0x01, kSetOutputMode = 0x15, kGetOutputMode = 0x16, kReturnOutputMode = 0x17,
                       kSetContinuous = 0x53, kGetContinuous = 0x54, kReturnContinuous = 0x55, kSetMask = 0x50,
                       kGetMask = 0x51, kReturnMask = 0x52, kContinuous = 0x90, kGetInfos = 0x10, kReturnInfos = 0x11;
constexpr std::size_t kOutputs = 31;
/// Bytes of output `bit` in a data frame; 0 where there is no such output.
[[nodiscard]] std::size_t output_size(std::size_t bit);
/// Bytes of a data frame's buffer under `mask`.
[[nodiscard]] std::size_t buffer_size(std::uint32_t mask);
/// A whole frame around `data`.
[[nodiscard]] std::vector<std::uint8_t> frame(std::uint8_t command, Bytes data);
}  // namespace ig500

class SbgIg500 final : public Parser {
 public:
  explicit SbgIg500(const Settings& settings);
  void describe(Fields& fields) const override;

  /// The latest frame, for the dialogue that configures the instrument.
  [[nodiscard]] std::uint8_t command() const { return command_; }
  [[nodiscard]] Bytes data() const { return data_; }

 private:
  Look look(Bytes bytes) const override;
  void take(Frame& frame) override;
  void read_outputs(Frame& frame);
  [[nodiscard]] bool has(std::size_t bit) const { return (mask_ >> bit & 1U) != 0; }
  [[nodiscard]] float real(std::size_t at) const;
  [[nodiscard]] std::uint32_t word(std::size_t at) const;
  [[nodiscard]] Eigen::Vector3d vector(std::size_t bit) const;

  Eigen::Matrix3d R_BS_;
  std::uint32_t mask_;
  bool little_;
  std::array<std::size_t, ig500::kOutputs> at_{};  ///< where each output of the mask begins in the buffer
  std::size_t buffer_size_;
  std::uint8_t command_{};
  std::uint16_t crc_{};
  Bytes data_;
  Ahrs sample_;
};

}  // namespace fathom::devices
