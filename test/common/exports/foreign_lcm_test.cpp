// LCM logs of other projects by their .lcm files.
#include "common/exports/foreign_lcm.hpp"

#include <doctest/doctest.h>

#include "common/base/error.hpp"
#include "common/exports/any_message.hpp"
#include "common/recordings/import.hpp"
#include "common/wire/log_writer.hpp"
#include "test/support/scratch.hpp"

namespace fathom {
namespace {

constexpr Utime kStart = 1'716'811'200'000'000;

/// A log of Fathom's own velocity log and thrusters, as if its types were somebody else's.
struct Foreign {
  test::Scratch scratch;
  std::string log = scratch.path("run.lcmlog");
  std::vector<std::string> types{FATHOM_SOURCE_DIR "/lcmtypes/dvl_t.lcm",
                                 FATHOM_SOURCE_DIR "/lcmtypes/thrusters_t.lcm"};
  Foreign() {
    Recording run;
    for (int k = 0; k < 50; ++k) {
      const Utime utime = kStart + 100'000 * k;
      run.dvl.push_back({.utime = utime, .v_WB_B = {0.1 * k, 0.2, 0.3}, .altitude = 4.0, .valid = k != 7});
      run.thrusters.push_back({.utime = utime, .pwm_us = {1500.0 + k, 1400.0}});
      run.depth.push_back({.utime = utime, .z = 1.0});
    }
    (void)wire::write_log(run, log);
  }
};

}  // namespace

TEST_CASE(
    "foreign LCM: channels are topics, numbers have their fields' names, types that no file defines are counted") {
  const Foreign foreign;
  const exports::ForeignLcm reader{foreign.types};
  const recordings::Files files = reader.files(std::span{&foreign.log, 1});
  const auto content = recordings::read_files(files, {}, recordings::Collector::Take::kEverything);
  REQUIRE(content.topics->topics().size() == 2);
  const recordings::TopicAccount& thrusters = content.topics->topics()[0];
  CHECK(thrusters.topic.name == "THRUSTERS");
  CHECK(thrusters.topic.type == "fathom_lcm.thrusters_t");
  CHECK(thrusters.messages == 50);
  REQUIRE(content.damage.sentences().size() == 1);
  CHECK(content.damage.sentences().front().find("50 messages on channel 'DEPTH' of a type that no file defines") == 0);

  const auto streams = tables::parse_streams(
      "source: s\nlicence: l\ndvl: {velocity: {columns: ['DVL.v_WB_B[0]', 'DVL.v_WB_B[1]', 'DVL.v_WB_B[2]'], unit: "
      "m/s, "
      "frame: FRD}, valid_where: [DVL.valid]}\nthrusters: {pwm: {columns: ['THRUSTERS.pwm_us[0]', "
      "'THRUSTERS.pwm_us[1]'], unit: us}}\n",
      "map.yaml");
  const auto imported = recordings::import_files(files, streams, {}, true);
  REQUIRE(imported.runs.size() == 1);
  const Recording& run = imported.runs[0].recording;
  REQUIRE(run.dvl.size() == 50);
  CHECK(run.dvl[7].utime == kStart + 700'000);
  CHECK_FALSE(run.dvl[7].valid);
  CHECK(run.dvl[8].v_WB_B.x() == doctest::Approx(0.8));
  CHECK(run.thrusters[49].pwm_us[0] == 1549.0);
}

TEST_CASE(
    "foreign LCM: several structs in a file, constants, comments, types of other packages; what is wrong is said") {
  const std::string text =
      "/* Of another\n * project. */\npackage nav;\nstruct header_t\n{\n  int64_t utime; // microseconds\n  string "
      "frame_id;\n}\n"
      "// A log's\n// fix.\nstruct fix_t {\n  nav.header_t header;\n  const int8_t NONE = 0, LOCK = 1;\n  int16_t n;\n"
      "  float range[n][3], quality[ 2 ]; // m\n}\n";
  const auto types = exports::types_in(text, "nav.lcm");
  REQUIRE(types.size() == 2);
  CHECK(types[0].comment == "Of another project.");
  CHECK(types[0].fields[0].comment == "microseconds");
  CHECK(types[1].comment == "A log's fix.");
  REQUIRE(types[1].fields.size() == 4);
  CHECK_FALSE(types[1].fields[0].primitive());
  CHECK(types[1].fields[2].sizes == std::vector<std::string>{"n", "3"});
  CHECK(types[1].fields[3].sizes == std::vector<std::string>{"2"});
  const std::vector<std::string_view> texts{text};
  CHECK(exports::Definitions{texts}.all().size() == 2);
  const auto complaint = [](std::string_view wrong) {
    return test::complaint_of<InputError>([&] {
      const std::vector<std::string> path{"a.lcm"};
      const std::vector<std::string_view> all{wrong};
      static_cast<void>(exports::Definitions{all, path});
    });
  };
  CHECK(complaint("package a;\nstruct b_t {\n  int32_t x\n}\n") == "a.lcm:4: ';' is missing before '}'");
  CHECK(complaint("package a;\nstruct b_t { c_t x; }\n") == "message type a.c_t: is not defined");
  CHECK(complaint("package a; enum e_t { A = 1 }") == "a.lcm:1: 'enum' is not read; 'package' and 'struct' are");
  CHECK(complaint("package a; struct b_t { double n; float x[n]; }") ==
        "a.lcm:1: 'n' is no length: a number, or an earlier field that holds a whole one");
  CHECK(complaint("package a; struct b_t { float x[99999999999]; }").find("is no length") != std::string::npos);
  CHECK(complaint("struct") == "a.lcm:1: the struct's name is missing before ''");
}

TEST_CASE("foreign LCM: types that would never end, and lists of nothing, end") {
  const auto decodes = [](const std::string& text, std::vector<std::uint8_t> body) {
    const std::vector<std::string_view> texts{text};
    const exports::Definitions definitions{texts};
    const exports::Type& type = definitions.type("a", "b_t");
    std::vector<std::uint8_t> bytes(8, 0);
    bytes.insert(bytes.end(), body.begin(), body.end());
    return exports::decoded(definitions, type, bytes).has_value();
  };
  CHECK_FALSE(decodes("package a; struct b_t { a.b_t again; }", {1, 2, 3}));
  CHECK(decodes("package a; struct e_t { } struct b_t { int8_t n; e_t x[n]; byte rest[3]; }", {3, 0, 0, 0}));
  std::vector<std::uint8_t> many(1'000'000, 1);
  many[0] = 0, many[1] = 15;  // n = 983297
  CHECK_FALSE(decodes("package a; struct e_t { } struct b_t { int32_t n; e_t x[n][n]; }", many));
}

}  // namespace fathom
