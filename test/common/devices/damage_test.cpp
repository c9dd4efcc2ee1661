// Damaged copies of every recording: nothing crashes, nothing is told that a checksum could have caught, and the next
// good frame is told.
#include <doctest/doctest.h>

#include <map>
#include <random>
#include <set>

#include "common/devices/emulation/emulation.hpp"
#include "test/support/wire_data.hpp"

using namespace fathom;
using namespace fathom::test;

namespace {

constexpr std::size_t kCut = 60'000;  // bytes of a recording that are damaged
constexpr int kRounds = 20;           // other places each time

struct Stream {
  std::string name, protocol, bytes;
  devices::Settings settings;
  bool checksum{};
};

// Recordings, and where there is none of a protocol, what an emulated instrument sends.
std::vector<Stream> streams() {
  std::vector<Stream> all;
  for (const WireRecording& recording : wire_recordings()) {
    all.push_back({recording.file, recording.protocol, wire_bytes(recording.file).substr(0, kCut), recording.settings,
                   recording.checksum});
  }
  for (const char* protocol : {"ig500", "vn100", "gx3", "xsens", "pd4", "pd6", "wl_json", "nortek_text", "nortek_ad2cp",
                               "cerulean", "seatrac", "psimlbm", "range_text", "load_text"}) {
    Stream stream{std::string{"emulated "} + protocol, protocol, "", {}, true};
    for (int i = 0; i < 100; ++i) {
      const double t = 0.1 * i;
      stream.bytes += devices::emulate(protocol, devices::emulated_motion(1.7e9 + t, t, {}), {});
    }
    const std::string name{protocol};
    stream.checksum = name != "pd6" && name != "wl_json" && name != "range_text" && name != "load_text";
    all.push_back(std::move(stream));
  }
  return all;
}

struct Told {
  std::vector<WireRow> rows;
  devices::Counters counters;
};

Told decode(const Stream& stream, const std::string& bytes) {
  const devices::Protocol& known = devices::protocol(stream.protocol, "test");
  const auto parser = known.make(stream.settings);
  std::vector<WireRow> rows = decode_wire(*parser, known, stream.settings, bytes);
  return {std::move(rows), parser->counters()};
}

// Without what the line's end adds: a damaged CR is still followed by its LF, and hexadecimal digits of a checksum may
// be small or capital.
std::string contents(const std::string& bytes) {
  const std::string line = bytes.substr(0, bytes.find_last_not_of("\r\n") + 1);
  return line.size() > 3 && line[line.size() - 3] == '*' ? line.substr(0, line.size() - 3) : line;
}

std::multiset<std::string> contents_of(const std::vector<WireRow>& rows) {
  std::multiset<std::string> all;
  for (const WireRow& row : rows) all.insert(contents(row.bytes));
  return all;
}

}  // namespace

TEST_CASE("damage: one flipped bit costs its own frame and nothing else") {
  std::mt19937 random{1};
  for (const Stream& stream : streams()) {
    CAPTURE(stream.name);
    const auto whole = decode(stream, stream.bytes).rows;
    for (int round = 0; round < kRounds; ++round) {
      std::string bytes = stream.bytes;
      std::set<std::size_t> hit;  // every fourth frame
      for (std::size_t i = static_cast<std::size_t>(round % 4); i < whole.size(); i += 4) {
        std::uniform_int_distribution<std::size_t> place{0, whole[i].bytes.size() - 1};
        bytes[whole[i].offset + place(random)] ^= static_cast<char>(1 << random() % 8);
        hit.insert(i);
      }
      auto left = contents_of(decode(stream, bytes).rows);
      std::size_t lost = 0;
      for (const bool damaged : {false, true}) {  // equal lines are told apart by counting the whole ones first
        for (std::size_t i = 0; i < whole.size(); ++i) {
          if (hit.contains(i) != damaged) continue;
          const auto found = left.find(contents(whole[i].bytes));
          if (found != left.end()) {
            left.erase(found);
          } else if (!damaged) {
            ++lost;
          }
        }
      }
      CHECK(lost == 0);
      if (stream.checksum) CHECK(left.empty());  // what is left was never sent
    }
  }
}

TEST_CASE("damage: lost bytes and inserted rubbish are skipped, and what was never sent is not told") {
  std::mt19937 random{2};
  for (const Stream& stream : streams()) {
    CAPTURE(stream.name);
    const auto sent = contents_of(decode(stream, stream.bytes).rows);
    for (int round = 0; round < kRounds; ++round) {
      std::string bytes;
      std::size_t wounds = 0;
      std::uniform_int_distribution<std::size_t> stretch{50, 1500};
      for (std::size_t at = 0; at < stream.bytes.size();) {
        const std::size_t length = stretch(random);
        bytes += stream.bytes.substr(at, length);
        at += length;
        ++wounds;
        if (random() % 2 == 0) {
          at += random() % 40;  // lost
        } else {
          for (std::size_t i = random() % 40; i > 0; --i) bytes += static_cast<char>(random() & 0xFF);
        }
      }
      const Told told = decode(stream, bytes);
      CHECK(told.rows.size() + 2 * wounds >= sent.size());  // a wound may lie across the border of two frames
      if (!stream.checksum) continue;
      std::size_t foreign = 0;
      for (const WireRow& row : told.rows) foreign += sent.contains(contents(row.bytes)) ? 0 : 1;
      // Eight bits of checksum let one wound in 256 pass, more where a line ends in the tail of one like it; sixteen
      // let next to none.
      const bool eight_bits = stream.bytes[0] == '$' || stream.bytes[0] == 'w' || stream.protocol == "xsens";
      CHECK(foreign <= (eight_bits ? 2 + wounds / 40 : 0));
    }
  }
}

TEST_CASE("damage: rubbish alone gives no sample and no crash, in pieces of any size") {
  std::mt19937 random{3};
  std::string rubbish(200'000, '\0');
  for (char& byte : rubbish) byte = static_cast<char>(random() & 0xFF);
  for (const devices::Protocol& protocol : devices::protocols()) {
    CAPTURE(protocol.name);
    for (const std::size_t piece : std::initializer_list<std::size_t>{0, 1, 977}) {
      const auto parser = protocol.make({});
      const auto rows = decode_wire(*parser, protocol, {}, rubbish, piece);
      CHECK(rows.size() <= 4);  // a checksum of 16 bits lets one in 65536 chances pass
      CHECK(parser->counters().skipped + 1000 > rubbish.size());
    }
  }
}

TEST_CASE("damage: a header that claims an absurd length does not hold up the stream") {
  const devices::Instant now = devices::emulated_motion(1.7e9, 1.0, {});
  const std::map<std::string, std::string> headers{{"pd0", std::string{"\x7F\x7F\xF0\xFF\x00\x06", 6}},
                                                   {"ig500", std::string{"\xFF\x02\x90\xFF\xFF", 5}},
                                                   {"sbg_ecom", std::string{"\xFF\x5A\x06\x00\xFF\xFF", 6}},
                                                   {"evologics", "+++AT:99999:"},
                                                   {"wl_json", "{\"a\":"},
                                                   {"nmea_usbl", "$PSIMSSB,"}};
  for (const auto& entry : headers) {
    const std::string& name = entry.first;
    const std::string& header = entry.second;
    CAPTURE(name);
    Stream stream{name, name, header + devices::emulate(name, now, {}), {}, true};
    const Told told = decode(stream, stream.bytes);
    CHECK_FALSE(told.rows.empty());
    CHECK(told.counters.bad_frame >= 1);
  }
}

TEST_CASE("damage: an interrupted line begins anew") {
  const devices::Protocol& known = devices::protocol("ig500", "test");
  const auto parser = known.make({});
  const std::string frame = devices::emulate("ig500", devices::emulated_motion(1.7e9, 1.0, {}), {});
  (void)decode_wire(*parser, known, {}, frame.substr(0, 10));
  parser->restart();
  CHECK(decode_wire(*parser, known, {}, frame).size() == 1);
}
