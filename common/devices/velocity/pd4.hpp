// Teledyne PD4 and PD5: binary speed log. The vehicle's sign: forward is positive.
#pragma once

#include "common/devices/parser.hpp"
#include "common/devices/settings.hpp"
#include "common/devices/velocity/janus.hpp"

namespace fathom::devices {

/// No recording of a real instrument stood behind this: layout and lengths are those of three public descriptions that
/// agree. Both ways of counting the length (with and without the checksum) are accepted. PD4 does not say attitude, so
/// its earth velocities cannot be turned to the body and give samples that are not valid.
class Pd4 final : public Parser {
 public:
  explicit Pd4(const Settings& settings);
  void describe(Fields& fields) const override;

 private:
  Look look(Bytes bytes) const override;
  void take(Frame& frame) override;
  [[nodiscard]] bool is_pd5() const { return bytes_[1] == 1; }

  Settings settings_;
  Bytes bytes_;
  Dvl sample_;
};

}  // namespace fathom::devices
