#include "common/devices/protocols.hpp"

#include <array>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/base/spatial.hpp"
#include "common/devices/acoustics/evologics.hpp"
#include "common/devices/acoustics/nmea_usbl.hpp"
#include "common/devices/acoustics/seatrac.hpp"
#include "common/devices/inertial/microstrain_gx3.hpp"
#include "common/devices/inertial/nmea_attitude.hpp"
#include "common/devices/inertial/sbg_ecom.hpp"
#include "common/devices/inertial/sbg_ig500.hpp"
#include "common/devices/inertial/vectornav.hpp"
#include "common/devices/inertial/xsens.hpp"
#include "common/devices/load_text.hpp"
#include "common/devices/mavlink.hpp"
#include "common/devices/nmea_depth.hpp"
#include "common/devices/nmea_ranges.hpp"
#include "common/devices/text_ranges.hpp"
#include "common/devices/thruster_text.hpp"
#include "common/devices/velocity/cerulean.hpp"
#include "common/devices/velocity/nortek_ad2cp.hpp"
#include "common/devices/velocity/nortek_text.hpp"
#include "common/devices/velocity/pd0.hpp"
#include "common/devices/velocity/pd4.hpp"
#include "common/devices/velocity/pd6.hpp"
#include "common/devices/velocity/water_linked_json.hpp"
#include "common/devices/velocity/water_linked_serial.hpp"

namespace fathom::devices {
namespace {

template <class P>
std::unique_ptr<Parser> make(const Settings& settings) {
  return std::make_unique<P>(settings);
}

// Clocks that count from zero again [s]: times of day, and 32 bits of milliseconds, microseconds or GX3's ticks.
constexpr double kDay = 86400.0;
constexpr double kMilliseconds = 4294967.296, kMicroseconds = 4294.967296, kGx3Ticks = 4294967296.0 / 62500.0,
                 kXsensTicks = 429496.7296;

constexpr std::array kProtocols{
    Protocol{"ig500", Kind::kAhrs, "SBG IG-500A, sbgCom binary", 115200, make<SbgIg500>, 1e-3, kMilliseconds},
    Protocol{"sbg_ecom", Kind::kAhrs, "SBG Ellipse, sbgECom binary", 115200, make<SbgEcom>, 0.0, kMicroseconds},
    Protocol{"vn100", Kind::kAhrs, "VectorNav VN-100, binary output", 115200, make<VectorNav>},
    Protocol{"gx3", Kind::kAhrs, "MicroStrain 3DM-GX3", 115200, make<MicrostrainGx3>, 0.0, kGx3Ticks},
    Protocol{"xsens", Kind::kAhrs, "Xsens MTi, MTData2", 115200, make<Xsens>, 0.0, kXsensTicks},
    Protocol{"nmea_attitude", Kind::kAhrs, "$PSXN,23, $PIXSE,ATITUD, $--HDT, $SBG01", 115200, make<NmeaAttitude>, 0.0,
             kDay},
    Protocol{"pd0", Kind::kDvl, "Teledyne PD0 ensembles", 115200, make<Pd0>, 0.01},
    Protocol{"pd4", Kind::kDvl, "Teledyne PD4 and PD5", 115200, make<Pd4>, 0.01, kDay},
    Protocol{"pd6", Kind::kDvl, "Teledyne PD6 and PD13 text", 115200, make<Pd6>, 0.01},
    Protocol{"wl_serial", Kind::kDvl, "Water Linked A50, serial", 115200, make<WaterLinkedSerial>},
    Protocol{"wl_json", Kind::kDvl, "Water Linked A50, JSON over TCP (port 16171)", 0, make<WaterLinkedJson>},
    Protocol{"nortek_text", Kind::kDvl, "Nortek $PNORBT6 to $PNORBT9", 115200, make<NortekText>},
    Protocol{"nortek_ad2cp", Kind::kDvl, "Nortek AD2CP, bottom track 1B", 115200, make<NortekAd2cp>},
    Protocol{"cerulean", Kind::kDvl, "Cerulean $DVPDL, $DVPDX", 115200, make<Cerulean>},
    Protocol{"nmea_usbl", Kind::kUsbl, "$PSIMSSB, $PSONLLD, $PSONALL, $PTSAG, $PTSAX, $PTSAY", 9600, make<NmeaUsbl>,
             0.0, kDay},
    Protocol{"evologics", Kind::kUsbl, "EvoLogics USBLLONG", 19200, make<Evologics>},
    Protocol{"seatrac", Kind::kUsbl, "Blueprint SeaTrac, fixes of the X150", 115200, make<Seatrac>},
    Protocol{"psimlbm", Kind::kRanges, "Kongsberg $PSIMLBM", 9600, make<NmeaRanges>, 0.0, kDay},
    Protocol{"range_text", Kind::kRanges, "lines of NAME=METRES", 9600, make<TextRanges>},
    Protocol{"nmea_depth", Kind::kDepth, "$--DPT, $--DBT, $PRVAT", 9600, make<NmeaDepth>},
    Protocol{"load_text", Kind::kLoads, "lines of readings", 9600, make<LoadText>},
    Protocol{"mavlink", Kind::kThrusters, "MAVLink 1 and 2 of ArduSub", 115200, make<Mavlink>},
    Protocol{"thruster_text", Kind::kThrusters, "$FTAPP, $FTBAT of a test rig", 115200, make<ThrusterText>},
};

Eigen::Matrix3d read_rotation(const Config& config) { return rotation_from_euler(config.vector3("rotation", "rad")); }

bool read_choice(const Config& config, const std::string& key, const std::string& no, const std::string& yes) {
  const std::string text = config.text(key);
  if (text != no && text != yes) config.fail(key, "'" + key + "' is " + no + " or " + yes + ", not '" + text + "'");
  return text == yes;
}

double read_positive(const Config& config, const std::string& key, const std::string& unit) {
  const double value = config.quantity(key, unit);
  if (!(value > 0.0)) config.fail(key, "'" + key + "' must be positive");
  return value;
}

/// "forward port", "north east": which way X and Y point.
RelativeAxes read_axes(const Config& config, const std::string& key) {
  struct Way {
    const char* name;
    bool head_up;
    Eigen::Vector2d to;
  };
  static const std::array<Way, 8> kWays{{{"forward", true, {1, 0}},
                                         {"aft", true, {-1, 0}},
                                         {"starboard", true, {0, 1}},
                                         {"port", true, {0, -1}},
                                         {"north", false, {1, 0}},
                                         {"south", false, {-1, 0}},
                                         {"east", false, {0, 1}},
                                         {"west", false, {0, -1}}}};
  const std::string text = config.text(key);
  for (const Way& x : kWays) {
    for (const Way& y : kWays) {
      if (x.head_up != y.head_up || x.to.dot(y.to) != 0.0 || text != std::string{x.name} + " " + y.name) continue;
      return {(Eigen::Matrix2d{} << x.to, y.to).finished(), x.head_up};
    }
  }
  config.fail(key, "'" + key +
                       "' says which way X and Y point: two of forward, aft, starboard, port, or two of north, "
                       "south, east, west, as in 'forward port', not '" +
                       text + "'");
}

void read_transceiver(const Config& config, Transceiver& from) {
  from.beacon = config.text("beacon");
  from.sigma = read_positive(config, "sigma", "m");
  const Config place = config.section("transceiver");
  from.p_W = place.vector3("position", "m");
  from.heading = place.quantity("heading", "rad");
  const auto optional = [&](const char* key, const char* unit, std::optional<double>& into) {
    if (place.has(key)) into = place.quantity(key, unit);
  };
  if (place.has("declination")) from.declination = place.quantity("declination", "rad");
  optional("latitude", "rad", from.latitude);
  optional("longitude", "rad", from.longitude);
  optional("northing", "m", from.northing);
  optional("easting", "m", from.easting);
  if (place.has("ptsax")) from.ptsax = read_axes(place, "ptsax");
  if (place.has("ptsay")) from.ptsay = read_axes(place, "ptsay");
}

void read_cells(const Config& config, std::vector<LoadCell>& cells) {
  for (const Config& one : config.list("cells")) {
    cells.push_back({.name = one.text("name"),
                     .gain = one.quantity("gain", "N"),
                     .zero = one.quantity("zero", ""),
                     .unit = one.has("unit") ? one.text("unit") : ""});
    if (cells.back().gain == 0.0) one.fail("gain", "'gain' is the force in N of one unit of the reading; it is not 0");
  }
  if (cells.empty()) config.fail("cells", "the list is empty; name every cell in the order of the vehicle file");
}

void read_dvl(const Config& config, const Protocol& protocol, Settings& settings) {
  settings.R_BS = read_rotation(config);
  if (config.has("beam_angle")) settings.beam_angle = read_positive(config, "beam_angle", "rad");
  const bool pd6 = protocol.name == "pd6";
  if (!pd6 && protocol.name != "pd4") return;
  settings.water_linked_axes = read_choice(config, "axes", "teledyne", "water_linked");
  settings.ship_is_level = config.flag("ship_is_level");
  if (pd6) settings.instrument_axes = read_choice(config, "velocity", "ship", "instrument");
}

void read_depth(const Config& config, Settings& settings) {
  settings.water_density = read_positive(config, "water_density", "kg/m^3");
  settings.gravity = read_positive(config, "gravity", "m/s^2");
  settings.air_pressure = read_positive(config, "air_pressure", "Pa");
  settings.pressure_is_absolute = read_choice(config, "pressure", "gauge", "absolute");
}

}  // namespace

std::span<const Protocol> protocols() { return kProtocols; }

const Protocol& protocol(std::string_view name, const std::string& where, const Kind* kind) {
  std::string known;
  for (const Protocol& each : kProtocols) {
    if (kind != nullptr && each.kind != *kind) continue;
    if (each.name == name) return each;
    known += (known.empty() ? "" : ", ") + std::string{each.name};
  }
  throw InputError(where + ": no protocol '" + std::string{name} + "'; known: " + known);
}

Settings read_settings(const Config& config, const Protocol& protocol) {
  Settings settings;
  if (config.has("checksum_required")) settings.checksum_required = config.flag("checksum_required");
  switch (protocol.kind) {
    case Kind::kAhrs:
      settings.R_BS = read_rotation(config);
      break;
    case Kind::kDvl:
      read_dvl(config, protocol, settings);
      break;
    case Kind::kUsbl:
      read_transceiver(config, settings.transceiver);
      break;
    case Kind::kRanges:
      settings.transponders = config.texts("transponders");
      if (protocol.name == "psimlbm") settings.sound_speed = read_positive(config, "sound_speed", "m/s");
      break;
    case Kind::kDepth:
      read_depth(config, settings);
      break;
    case Kind::kLoads:
      read_cells(config, settings.cells);
      break;
    case Kind::kThrusters:
      break;
  }
  return settings;
}

}  // namespace fathom::devices
