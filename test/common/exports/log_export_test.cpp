// Logs to CSV and MCAP and back, and what a log is said to hold.
#include "common/exports/log_export.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/base/error.hpp"
#include "common/recordings/little.hpp"
#include "common/recordings/mcap/mcap.hpp"
#include "common/recordings/unpack.hpp"
#include "common/wire/log_writer.hpp"
#include "test/support/filled_samples.hpp"
#include "test/support/scratch.hpp"

namespace fathom {
namespace {

constexpr Utime kStart = 1'716'811'200'000'000;  // 2024-05-27 12:00 UTC

/// Two seconds of STATE at 50 Hz with a pause, SMOOTHED at 10 Hz, and a process that tells its configuration.
Recording recording() {
  test::Fill fill;
  Recording r;
  for (int k = 0; k < 100; ++k) {
    if (k >= 40 && k < 60) continue;
    StateEstimate state;
    test::fill(fill, state);
    state.utime = kStart + 20'000 * k;
    r.state.push_back(state);
  }
  for (int k = 0; k < 20; ++k) {
    SmoothedState smoothed;
    test::fill(fill, smoothed);
    smoothed.utime = kStart + 100'000 * k;
    r.smoothed.push_back(smoothed);
  }
  for (int k = 1; k < 4; ++k) {
    EffectRanking ranking;
    test::fill(fill, ranking);
    ranking.utime = kStart + 500'000 * k;
    ranking.candidates.resize(static_cast<std::size_t>(k), ranking.candidates.front());
    ranking.against = "a \"quoted\", word";
    r.effects.push_back(ranking);
  }
  r.process_info = {{kStart, "estimator", "1.2", "# file a.yaml\nfilter: ekf\n", "says STATE state_t"}};
  return r;
}

struct LogFile {
  test::Scratch scratch;
  Recording written = recording();
  std::string path = scratch.path("run.lcmlog");
  LogFile() { (void)wire::write_log(written, path); }
};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream{text};
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// The messages of a channel, read by the format's specification alone (mcap.dev/spec).
std::vector<nlohmann::json> messages_of(const std::string& bytes, const std::string& topic) {
  using namespace recordings;
  std::vector<nlohmann::json> found;
  std::uint16_t wanted = 0;
  const auto read = [&](Bytes records, const auto& again) -> void {
    while (records.size() >= 9) {
      const std::uint8_t opcode = records[0];
      const auto length = static_cast<std::size_t>(little<std::uint64_t>(records, 1));
      const Bytes body = records.subspan(9, length);
      if (opcode == 4) {
        const auto size = little<std::uint32_t>(body, 4);
        if (std::string{body.begin() + 8, body.begin() + 8 + size} == topic) wanted = little<std::uint16_t>(body, 0);
      } else if (opcode == 5 && little<std::uint16_t>(body, 0) == wanted) {
        found.push_back(nlohmann::json::parse(body.begin() + 22, body.end()));
      } else if (opcode == 6) {
        const auto name = little<std::uint32_t>(body, 28);
        Unpacked unpacked;
        unpack(Packing::kZstd, body.subspan(32 + name + 8), little<std::uint64_t>(body, 16), unpacked);
        REQUIRE(unpacked.whole);
        again(unpacked.bytes, again);
      }
      records = records.subspan(9 + length);
    }
  };
  const Bytes all{reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
  read(all.subspan(8, all.size() - 16), read);
  return found;
}

/// Counts what the reader of this house sees.
struct Counting final : recordings::Sink {
  std::vector<recordings::Topic> topics;
  std::vector<int> messages;
  bool topic(std::size_t, const recordings::Topic& one) override {
    topics.push_back(one);
    messages.push_back(0);
    return true;
  }
  void further_field(std::size_t, const recordings::Field&) override {}
  void message(std::size_t topic, recordings::Stamp stamp, std::span<const double>) override {
    CHECK(stamp.log >= kStart);
    ++messages[topic];
  }
  void text(std::size_t, std::string_view, std::string_view) override {}
};

}  // namespace

TEST_CASE("export: CSV has every number of every channel, and says what the columns are") {
  LogFile log;
  const exports::Exported exported = exports::to_csv(log.path, log.scratch.path("csv"), {});
  CHECK(exported.written.at("STATE") == 80);
  CHECK(exported.written.at("SMOOTHED") == 20);
  CHECK(exported.damaged.empty());
  const auto lines = lines_of(test::read_bytes(log.scratch.path("csv/STATE.csv")));
  REQUIRE(lines.size() == 81);
  CHECK(lines[0].starts_with("t,utime,p_WB[0],p_WB[1],p_WB[2],q_WB[0]"));
  std::istringstream row{lines[41]};  // behind the pause
  std::string cell;
  std::getline(row, cell, ',');
  CHECK(std::stod(cell) == doctest::Approx(1.2));
  std::getline(row, cell, ',');
  CHECK(cell == std::to_string(kStart + 1'200'000));
  for (int i = 0; i < 3; ++i) {
    std::getline(row, cell, ',');
    CHECK(std::stod(cell) == log.written.state[40].p_WB[i]);  // to the last bit
  }
  const std::string about = test::read_bytes(log.scratch.path("csv/columns.txt"));
  CHECK(about.find("p_WB[3]: double, [m] Bo from Wo, in W (NED)") != std::string::npos);
  CHECK(test::read_bytes(log.scratch.path("csv/SMOOTHED.csv")).find("nu_dot[5]") != std::string::npos);
}

TEST_CASE("export: lists that grow become further columns, words are quoted") {
  LogFile log;
  const std::vector<std::string> only{"EFFECTS"};
  (void)exports::to_csv(log.path, log.scratch.path("csv"), only);
  const auto lines = lines_of(test::read_bytes(log.scratch.path("csv/EFFECTS.csv")));
  REQUIRE(lines.size() == 4);
  CHECK(lines[0].find("candidates[2].log_odds") != std::string::npos);
  CHECK(lines[1].starts_with("0.5,"));  // s since the log's first message, whatever is asked for
  CHECK(lines[1].find("\"a \"\"quoted\"\", word\"") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(log.scratch.path("csv/STATE.csv")));
  const std::vector<std::string> none{"SONAR"};
  const std::string said =
      test::complaint_of<InputError>([&] { (void)exports::to_csv(log.path, log.scratch.path("x"), none); });
  CHECK(said.find("has no channel SONAR; it has EFFECTS, PROCESS_INFO, SMOOTHED, STATE") != std::string::npos);
}

TEST_CASE("export: MCAP is read back, message by message, with a schema for each channel") {
  LogFile log;
  const std::string path = log.scratch.path("run.mcap");
  const exports::Exported exported = exports::to_mcap(log.path, path, {});
  CHECK(exported.written.at("STATE") == 80);
  const std::string bytes = test::read_bytes(path);
  const auto states = messages_of(bytes, "STATE");
  REQUIRE(states.size() == 80);
  for (std::size_t k = 0; k < states.size(); ++k) {
    CHECK(states[k].at("utime") == log.written.state[k].utime);
    CHECK(states[k].at("nu")[5] == log.written.state[k].nu[5]);
  }
  CHECK(messages_of(bytes, "PROCESS_INFO")[0].at("config") == "# file a.yaml\nfilter: ekf\n");
  CHECK(bytes.find("jsonschema") != std::string::npos);

  Counting counting;
  recordings::Damage damage;
  recordings::mcap::read(path, counting, damage);
  CHECK(damage.bytes() == 0);
  REQUIRE(counting.topics.size() == 4);
  int sum = 0;
  for (const int count : counting.messages) sum += count;
  CHECK(sum == 80 + 20 + 3 + 1);
}

TEST_CASE("export: the footer of an MCAP file leads to its summary") {
  using namespace recordings;
  LogFile log;
  const std::string path = log.scratch.path("run.mcap");
  (void)exports::to_mcap(log.path, path, {});
  const std::string text = test::read_bytes(path);
  const Bytes bytes{reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
  const Bytes footer = bytes.subspan(bytes.size() - 8 - 29, 29);
  CHECK(footer[0] == 2);
  CHECK(little<std::uint64_t>(footer, 1) == 20);
  const auto summary = little<std::uint64_t>(footer, 9), offsets = little<std::uint64_t>(footer, 17);
  REQUIRE(summary < offsets);
  REQUIRE(offsets < bytes.size());
  CHECK(bytes[summary] == 3);        // schemas come first
  CHECK(bytes[offsets] == 0x0E);     // summary offsets
  CHECK(bytes[summary - 13] == 15);  // behind the end of the data, whose checksum has four bytes
  const Bytes covered = bytes.subspan(summary, bytes.size() - 8 - 4 - summary);
  CHECK(crc32(covered) == little<std::uint32_t>(footer, 25));
}

TEST_CASE("export: arrays for NumPy hold all digits, whole numbers as such, and units") {
  LogFile log;
  const std::string path = log.scratch.path("run.npz"), again = log.scratch.path("again.npz");
  const exports::Exported exported = exports::to_npz(log.path, path, {});
  CHECK(exported.written.at("STATE") == 80);
  (void)exports::to_npz(log.path, again, {});
  const std::string bytes = test::read_bytes(path);
  CHECK(bytes == test::read_bytes(again));
  // Members are stored as they are: NEP 1 alone reads them.
  const auto member = [&](const std::string& name, const std::string& header) {
    const auto at = bytes.find(name + ".npy");
    REQUIRE(at != std::string::npos);
    const auto begin = bytes.find("\x93NUMPY", at);
    const auto text = bytes.find('{', begin), end = bytes.find('\n', text);
    CAPTURE(bytes.substr(text, end - text));
    CHECK(bytes.substr(text, end - text).find(header) != std::string::npos);
    CHECK((end + 1 - begin) % 64 == 0);
    return bytes.substr(end + 1);
  };
  const auto number = [](const std::string& data, std::size_t i, auto value) {
    std::memcpy(&value, data.data() + i * sizeof value, sizeof value);
    return value;
  };
  const std::string nu = member("STATE/nu", "'<f8', 'fortran_order': False, 'shape': (80,6,)");
  const std::string utime = member("STATE/utime", "'<i8', 'fortran_order': False, 'shape': (80,)");
  for (std::size_t k = 0; k < 80; ++k) {
    CHECK(number(nu, 6 * k + 5, 0.0) == log.written.state[k].nu[5]);
    CHECK(number(utime, k, std::int64_t{}) == log.written.state[k].utime);
  }
  (void)member("STATE/valid", "'|b1'");
  // Lists of one, two and three entries: what is missing is no number.
  const std::string odds = member("EFFECTS/candidates.log_odds", "'<f8', 'fortran_order': False, 'shape': (3,3,)");
  CHECK(number(odds, 0, 0.0) == log.written.effects[0].candidates[0].log_odds);
  CHECK(std::isnan(number(odds, 1, 0.0)));
  CHECK(number(odds, 8, 0.0) == log.written.effects[2].candidates[2].log_odds);
  const std::string about = member("about", "'<U");
  std::string plain;
  for (std::size_t i = 0; i + 4 <= about.size() && plain.find("]} ") == std::string::npos && i < 400000; i += 4)
    plain += about[i];
  CHECK(plain.find(R"~("p_WB":{"type":"double","unit":"m","comment":"[m] Bo from Wo, in W (NED)"})~") !=
        std::string::npos);
}

TEST_CASE("info: channels with their rates and pauses, and the configuration that a log carries") {
  LogFile log;
  const exports::LogSummary summary = exports::summary_of(log.path);
  CHECK(summary.events == 104);
  const auto state = std::ranges::find(summary.channels, "STATE", &exports::ChannelSummary::channel);
  REQUIRE(state != summary.channels.end());
  CHECK(state->type == "state_t");
  CHECK(state->rate == doctest::Approx(79.0 / 1.98));
  CHECK(state->longest == doctest::Approx(0.42));
  CHECK(state->longest_at == doctest::Approx(0.78));
  CHECK(state->gaps == 1);
  const auto smoothed = std::ranges::find(summary.channels, "SMOOTHED", &exports::ChannelSummary::channel);
  CHECK(smoothed->rate == doctest::Approx(10.0));
  CHECK(smoothed->gaps == 0);
  REQUIRE(summary.processes.size() == 1);
  CHECK(summary.processes[0].config == "# file a.yaml\nfilter: ekf\n");
  const std::string words = exports::words_of(log.path, summary);
  CHECK(words.find("2024-05-27T12:00:00.000Z") != std::string::npos);
  CHECK(words.find("0.42 s at 0.8 s; 1 gaps") != std::string::npos);
  CHECK(words.find("estimator        version 1.2, 2 lines") != std::string::npos);
  CHECK(words.find("SIGNAL") == std::string::npos);
}

TEST_CASE("info: columns that a log carries, by their names") {
  const test::Scratch scratch;
  Recording run;
  for (int k = 0; k < 50; ++k) {
    run.signals.push_back({100'000 * k, "ws", "wind_speed_true", "m/s", 2.0 + 0.1 * k});
    run.signals.push_back({100'000 * k, "salinity", "", "psu", 35.0});
  }
  const std::string path = scratch.path("run.lcmlog");
  CHECK(wire::write_log(run, path) == 100);
  const exports::LogSummary summary = exports::summary_of(path);
  REQUIRE(summary.signals.size() == 2);
  const std::string words = exports::words_of(path, summary);
  CHECK(words.find("ws (wind_speed_true): 50 values from 2 to 6.9 m/s\n") != std::string::npos);
  CHECK(words.find("salinity: 50 values from 35 to 35 psu\n") != std::string::npos);
}

}  // namespace fathom
