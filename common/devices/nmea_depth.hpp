// Depth from NMEA: $--DPT, $--DBT, $--DBS, $--DBK and Valeport's $PRVAT (pressure or depth).
#pragma once

#include "common/devices/nmea.hpp"
#include "common/devices/settings.hpp"

namespace fathom::devices {

/// The sentences of an echo sounder (DPT, DBT ...) tell how deep the water is below a transducer. They are a vehicle's
/// depth only where an instrument misuses them so; that is taken as meant. An offset above zero is the transducer's own
/// depth and is added; one below zero leads to the keel and is not.
class NmeaDepth final : public NmeaParser {
 public:
  explicit NmeaDepth(const Settings& settings);

 private:
  void sentence(const Words& words, Frame& frame) override;
  void describe_values(Fields& fields) const override;
  void read_prvat(const Words& words);

  double air_pressure_, per_metre_;  ///< Pa, Pa/m
  bool absolute_;
  std::optional<double> depth_m_, offset_m_, altitude_m_, pressure_dbar_;
  Depth sample_;
};

}  // namespace fathom::devices
