// Acoustic positions in NMEA sentences: Kongsberg $PSIMSSB, Sonardyne $PSONLLD and $PSONALL, iXblue $PTSAG, $PTSAX and
// $PTSAY.
#pragma once

#include <string_view>

#include "common/devices/nmea.hpp"
#include "common/devices/positions.hpp"
#include "common/devices/settings.hpp"

namespace fathom::devices {

/// A fix without position gives no sample; one that the system distrusts gives a sample that is not valid. The axes of
/// $PTSAX and $PTSAY are not described in public: without the settings `ptsax` and `ptsay` they are frames only.
class NmeaUsbl final : public NmeaParser {
 public:
  explicit NmeaUsbl(const Settings& settings);

 private:
  void sentence(const Words& words, Frame& frame) override;
  void describe_values(Fields& fields) const override;
  void read_psimssb(const Words& words);
  void read_ptsag(const Words& words);
  void read_ptsax(const Words& words);
  void read_date_and_beacon(const Words& words);
  void read_valid_depth(const Words& words, std::size_t validity);
  void read_psonlld(const Words& words);
  void read_psonall(const Words& words);
  [[nodiscard]] std::string_view lacking() const;
  void needs_origin(bool stated, std::string_view what);

  Transceiver from_;
  WantedBeacon wanted_;
  std::string_view beacon_, status_, error_;
  std::optional<double> time_, first_, second_, depth_, accuracy_;  ///< as told
  bool trusted_{};
  std::optional<Eigen::Vector3d> p_WB_;
  Usbl sample_;
};

}  // namespace fathom::devices
