#include "test/support/wire_data.hpp"

#include <algorithm>
#include <sstream>
#include <stdexcept>

#include "common/devices/sample_fields.hpp"
#include "test/support/scratch.hpp"

namespace fathom::test {
namespace {

using devices::Settings;

class Collect final : public devices::Output {
 public:
  Collect(devices::Kind kind, const Settings& settings) : kind_{kind}, settings_{settings} {}
  void frame(const devices::Parser& parser, const devices::Frame& frame) override {
    WireRow row{.offset = frame.offset,
                .bytes = std::string{devices::as_text(frame.bytes)},
                .fields = {},
                .has_sample = frame.sample.index() != 0};
    class Into final : public devices::Fields {
     public:
      explicit Into(WireRow& into) : into_{into} {}
      void add(std::string_view name, std::string_view text) override { into_.fields.emplace_back(name, text); }

     private:
      WireRow& into_;
    } into{row};
    static_cast<devices::Fields&>(into).add("device_time", frame.device_time);
    parser.describe(into);
    devices::describe_sample(frame.sample, kind_, settings_, into);
    rows.push_back(std::move(row));
  }
  std::vector<WireRow> rows;

 private:
  devices::Kind kind_;
  const Settings& settings_;
};

std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> found{""};
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      found.emplace_back();
    } else if (c != '\r') {
      found.back() += c;
    }
  }
  return found;
}

Settings without_checksum() {
  Settings settings;
  settings.checksum_required = false;
  return settings;
}

Settings with_origin() {
  Settings settings;
  settings.transceiver.latitude = 0.9;
  settings.transceiver.longitude = 0.0;
  settings.transceiver.northing = 5688000.0;
  settings.transceiver.easting = 650000.0;
  return settings;
}

}  // namespace

bool WireRow::has(const std::string& name) const {
  return std::any_of(fields.begin(), fields.end(), [&](const auto& field) { return field.first == name; });
}

const std::string& WireRow::at(const std::string& name) const {
  static const std::string kNone;
  const auto found = std::find_if(fields.begin(), fields.end(), [&](const auto& field) { return field.first == name; });
  return found != fields.end() ? found->second : kNone;
}

double WireRow::value(const std::string& name) const {
  const std::string& text = at(name);
  if (text.empty()) throw std::runtime_error("no value of " + name);
  return std::stod(text);
}

std::vector<WireRow> decode_wire(devices::Parser& parser, const devices::Protocol& protocol,
                                 const devices::Settings& settings, const std::string& bytes, std::size_t piece) {
  Collect collect{protocol.kind, settings};
  const devices::Bytes all = devices::as_bytes(bytes);
  const std::size_t step = piece == 0 ? std::max<std::size_t>(1, all.size()) : piece;
  for (std::size_t at = 0; at < all.size(); at += step) {
    parser.feed(all.subspan(at, std::min(step, all.size() - at)), collect);
  }
  parser.finish(collect);
  return collect.rows;
}

const std::vector<WireRecording>& wire_recordings() {
  static const std::vector<WireRecording> kAll{
      {"pd0", "pd0_auv_dvl_short/adcp_auv_51.pd0", "pd0_auv_dvl_short/expected.csv"},
      {"pd0", "pd0_bad_checksum/LB180210_3_corrupted.PD0", "pd0_bad_checksum/expected.csv"},
      {"pd0", "pd0_glider_explorer/NE051400.PD0", "pd0_glider_explorer/expected.csv"},
      {"pd0", "pd0_workhorse_bt/RDI_withBT.000", "pd0_workhorse_bt/expected.csv"},
      {"pd0", "pd0_workhorse_truncated/RDI_test01.000", "pd0_workhorse_truncated/expected.csv"},
      {"pd6", "pd6_published_examples/examples.pd6", "pd6_published_examples/expected.csv", {}, false},
      {"wl_serial", "wl_serial_vendor_examples/examples.txt", "wl_serial_vendor_examples/expected.csv"},
      {"ig500", "sbg_ig500_vendor_frames/frames.bin", "sbg_ig500_vendor_frames/expected.csv"},
      {"nmea_attitude", "sbg_ig500_vendor_frames/ascii.txt", ""},
      {"sbg_ecom", "sbg_ecom_mixed/stream-mixed.bin", "sbg_ecom_mixed/expected.csv"},
      {"vn100", "vn100_short/F00294.bin", "vn100_short/expected.csv"},
      {"gx3", "gx3_short/20140313_191853.3dmgx3.log", "gx3_short/expected.csv"},
      {"nmea_attitude", "nmea_attitude_seapath330/stream.nmea", "nmea_attitude_seapath330/expected.csv"},
      {"nmea_depth", "nmea_depth_kidpt_a/stream.nmea", "nmea_depth_kidpt_a/expected.csv"},
      {"nmea_depth", "depth_prvat_examples/examples.nmea", "depth_prvat_examples/expected.csv"},
      {"nmea_usbl", "usbl_psimssb_examples/examples.nmea", "usbl_psimssb_examples/expected.csv", without_checksum(),
       false},
      {"nmea_usbl", "usbl_other_families/examples.txt", "usbl_other_families/expected.csv", with_origin()},
      {"evologics", "usbl_other_families/examples.txt", "", {}, false},
  };
  return kAll;
}

std::string wire_bytes(const std::string& file) {
  std::string bytes = read_bytes(std::string{FATHOM_SOURCE_DIR} + "/test/data/wire/" + file);
  if (bytes.empty()) throw std::runtime_error("no recording " + file);
  return bytes;
}

std::vector<std::vector<std::pair<std::string, std::string>>> wire_table(const std::string& file) {
  std::istringstream text{wire_bytes(file)};
  std::string line;
  std::getline(text, line);
  const std::vector<std::string> names = cells(line);
  std::vector<std::vector<std::pair<std::string, std::string>>> rows;
  while (std::getline(text, line)) {
    if (line.empty()) continue;
    const std::vector<std::string> values = cells(line);
    auto& row = rows.emplace_back();
    for (std::size_t i = 0; i < names.size(); ++i) row.emplace_back(names[i], i < values.size() ? values[i] : "");
  }
  return rows;
}

}  // namespace fathom::test
