// EvoLogics USBL modems: "+++AT:<length>:USBLLONG,..." CR LF, or the line alone, as loggers keep it. No checksum: the
// stated length must fit; a line alone must have every word, each a number.
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
  [[nodiscard]] Look look_at_wrapped(std::string_view text) const;
  [[nodiscard]] static Look look_at_line(std::string_view text);

  mutable bool wrapped_{false};  ///< this line tells lengths: what is inside of a damaged frame is no line alone
  Transceiver from_;
  WantedBeacon wanted_;
  Words words_;
  Usbl sample_;
};

}  // namespace fathom::devices
