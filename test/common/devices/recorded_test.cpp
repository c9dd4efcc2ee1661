// Every recorded frame against the table of values that came with the recording, field by field; and the same stream
// cut into pieces of any size.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>
#include <sstream>

#include "common/devices/velocity/pd0.hpp"
#include "test/support/wire_data.hpp"

using namespace fathom;
using namespace fathom::test;

namespace {

using Row = std::vector<std::pair<std::string, std::string>>;

constexpr std::size_t kCut = 100'000;  // bytes of a recording that are fed one by one
constexpr double kPrinted = 1e-8;      // relative: the tables print nine digits

// Columns that describe the table, not the frame.
const std::set<std::string> kNotFields{"line_no", "crc_ok", "offset"};

bool same(const std::string& told, const std::string& wanted) {
  if (told == wanted) return true;
  char* told_end = nullptr;
  char* wanted_end = nullptr;
  const double a = std::strtod(told.c_str(), &told_end);
  const double b = std::strtod(wanted.c_str(), &wanted_end);
  if (told.empty() || wanted.empty() || *told_end != '\0' || *wanted_end != '\0') return false;
  return std::abs(a - b) <= kPrinted * std::abs(b);
}

// "a=1;b=2" of one column as columns of their own.
Row spread(const std::string& text) {
  Row row;
  std::istringstream parts{text};
  std::string part;
  while (std::getline(parts, part, ';')) {
    const auto equals = part.find('=');
    row.emplace_back(part.substr(0, equals), part.substr(equals + 1));
  }
  return row;
}

std::string of(const Row& row, const std::string& name) {
  for (const auto& [key, text] : row) {
    if (key == name) return text;
  }
  return {};
}

// Rows that must be frames: not those that the table calls bad, and not those of another protocol.
std::vector<Row> wanted_frames(const WireRecording& recording) {
  std::vector<Row> rows;
  for (const Row& row : wire_table(recording.expected)) {
    const std::string checksum = of(row, "checksum");
    if (checksum == "bad" || checksum == "not_nmea") continue;
    rows.push_back(row);
  }
  return rows;
}

int compare(const WireRow& told, const Row& wanted, bool spread_fields) {
  int compared = 0;
  for (const auto& column : wanted) {
    const std::string& name = column.first;
    const std::string& text = column.second;
    if (name == "offset") {
      CHECK(told.offset == std::stoull(text));
      ++compared;
      continue;
    }
    if (kNotFields.contains(name)) continue;
    if (spread_fields && name == "fields") {
      for (const auto& field : spread(text)) {
        CAPTURE(field.first);
        CAPTURE(told.offset);
        CHECK_MESSAGE(same(told.at(field.first), field.second), told.at(field.first), " instead of ", field.second);
        ++compared;
      }
      continue;
    }
    CAPTURE(name);
    CAPTURE(told.offset);
    REQUIRE(told.has(name));
    CHECK_MESSAGE(same(told.at(name), text), told.at(name), " instead of ", text);
    ++compared;
  }
  return compared;
}

}  // namespace

TEST_CASE("recordings: every field of every frame is the one of the recording's table") {
  int total = 0;
  for (const WireRecording& recording : wire_recordings()) {
    if (recording.expected.empty()) continue;
    CAPTURE(recording.file);
    const devices::Protocol& protocol = devices::protocol(recording.protocol, "test");
    const auto parser = protocol.make(recording.settings);
    const auto rows = decode_wire(*parser, protocol, recording.settings, wire_bytes(recording.file));
    const auto wanted = wanted_frames(recording);
    REQUIRE(rows.size() == wanted.size());
    int compared = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      compared += compare(rows[i], wanted[i], recording.protocol == "sbg_ecom");
    }
    CHECK(compared > 0);
    total += compared;
    const devices::Counters& counters = parser->counters();
    CHECK(counters.frames == rows.size());
    CHECK(counters.bytes == wire_bytes(recording.file).size());
  }
  MESSAGE("fields compared: ", total);
  CHECK(total > 150'000);
}

TEST_CASE("recordings: what is left over is counted as the recordings' notes say") {
  const auto count = [](const std::string& protocol, const std::string& file) {
    const devices::Protocol& known = devices::protocol(protocol, "test");
    const auto parser = known.make({});
    (void)decode_wire(*parser, known, {}, wire_bytes(file));
    return parser->counters();
  };
  CHECK(count("pd0", "pd0_workhorse_bt/RDI_withBT.000").incomplete == 99);
  CHECK(count("pd0", "pd0_workhorse_truncated/RDI_test01.000").incomplete == 772);
  CHECK(count("pd0", "pd0_auv_dvl_short/adcp_auv_51.pd0").skipped == 0);
  CHECK(count("pd0", "pd0_bad_checksum/LB180210_3_corrupted.PD0").bad_checksum >= 1);
  CHECK(count("nmea_attitude", "nmea_attitude_seapath330/stream.nmea").bad_checksum == 0);
  CHECK(count("wl_serial", "wl_serial_vendor_examples/examples.txt").frames == 20);
}

namespace {

class CompareProfile final : public devices::Output {
 public:
  explicit CompareProfile(const std::string& table) : wanted_{wire_table(table)} {}
  void frame(const devices::Parser& parser, const devices::Frame&) override {
    const auto& pd0 = dynamic_cast<const devices::Pd0&>(parser);
    const std::string index = std::to_string(ensemble_++);
    for (const Row& row : wanted_) {
      if (of(row, "ens_index") != index) continue;
      const std::size_t cell = std::stoul(of(row, "cell"));
      REQUIRE(cell < pd0.cells());
      for (std::size_t beam = 0; beam < 4; ++beam) {
        const std::string number = std::to_string(beam + 1);
        CHECK(std::to_string(pd0.velocity(cell, beam)) == of(row, "vel" + number));
        CHECK(std::to_string(pd0.correlation(cell, beam)) == of(row, "corr" + number));
        CHECK(std::to_string(pd0.echo(cell, beam)) == of(row, "echo" + number));
        compared += 3;
      }
    }
  }
  int compared{};

 private:
  std::vector<Row> wanted_;
  int ensemble_{};
};

}  // namespace

TEST_CASE("recordings: PD0 profiles agree cell by cell") {
  int compared = 0;
  for (const auto* name : {"pd0_auv_dvl_short", "pd0_glider_explorer", "pd0_workhorse_bt", "pd0_workhorse_truncated"}) {
    const std::string folder{name};
    const auto recording = std::find_if(wire_recordings().begin(), wire_recordings().end(),
                                        [&](const auto& each) { return each.file.starts_with(folder); });
    CompareProfile check{folder + "/profile.csv"};
    devices::Pd0 parser{{}};
    parser.feed(devices::as_bytes(wire_bytes(recording->file)), check);
    compared += check.compared;
  }
  MESSAGE("profile values compared: ", compared);
  CHECK(compared > 2000);
}

TEST_CASE("recordings: the same stream cut into pieces of any size gives the same rows") {
  for (const WireRecording& recording : wire_recordings()) {
    CAPTURE(recording.file);
    const devices::Protocol& protocol = devices::protocol(recording.protocol, "test");
    const std::string bytes = wire_bytes(recording.file).substr(0, kCut);
    const auto whole = protocol.make(recording.settings);
    const auto rows = decode_wire(*whole, protocol, recording.settings, bytes);
    CHECK_FALSE(rows.empty());
    for (const std::size_t piece : std::initializer_list<std::size_t>{1, 2, 3, 7, 1000}) {
      CAPTURE(piece);
      const auto parser = protocol.make(recording.settings);
      CHECK((decode_wire(*parser, protocol, recording.settings, bytes, piece) == rows));
      CHECK(parser->counters().bad_checksum == whole->counters().bad_checksum);
      CHECK(parser->counters().skipped == whole->counters().skipped);
      CHECK(parser->counters().incomplete == whole->counters().incomplete);
    }
  }
}

TEST_CASE("recordings: every byte is in a frame, skipped or cut off") {
  for (const WireRecording& recording : wire_recordings()) {
    CAPTURE(recording.file);
    const devices::Protocol& protocol = devices::protocol(recording.protocol, "test");
    const auto parser = protocol.make(recording.settings);
    std::size_t in_frames = 0;
    for (const WireRow& row : decode_wire(*parser, protocol, recording.settings, wire_bytes(recording.file))) {
      in_frames += row.bytes.size();
    }
    const devices::Counters& counters = parser->counters();
    CHECK(in_frames + counters.line_ends + counters.skipped + counters.incomplete == counters.bytes);
  }
}
