// Water Linked A50 and A125 over a serial line: "wrz,...*hh". Forward, starboard, down; the vehicle's sign.
#pragma once

#include <string_view>

#include "common/devices/parser.hpp"
#include "common/devices/settings.hpp"
#include "common/devices/text.hpp"

namespace fathom::devices {

/// Samples from wrz, and from the older wrx until the first wrz comes.
class WaterLinkedSerial final : public Parser {
 public:
  explicit WaterLinkedSerial(const Settings& settings);
  void describe(Fields& fields) const override;

 private:
  Look look(Bytes bytes) const override;
  void take(Frame& frame) override;
  void velocity(Frame& frame, std::size_t first, std::string_view valid, std::string_view altitude);

  Eigen::Matrix3d R_BS_;
  Words words_;
  bool new_protocol_{false};
  Dvl sample_;
};

}  // namespace fathom::devices
