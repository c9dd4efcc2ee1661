// How instruments are mounted and set up, as far as their bytes do not say it. One struct for all protocols.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace fathom {
class Config;
}

namespace fathom::devices {

/// One load cell: force [N] = gain * (reading - zero).
struct LoadCell {
  std::string name;
  double gain{1.0};  ///< N per unit of the reading
  double zero{};     ///< reading without load, in its own unit
  std::string unit;  ///< word behind the number, when the instrument sends one
};

/// Which way X and Y of a sentence point whose maker does not say it in public.
struct RelativeAxes {
  Eigen::Matrix2d axes{Eigen::Matrix2d::Identity()};  ///< (X, Y) to forward and starboard, or to north and east
  bool head_up{};                                     ///< the former
};

/// Where positions of acoustic systems come from: the transceiver that does not move with the vehicle.
struct Transceiver {
  Eigen::Vector3d p_W{Eigen::Vector3d::Zero()};  ///< m, NED, of the transceiver
  double heading{};                              ///< rad, of the axis that the system calls "head up"
  double declination{};                          ///< rad, of the north of systems that tell magnetic north (SeaTrac)
  std::optional<double> latitude, longitude;     ///< rad, of the world's origin; for systems that say degrees
  std::optional<double> northing, easting;       ///< m, of the world's origin; for systems that say UTM
  std::optional<RelativeAxes> ptsax, ptsay;      ///< as the system is set up
  std::string beacon;                            ///< only this one is the vehicle; empty: every one
  double sigma{1.0};                             ///< m, where the system states no accuracy
};

struct Settings {
  Eigen::Matrix3d R_BS{Eigen::Matrix3d::Identity()};  ///< instrument's axes (forward, right, down) to the body's
  std::uint32_t output_mask{0x181A};                  ///< SBG IG-500: euler, gyroscopes, accelerometers, time, status
  bool little_endian{false};                          ///< SBG IG-500
  bool checksum_required{true};                       ///< NMEA sentences without "*hh" are refused
  bool water_linked_axes{false};                      ///< PD4, PD6: forward, starboard, down instead of Teledyne's
  bool instrument_axes{false};                        ///< PD6: take ":BI", not ":BS", where both are valid
  bool ship_is_level{false};                          ///< PD4, PD6: "ship" velocities have roll and pitch taken out
  std::optional<double> beam_angle;                   ///< rad, where the instrument says only "other"
  Transceiver transceiver;
  std::vector<std::string> transponders;  ///< names in the order of the vehicle file (text ranges); empty: as they come
  double sound_speed{1500.0};             ///< m/s, for ranges that are told as times
  double water_density{1000.0};           ///< kg/m^3, for depth from pressure
  double gravity{9.81};                   ///< m/s^2
  double air_pressure{101325.0};          ///< Pa
  bool pressure_is_absolute{false};       ///< PRVAT: the instrument's pressure includes that of the air
  std::string sensor;                     ///< MS5837: "30BA" or "02BA"
  std::vector<LoadCell> cells;            ///< order of the vehicle file
  std::size_t motors{8};                  ///< thrusters whose feedback is read
};

}  // namespace fathom::devices
