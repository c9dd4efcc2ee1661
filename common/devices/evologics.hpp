// EvoLogics USBL modems: "+++AT:<length>:USBLLONG,..." CR LF. No checksum; the stated length must fit.
#pragma once

#include <string_view>

#include "common/devices/parser.hpp"
#include "common/devices/positions.hpp"
#include "common/devices/settings.hpp"
#include "common/devices/text.hpp"

namespace fathom::devices {

/// Samples from USBLLONG (east, north, up of the modem, levelled by it); other notifications are frames only.
class Evologics final : public Parser {
 public:
  explicit Evologics(const Settings& settings);
  void describe(Fields& fields) const override;

 private:
  Look look(Bytes bytes) const override;
  void take(Frame& frame) override;

  Transceiver from_;
  WantedBeacon wanted_;
  Words words_;
  Usbl sample_;
};

}  // namespace fathom::devices
