#include "common/devices/velocity/pd6.hpp"

#include <algorithm>

#include "common/devices/attitude.hpp"

namespace fathom::devices {
namespace {

constexpr std::size_t kLongest = 160;
constexpr double kNone = -32768.0;
constexpr double kNoneToo = 88888.0;  // some makes

struct Grammar {
  std::string_view tag;
  std::string_view fields;  // n number, t time, s status, x text
};
constexpr std::array kGrammar{Grammar{"SA", "nnn"},   Grammar{"TS", "tnnnnx"}, Grammar{"RA", "nnnnn"},
                              Grammar{"WI", "nnnns"}, Grammar{"WS", "nnns"},   Grammar{"WE", "nnns"},
                              Grammar{"WD", "nnnnn"}, Grammar{"BI", "nnnns"},  Grammar{"BS", "nnns"},
                              Grammar{"BE", "nnns"},  Grammar{"BD", "nnnnn"},  Grammar{"HM", "xxxxxxx"}};

bool fits(char kind, std::string_view field) {
  switch (kind) {
    case 'n':
      return number(field).has_value();
    case 't':
      return field.size() == 14 && std::all_of(field.begin(), field.end(), [](char c) { return c >= '0' && c <= '9'; });
    case 's':
      return field == "A" || field == "V" || field == "I";
    default:
      return std::all_of(field.begin(), field.end(), [](char c) { return c > ' ' && c <= '~'; });
  }
}

// yymmddhhmmsscc; an unset clock says what is no date.
std::optional<double> clock(std::string_view text) {
  const auto two = [&](std::size_t i) { return (text[i] - '0') * 10 + (text[i + 1] - '0'); };
  return seconds_since_1970(2000 + two(0), two(2), two(4), two(6), two(8), two(10) + 0.01 * two(12));
}

}  // namespace

Pd6::Pd6(const Settings& settings) : Parser{kLongest}, settings_{settings} {}

std::optional<Pd6::Line> Pd6::read(std::string_view text) {
  if (text.size() < 4 || text[3] != ',') return {};
  const std::string_view tag = text.substr(1, 2);
  const auto grammar = std::find_if(kGrammar.begin(), kGrammar.end(), [&](const Grammar& g) { return g.tag == tag; });
  if (grammar == kGrammar.end()) return {};
  Line line{.tag = {tag[0], tag[1]}};
  std::string_view rest = text.substr(4);
  while (true) {
    if (line.count == grammar->fields.size()) return {};
    const std::size_t comma = rest.find(',');
    const std::string_view field = trim(rest.substr(0, comma));
    if (!fits(grammar->fields[line.count], field)) return {};
    line.field[line.count++] = field;
    if (comma == std::string_view::npos) break;
    rest.remove_prefix(comma + 1);
  }
  if (line.count != grammar->fields.size()) return {};
  return line;
}

Parser::Look Pd6::look(Bytes bytes) const {
  if (bytes[0] != ':') return skip_to(bytes, ':');
  const std::string_view text = as_text(bytes.first(std::min(bytes.size(), kLongest)));
  const std::size_t end = text.find_first_of("\r\n:", 1);
  if (end == std::string_view::npos) return text.size() < kLongest ? kMore : kBadFrame;
  if (text[end] == ':' || !read(text.substr(0, end))) return kBadFrame;
  return whole_frame(end + 1);
}

void Pd6::begin_ensemble() {
  pose_ = {};
  time_.reset();
  instrument_.reset();
  ship_.reset();
  earth_.reset();
  open_ = false;
}

std::optional<Eigen::Vector3d> Pd6::bottom(std::size_t status) const {
  if (line_.field[status] != "A") return {};
  Eigen::Vector3d v;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double value = number(line_.field[static_cast<std::size_t>(i)]).value_or(kNone);
    if (value == kNone || value == kNoneToo) return {};
    v(i) = 1e-3 * value;
  }
  return v;
}

std::optional<Eigen::Vector3d> Pd6::velocity() const {
  const bool instrument_first = settings_.instrument_axes || !ship_;
  DvlPose pose = pose_;
  if (settings_.water_linked_axes) {
    if (instrument_ && instrument_first) return settings_.R_BS * *instrument_;
    if (ship_) return Eigen::Vector3d{ship_->y(), ship_->x(), ship_->z()};
    return {};
  }
  if (instrument_ && instrument_first) {
    pose.frame = DvlFrame::kInstrument;
    pose.R_BS = settings_.R_BS;
    return to_body(*instrument_, pose);
  }
  pose.level = settings_.ship_is_level;
  pose.frame = ship_ ? DvlFrame::kShip : DvlFrame::kEarth;
  if (ship_) return to_body(*ship_, pose);
  if (earth_) return to_body(*earth_, pose);
  return {};
}

void Pd6::end_ensemble(Frame& frame, double altitude) {
  const auto v = velocity();
  sample_ = Dvl{.v_WB_B = v.value_or(Eigen::Vector3d::Zero()), .altitude = altitude, .valid = v.has_value()};
  frame.device_time = time_;
  frame.sample = &sample_;
  open_ = false;
}

void Pd6::take(Frame& frame) {
  text_ = as_text(frame.bytes.first(frame.bytes.size() - 1));
  line_ = *read(text_);
  const std::string_view tag = line_.name();
  const auto value = [&](std::size_t i) { return number(line_.field[i]).value_or(0.0); };
  if (tag == "SA") {
    if (open_) end_ensemble(frame, 0.0);
    begin_ensemble();
    pose_.pitch = kRadians * value(0);
    pose_.roll = kRadians * value(1);
    pose_.heading = kRadians * value(2);
  } else if (tag == "TS") {
    time_ = clock(line_.field[0]);
  } else if (tag == "BI") {
    instrument_ = bottom(4);
    open_ = true;
  } else if (tag == "BS") {
    ship_ = bottom(3);
    open_ = true;
  } else if (tag == "BE") {
    earth_ = bottom(3);
    open_ = true;
  } else if (tag == "BD") {
    if (open_) end_ensemble(frame, std::max(0.0, value(3)));
    begin_ensemble();
  }
}

void Pd6::describe(Fields& fields) const {
  fields.add("tag", line_.name());
  constexpr std::array kNames{"f1", "f2", "f3", "f4", "f5", "f6", "f7"};
  for (std::size_t i = 0; i < kMostFields; ++i) fields.add(kNames[i], line_.field[i]);
}

}  // namespace fathom::devices
