#include "common/devices/velocity/water_linked_json.hpp"

#include <algorithm>
#include <cmath>

#include "common/devices/json.hpp"
#include "common/devices/text.hpp"

namespace fathom::devices {
namespace {

constexpr std::size_t kLongest = 8192;

// Microseconds since 1970 fit into the 53 bits of a double.
std::optional<std::int64_t> microseconds(JsonCursor& json) {
  const auto value = json.number();
  if (!value || !(std::abs(*value) < 9e15)) return {};
  return std::llround(*value);
}

}  // namespace

WaterLinkedJson::WaterLinkedJson(const Settings& settings) : Parser{kLongest}, R_BS_{settings.R_BS} {}

bool WaterLinkedJson::read(std::string_view text, Report& report) {
  report = {};
  JsonCursor json{text};
  const auto transducer = [&](std::size_t) {
    Transducer one;
    std::size_t id = report.transducer.size();
    json.object([&](std::string_view key) {
      if (key == "id") {
        id = static_cast<std::size_t>(std::clamp(json.number().value_or(4.0), 0.0, 4.0));
      } else if (key == "velocity") {
        one.velocity = json.number();
      } else if (key == "distance") {
        one.distance = json.number();
      } else if (key == "rssi") {
        one.rssi = json.number();
      } else if (key == "nsd") {
        one.nsd = json.number();
      } else if (key == "beam_valid") {
        one.valid = json.boolean();
      } else {
        json.skip();
      }
    });
    if (id < report.transducer.size()) report.transducer[id] = one;
  };
  const auto covariance = [&](std::size_t row) {
    json.array([&](std::size_t column) {
      const auto value = json.number();
      if (row < 3 && column < 3) report.covariance[3 * row + column] = value;
    });
  };
  struct Number {
    std::string_view key;
    std::optional<double> Report::*field;
  };
  static constexpr std::array kNumbers{
      Number{"time", &Report::time_ms},  Number{"vx", &Report::vx},       Number{"vy", &Report::vy},
      Number{"vz", &Report::vz},         Number{"fom", &Report::fom},     Number{"altitude", &Report::altitude},
      Number{"status", &Report::status}, Number{"ts", &Report::ts},       Number{"x", &Report::x},
      Number{"y", &Report::y},           Number{"z", &Report::z},         Number{"std", &Report::std_m},
      Number{"roll", &Report::roll},     Number{"pitch", &Report::pitch}, Number{"yaw", &Report::yaw}};
  json.object([&](std::string_view key) {
    for (const Number& each : kNumbers) {
      if (each.key != key) continue;
      report.*each.field = json.number();
      return;
    }
    if (key == "type") {
      report.type = json.string();
    } else if (key == "format") {
      report.format = json.string();
    } else if (key == "response_to") {
      report.response_to = json.string();
    } else if (key == "error_message") {
      report.error = json.string();
    } else if (key == "velocity_valid") {
      report.valid = json.boolean();
    } else if (key == "success") {
      report.success = json.boolean();
    } else if (key == "time_of_validity") {
      report.time_of_validity = microseconds(json);
    } else if (key == "time_of_transmission") {
      report.time_of_transmission = microseconds(json);
    } else if (key == "covariance") {
      json.array(covariance);
    } else if (key == "transducers") {
      json.array(transducer);
    } else {
      json.skip();
    }
  });
  if (!json.finished()) return false;
  if (report.type.empty()) report.type = report.vx ? "velocity" : "";  // json_v1
  if (report.type.starts_with("velocity")) return report.valid && report.vx && report.vy && report.vz;
  return report.type == "position_local" || report.type == "response";
}

// Another version may mean something else by the same words.
bool WaterLinkedJson::known(std::string_view format) {
  const std::string_view version = format.substr(0, format.find('.'));
  return format.empty() || version == "json_v1" || version == "json_v2" || version == "json_v3";
}

Parser::Look WaterLinkedJson::look(Bytes bytes) const {
  if (bytes[0] != '{') return skip_to(bytes, '{');
  const std::string_view text = as_text(bytes.first(std::min(bytes.size(), kLongest)));
  const std::size_t end = text.find('\n');
  if (end == std::string_view::npos) return text.size() < kLongest ? kMore : kBadFrame;
  const bool whole = read(text.substr(0, end), report_);
  if (!known(report_.format)) {
    complain("the instrument speaks " + std::string{report_.format.substr(0, 20)} +
             ", not json_v1 to json_v3; its firmware is newer than this driver");
  }
  return whole ? whole_frame(end + 1) : kBadFrame;
}

void WaterLinkedJson::take(Frame& frame) {
  const Report& report = report_;
  if (report.success && !*report.success) {
    complain("the instrument refused the command " + std::string{report.response_to.substr(0, 40)} + ": " +
             std::string{report.error.substr(0, 80)});
  }
  if (report.type != "velocity" || !known(report.format)) return;
  sample_ = Dvl{.altitude = std::max(0.0, report.altitude.value_or(0.0)), .valid = *report.valid};
  if (sample_.valid) sample_.v_WB_B = R_BS_ * Eigen::Vector3d{*report.vx, *report.vy, *report.vz};
  if (report.time_of_validity) frame.device_time = 1e-6 * static_cast<double>(*report.time_of_validity);
  frame.sample = &sample_;
}

void WaterLinkedJson::describe(Fields& fields) const {
  const Report& report = report_;
  const auto flag = [&](const char* name, std::optional<bool> value) {
    fields.add(name, value ? (*value ? "true" : "false") : "");
  };
  fields.add("type", report.type);
  fields.add("format", report.format);
  fields.add("time_ms", report.time_ms);
  fields.add("vx_mps", report.vx);
  fields.add("vy_mps", report.vy);
  fields.add("vz_mps", report.vz);
  fields.add("fom_mps", report.fom);
  fields.add("altitude_m", report.altitude);
  flag("velocity_valid", report.valid);
  fields.add("status", report.status);
  fields.add("time_of_validity_us", report.time_of_validity);
  fields.add("time_of_transmission_us", report.time_of_transmission);
  constexpr std::array kCovariance{"c00", "c01", "c02", "c10", "c11", "c12", "c20", "c21", "c22"};
  for (std::size_t i = 0; i < 9; ++i) fields.add(kCovariance[i], report.covariance[i]);
  constexpr std::array<std::array<const char*, 5>, 4> kNames{{
      {"t0_velocity_mps", "t0_distance_m", "t0_rssi", "t0_nsd", "t0_valid"},
      {"t1_velocity_mps", "t1_distance_m", "t1_rssi", "t1_nsd", "t1_valid"},
      {"t2_velocity_mps", "t2_distance_m", "t2_rssi", "t2_nsd", "t2_valid"},
      {"t3_velocity_mps", "t3_distance_m", "t3_rssi", "t3_nsd", "t3_valid"},
  }};
  for (std::size_t i = 0; i < 4; ++i) {
    const Transducer& one = report.transducer[i];
    fields.add(kNames[i][0], one.velocity);
    fields.add(kNames[i][1], one.distance);
    fields.add(kNames[i][2], one.rssi);
    fields.add(kNames[i][3], one.nsd);
    flag(kNames[i][4], one.valid);
  }
  fields.add("ts_s", report.ts);
  fields.add("x_m", report.x);
  fields.add("y_m", report.y);
  fields.add("z_m", report.z);
  fields.add("std_m", report.std_m);
  fields.add("roll_deg", report.roll);
  fields.add("pitch_deg", report.pitch);
  fields.add("yaw_deg", report.yaw);
  fields.add("response_to", report.response_to);
  flag("success", report.success);
}

}  // namespace fathom::devices
