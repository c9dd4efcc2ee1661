// Attitude sensors' bytes from samples.
#include <cmath>

#include "common/base/spatial.hpp"
#include "common/devices/attitude.hpp"
#include "common/devices/checksum.hpp"
#include "common/devices/emulation/emulation.hpp"
#include "common/devices/inertial/sbg_ig500.hpp"

namespace fathom::devices::detail {
namespace {

constexpr double kGravity = 9.80665;  // m/s^2 in a "g"

Eigen::Vector3d euler_of(const Instant& now) { return euler_from_rotation(now.ahrs.q_WB.toRotationMatrix()); }

void big_vector(FrameWriter& out, const Eigen::Vector3d& v) {
  for (Eigen::Index i = 0; i < 3; ++i) out.big(static_cast<float>(v(i)));
}
void little_vector(FrameWriter& out, const Eigen::Vector3d& v) {
  for (Eigen::Index i = 0; i < 3; ++i) out.little(static_cast<float>(v(i)));
}

// 32-bit counters of instruments run over.
std::uint32_t ticks(double time, double per_second) {
  return static_cast<std::uint32_t>(static_cast<std::uint64_t>(std::llround(time * per_second)) & 0xFFFFFFFFU);
}

std::string ig500_frame(const Instant& now) {
  FrameWriter data;
  big_vector(data, euler_of(now));
  big_vector(data, now.ahrs.w_WB_B);
  big_vector(data, now.ahrs.f_B);
  data.big(ticks(now.time, 1e3));
  data.big(std::uint32_t{0x000FFFFF});
  const auto bytes = ig500::frame(ig500::kContinuous, as_bytes(data.text));
  return std::string{as_text(bytes)};
}

std::string ecom_frame(std::uint8_t message, const std::string& data) {
  FrameWriter body;
  body.text = {static_cast<char>(message), '\0'};
  body.little(static_cast<std::uint16_t>(data.size()));
  body.text += data;
  body.little(crc16_reflected(as_bytes(body.text), 0));
  return "\xFF\x5A" + body.text + "\x33";
}

std::string ecom_frames(const Instant& now) {
  FrameWriter imu;
  imu.little(ticks(now.time, 1e6));
  imu.little(std::uint16_t{0x1FF});
  little_vector(imu, now.ahrs.f_B);
  little_vector(imu, now.ahrs.w_WB_B);
  imu.little(15.0F);
  little_vector(imu, now.ahrs.f_B);
  little_vector(imu, now.ahrs.w_WB_B);
  FrameWriter euler;
  euler.little(ticks(now.time, 1e6));
  little_vector(euler, euler_of(now));
  little_vector(euler, Eigen::Vector3d::Constant(0.002));
  euler.little(std::uint32_t{0x30});
  return ecom_frame(3, imu.text) + ecom_frame(6, euler.text);
}

// Group common: time since start-up, yaw pitch roll, quaternion, rates, acceleration.
std::string vn100_frame(const Instant& now) {
  FrameWriter body;
  body.little(std::uint8_t{1});
  body.little(std::uint16_t{0x0139});
  body.little(static_cast<std::uint64_t>(std::llround(now.time * 1e9)));
  little_vector(body, euler_of(now).reverse() / kRadians);
  const Eigen::Quaterniond& q = now.ahrs.q_WB;
  for (const double each : {q.x(), q.y(), q.z(), q.w()}) body.little(static_cast<float>(each));
  little_vector(body, now.ahrs.w_WB_B);
  little_vector(body, now.ahrs.f_B);
  body.big(crc16_xmodem(as_bytes(body.text)));
  return "\xFA" + body.text;
}

std::string gx3_frame(const Instant& now) {
  FrameWriter body;
  body.text = "\xCC";
  big_vector(body, now.ahrs.f_B / kGravity);
  big_vector(body, now.ahrs.w_WB_B);
  big_vector(body, now.ahrs.q_WB.conjugate() * Eigen::Vector3d{0.2, 0.0, 0.5});
  const Eigen::Matrix3d R_SW = now.ahrs.q_WB.toRotationMatrix().transpose();
  for (Eigen::Index i = 0; i < 9; ++i) body.big(static_cast<float>(R_SW(i / 3, i % 3)));
  body.big(ticks(now.time, 62500.0));
  body.big(sum16(as_bytes(body.text)));
  return body.text;
}

// Counter, time, quaternion in east, north, up, rates, acceleration, status, all of a sensor whose label looks up.
std::string xsens_frame(const Instant& now) {
  FrameWriter data;
  const auto item = [&](std::uint16_t id, std::size_t size) {
    data.big(id);
    data.big(static_cast<std::uint8_t>(size));
  };
  const auto upward = [](const Eigen::Vector3d& v) { return Eigen::Vector3d{v.x(), -v.y(), -v.z()}; };
  item(0x1020, 2);
  data.big(static_cast<std::uint16_t>(ticks(now.time, 100.0) & 0xFFFFU));
  item(0x1060, 4);
  data.big(ticks(now.time, 1e4));
  item(0x2010, 16);
  const Eigen::Quaterniond R_LN{(Eigen::Matrix3d{} << 0, 1, 0, 1, 0, 0, 0, 0, -1).finished()};
  const Eigen::Quaterniond q = R_LN * now.ahrs.q_WB * Eigen::Quaterniond{0.0, 1.0, 0.0, 0.0};  // half a turn of roll
  for (const double each : {q.w(), q.x(), q.y(), q.z()}) data.big(static_cast<float>(each));
  item(0x8020, 12);
  big_vector(data, upward(now.ahrs.w_WB_B));
  item(0x4020, 12);
  big_vector(data, upward(now.ahrs.f_B));
  item(0xE020, 4);
  data.big(std::uint32_t{3});
  FrameWriter frame;
  frame.text = "\xFF\x36";
  frame.text += static_cast<char>(data.text.size());
  frame.text += data.text;
  frame.text += static_cast<char>(-sum16(as_bytes(frame.text)) & 0xFF);
  return "\xFA" + frame.text;
}

}  // namespace

std::string emulate_ahrs(std::string_view protocol, const Instant& now, const Settings&) {
  if (protocol == "ig500") return ig500_frame(now);
  if (protocol == "sbg_ecom") return ecom_frames(now);
  if (protocol == "vn100") return vn100_frame(now);
  if (protocol == "gx3") return gx3_frame(now);
  if (protocol == "xsens") return xsens_frame(now);
  const Eigen::Vector3d euler = euler_of(now) / kRadians;
  const double heading = euler.z() < 0.0 ? euler.z() + 360.0 : euler.z();
  return nmea_sentence(format("PSXN,23,%.2f,%.2f,%.2f,0.00", euler.x(), euler.y(), heading));
}

}  // namespace fathom::devices::detail
