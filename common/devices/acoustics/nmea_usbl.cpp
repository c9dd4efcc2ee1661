#include "common/devices/acoustics/nmea_usbl.hpp"

#include <cmath>
#include <numbers>
#include <string>

#include "common/devices/attitude.hpp"
#include "common/devices/positions.hpp"

namespace fathom::devices {
namespace {

// ddmm.mmmm or dddmm.mmmm with its hemisphere, to radians.
std::optional<double> degrees_minutes(std::string_view text, std::string_view hemisphere, std::size_t degree_digits,
                                      char positive, char negative) {
  if (text.size() <= degree_digits || hemisphere.size() != 1) return {};
  if (hemisphere[0] != positive && hemisphere[0] != negative) return {};
  const auto degrees = whole(text.substr(0, degree_digits));
  const auto minutes = number(text.substr(degree_digits));
  if (!degrees || !minutes || *minutes < 0.0 || *minutes >= 60.0) return {};
  const double value = (static_cast<double>(*degrees) + *minutes / 60.0) * kRadians;
  return hemisphere[0] == positive ? value : -value;
}

}  // namespace

NmeaUsbl::NmeaUsbl(const Settings& settings)
    : NmeaParser{settings.checksum_required}, from_{settings.transceiver}, wanted_{settings.transceiver.beacon} {}

void NmeaUsbl::needs_origin(bool stated, std::string_view what) {
  if (!stated) complain("the system says " + std::string{what} + "; state those of the world's origin");
}

void NmeaUsbl::sentence(const Words& words, Frame& frame) {
  beacon_ = status_ = error_ = {};
  time_ = first_ = second_ = depth_ = accuracy_ = std::nullopt;
  p_WB_.reset();
  trusted_ = false;
  if (words[0] == "PSIMSSB") read_psimssb(words);
  if (words[0] == "PTSAG") read_ptsag(words);
  if (words[0] == "PTSAX" || words[0] == "PTSAY") read_ptsax(words);
  if (words[0] == "PSONLLD") read_psonlld(words);
  if (words[0] == "PSONALL") read_psonall(words);
  frame.device_time = time_;
  if (!beacon_.empty()) frame.lacks = lacking();
  if (!p_WB_) return;
  if (!wanted_.is(beacon_)) {
    frame.lacks = "a fix of another transponder";
    return complain(wanted_.complaint());
  }
  complain("");
  // The accuracy is the root of the sum of both horizontal variances; zero or less is none.
  const bool stated = accuracy_ && *accuracy_ > 0.0;
  const double sigma = stated ? *accuracy_ / std::numbers::sqrt2 : from_.sigma;
  sample_ = Usbl{.p_WB = *p_WB_, .sigma = Eigen::Vector3d::Constant(sigma), .valid = trusted_};
  frame.sample = &sample_;
}

// Why there is no position; what an operator could set right is in the complaint.
std::string_view NmeaUsbl::lacking() const {
  if (!first_ || !second_) return "position fields empty";
  return depth_ ? "the place of these coordinates is not stated, or it is the ship's own"
                : "depth field empty or not measured";
}

// time, transponder, status, error, coordinates, orientation, filter, X, Y, depth, accuracy
void NmeaUsbl::read_psimssb(const Words& words) {
  time_ = time_of_day(words[1]);
  beacon_ = words[2];
  status_ = words[3];
  error_ = words[4];
  first_ = words.number_at(8);
  second_ = words.number_at(9);
  depth_ = words.number_at(10);
  accuracy_ = words.number_at(11);
  trusted_ = status_ == "A" && error_.empty();
  if (!first_ || !second_ || !depth_) return;
  const double x = *first_;
  const double y = *second_;
  const double z = *depth_;
  const std::string_view coordinates = words[5];
  const std::string_view orientation = words[6];
  if (coordinates == "P" && (orientation == "H" || orientation == "N")) {
    const double bearing = y * kRadians;
    const auto from = orientation == "H" ? from_head_up : from_north_up;
    p_WB_ = from(x * std::cos(bearing), x * std::sin(bearing), z, from_);
  } else if (coordinates == "C") {
    if (orientation == "H") p_WB_ = from_head_up(y, x, z, from_);
    if (orientation == "N") p_WB_ = from_north_up(x, y, z, from_);
    if (orientation == "E") p_WB_ = from_north_up(y, x, z, from_);
  } else if (coordinates == "U") {
    if (orientation == "N") p_WB_ = from_grid(x, y, z, from_);
    if (orientation == "E") p_WB_ = from_grid(y, x, z, from_);
    needs_origin(from_.northing.has_value() && from_.easting.has_value(), "UTM northing and easting");
  } else if (coordinates == "R") {
    if (orientation == "N") p_WB_ = from_degrees(x, y, z, from_);
    if (orientation == "E") p_WB_ = from_degrees(y, x, z, from_);
    needs_origin(from_.latitude.has_value(), "latitude and longitude");
  }
}

// #frame, time, day, month, year, beacon
void NmeaUsbl::read_date_and_beacon(const Words& words) {
  const auto clock = time_of_day(words[2]);
  const auto day = whole(words[3]);
  const auto month = whole(words[4]);
  const auto year = whole(words[5]);
  if (clock && day && month && year) {
    if (const auto midnight = seconds_since_1970(*year, *month, *day, 0, 0, 0.0)) time_ = *midnight + *clock;
  }
  beacon_ = words[6];
}

// validity, depth, its validity
void NmeaUsbl::read_valid_depth(const Words& words, std::size_t validity) {
  status_ = words[validity];
  const std::string_view measured = words[validity + 2];
  if (measured == "1" || measured == "2") depth_ = words.number_at(validity + 1);
  trusted_ = !status_.empty();
}

// #frame, time, day, month, year, beacon, latitude, N, longitude, E, validity, depth, valid, depth of the sensor
void NmeaUsbl::read_ptsag(const Words& words) {
  read_date_and_beacon(words);
  const auto latitude = degrees_minutes(words[7], words[8], 2, 'N', 'S');
  const auto longitude = degrees_minutes(words[9], words[10], 3, 'E', 'W');
  if (latitude) first_ = *latitude / kRadians;
  if (longitude) second_ = *longitude / kRadians;
  read_valid_depth(words, 11);
  const bool ship = whole(beacon_) == 0;
  if (ship || !latitude || !longitude || !depth_) return;
  p_WB_ = from_degrees(*latitude, *longitude, *depth_, from_);
  needs_origin(from_.latitude.has_value(), "latitude and longitude");
}

// #frame, time, day, month, year, beacon, X, Y, validity, depth, valid, depth of the sensor
void NmeaUsbl::read_ptsax(const Words& words) {
  read_date_and_beacon(words);
  first_ = words.number_at(7);
  second_ = words.number_at(8);
  read_valid_depth(words, 9);
  const bool ship = whole(beacon_) == 0;
  if (ship || !first_ || !second_ || !depth_) return;
  const bool x = words[0] == "PTSAX";
  const std::optional<RelativeAxes>& axes = x ? from_.ptsax : from_.ptsay;
  if (!axes) {
    return complain("the system says X and Y ($" + std::string{words[0]} +
                    "), whose directions are not public; state '" + (x ? "ptsax" : "ptsay") +
                    "' of the transceiver as the system is set up, as in 'forward port'");
  }
  const Eigen::Vector2d place = axes->axes * Eigen::Vector2d{*first_, *second_};
  p_WB_ = (axes->head_up ? from_head_up : from_north_up)(place.x(), place.y(), *depth_, from_);
}

// time, name, A, latitude, longitude, depth, and accuracies whose meaning is not public
void NmeaUsbl::read_psonlld(const Words& words) {
  time_ = time_of_day(words[1]);
  beacon_ = words[2];
  status_ = words[3];
  first_ = words.number_at(4);
  second_ = words.number_at(5);
  depth_ = words.number_at(6);
  trusted_ = status_ == "A";
  if (!first_ || !second_ || !depth_) return;
  p_WB_ = from_degrees(*first_ * kRadians, *second_ * kRadians, *depth_, from_);
  needs_origin(from_.latitude.has_value(), "latitude and longitude");
}

// name, what, time, easting, northing, depth, heading
void NmeaUsbl::read_psonall(const Words& words) {
  beacon_ = words[1];
  time_ = time_of_day(words[3]);
  first_ = words.number_at(4);
  second_ = words.number_at(5);
  depth_ = words.number_at(6);
  trusted_ = true;
  if (!first_ || !second_ || !depth_) return;
  p_WB_ = from_grid(*second_, *first_, *depth_, from_);
  needs_origin(from_.northing.has_value() && from_.easting.has_value(), "UTM northing and easting");
}

void NmeaUsbl::describe_values(Fields& fields) const {
  fields.add("time_s", time_);
  fields.add("beacon", beacon_);
  fields.add("status", status_);
  fields.add("error", error_);
  fields.add("first", first_);
  fields.add("second", second_);
  fields.add("depth_m", depth_);
  fields.add("accuracy_m", accuracy_);
}

}  // namespace fathom::devices
