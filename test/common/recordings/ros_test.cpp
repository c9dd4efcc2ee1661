// Messages of ROS in MCAP, bags of ROS 1 and of SQLite.
#include <doctest/doctest.h>
#include <sqlite3.h>

#include <cmath>
#include <filesystem>

#include "common/base/error.hpp"
#include "common/recordings/import.hpp"
#include "common/recordings/ros/definition.hpp"
#include "common/recordings/unpack.hpp"
#include "test/support/foreign_logs.hpp"
#include "test/support/heard.hpp"

namespace fathom {
namespace {

using test::packed;

const std::string kRule = "\n" + std::string(80, '=') + "\nMSG: ";
const std::string kReading =
    "# what a sensor says\nstd_msgs/Header header\nuint8 OFF=0\nstring NAME=\"a#b\"\nbool on true\nfloat64 value  # m\n"
    "Pair[] pairs\nint16[3] three\nuint8[<=4] few\nstring<=10 word" +
    kRule + "test_msgs/Pair\nint8 a\nfloat64 b" + kRule +
    "std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id";

const std::string kIdl =
    "module test_msgs { module msg { typedef int16 int16__3[3];\n  struct Pair { int8 a; double b; };\n"
    "  @verbatim (language=\"comment\", text=\"a ) b\")\n  struct Reading {\n    std_msgs::msg::Header header;\n"
    "    boolean on;\n    @unit(value=\"m\") double value;\n    sequence<test_msgs::msg::Pair> pairs;\n"
    "    int16__3 three;\n    sequence<uint8, 4> few;\n    string<10> word;\n  };\n};};\n";

std::string reading(double seconds, double value) {
  test::CdrMessage cdr;
  cdr.header(seconds, "x").add(std::uint8_t{1}).add(value);
  cdr.add(std::uint32_t{2}).add(std::int8_t{-1}).add(2.0).add(std::int8_t{-3}).add(4.0);
  cdr.add(std::int16_t{7}).add(std::int16_t{8}).add(std::int16_t{9});
  cdr.add(std::uint32_t{1}).add(std::uint8_t{200}).text("hello");
  return cdr.bytes;
}

void check_reading(const test::HeardTopic& topic) {
  CHECK(topic.column("on")[0] == 1.0);
  CHECK(topic.column("value")[0] == 0.25);
  CHECK(topic.column("pairs[1].a")[0] == -3.0);
  CHECK(topic.column("pairs[1].b")[0] == 4.0);
  CHECK(topic.column("pairs.length")[0] == 2.0);
  CHECK(topic.column("three[2]")[0] == 9.0);
  CHECK(topic.column("few[0]")[0] == 200.0);
  CHECK(topic.words == "hello");
}

test::McapLog mcap_of(const std::string& language, const std::string& definition) {
  test::McapLog log;
  log.schema(1, "test_msgs/msg/Reading", language, definition);
  log.channel(1, 1, "/reading");
  return log;
}

}  // namespace

TEST_CASE("mcap: both languages of definitions give the same numbers, with both times") {
  for (const auto& [language, definition] : {std::pair{"ros2msg", kReading}, std::pair{"ros2idl", kIdl}}) {
    CAPTURE(language);
    test::McapLog log = mcap_of(language, definition);
    log.message(1, 1000.5, reading(1000.25, 0.25));
    log.chunk();
    log.message(1, 1001.5, reading(1001.25, 0.5));
    log.plain();
    log.end();
    const auto file = test::hear(log.bytes);
    CHECK(file.format == "mcap");
    CHECK(file.damage.none());
    const auto& topic = file.heard.of("/reading");
    REQUIRE(topic.stamps.size() == 2);
    CHECK(topic.stamps[0].log == 1'000'500'000);
    CHECK(topic.stamps[0].measured == 1'000'250'000);
    check_reading(topic);
  }
}

TEST_CASE("mcap: a wrong checksum costs its chunk alone, the end of the file what it cuts, zeros are said to be none") {
  test::McapLog log = mcap_of("ros2msg", kReading);
  log.message(1, 1.0, reading(1.0, 1.0));
  const std::string body = log.waiting;
  log.chunk(recordings::crc32({reinterpret_cast<const std::uint8_t*>(body.data()), body.size()}));
  log.message(1, 2.0, reading(2.0, 2.0));
  log.chunk(12345);
  log.message(1, 3.0, reading(3.0, 3.0));
  log.message(1, 4.0, reading(4.0, 4.0));
  log.chunk();
  const auto cut = test::hear(log.bytes.substr(0, log.bytes.size() - 20));
  CHECK(cut.heard.of("/reading").column("value") == std::vector<double>{1.0, 3.0});
  CHECK(cut.damage.places("chunks whose checksum is wrong") == 1);
  CHECK(cut.damage.places("records cut off by the end of the file") == 1);
  const auto tail = test::hear(log.bytes + std::string(300, '\0'));
  CHECK(tail.heard.of("/reading").stamps.size() == 3);
  CHECK(tail.damage.places("stretches of bytes that are no record") == 1);
}

TEST_CASE("mcap: a chunk whose length is damaged costs nothing behind it") {
  test::McapLog log = mcap_of("ros2msg", kReading);
  log.message(1, 1.0, reading(1.0, 1.0));
  log.chunk();
  const std::size_t second = log.bytes.size();
  log.message(1, 2.0, reading(2.0, 2.0));
  log.chunk();
  log.message(1, 3.0, reading(3.0, 3.0));
  log.chunk();
  log.bytes[second + 4] = '\x7F';  // of the length
  const auto file = test::hear(log.bytes);
  CHECK(file.heard.of("/reading").column("value") == std::vector<double>{1.0, 3.0});
  CHECK(file.damage.places("stretches of bytes that are no record") == 1);
}

TEST_CASE("mcap: what is not ROS is named and counted; a message that does not fit its definition gives no number") {
  test::McapLog log = mcap_of("ros2msg", kReading);
  log.channel(2, 0, "/other", "protobuf");
  log.message(2, 1.0, "bytes");
  log.message(1, 1.0, reading(1.0, 1.0).substr(0, 40));
  log.message(1, 2.0, reading(2.0, 2.0) + std::string(12, '\0'));
  log.message(1, 3.0, reading(3.0, 3.0));
  log.plain();
  const auto file = test::hear(log.bytes);
  CHECK(file.heard.of("/reading").column("value") == std::vector<double>{3.0});
  CHECK(file.damage.places("messages of /reading that do not fit their definition") == 2);
  CHECK(file.heard.of("/other").stamps.size() == 1);
  CHECK(file.damage.sentences().front().find("'protobuf'") != std::string::npos);
}

TEST_CASE("ros: a writer that counts alignment from the first byte is understood") {
  test::McapLog log;
  log.schema(1, "test_msgs/msg/Two", "ros2msg", "float32 a\nfloat64 b");
  log.channel(1, 1, "/two");
  log.message(1, 1.0, packed(std::uint32_t{0x0100}, 1.5F) + packed(2.5));  // 4 + 4: no gap before b
  log.message(1, 2.0, packed(std::uint32_t{0x0100}, 1.0F) + packed(4.5));
  log.plain();
  const auto file = test::hear(log.bytes);
  CHECK(file.heard.of("/two").column("b") == std::vector<double>{2.5, 4.5});
}

TEST_CASE("ros: lists of lists are refused, lists of several dimensions are read through, and no definition grows") {
  using recordings::ros::Definitions;
  std::string reason;
  const auto grid = Definitions::parse("a/A", "module a { struct A { double x[2][3]; }; };", true, reason);
  REQUIRE(grid != nullptr);
  CHECK(grid->root().members.at(0).count == 6);
  for (const char* members : {"sequence<sequence<double>> x;", "sequence<nine> x;", "nine x[2];", "double x[SIZE];"}) {
    CAPTURE(members);
    const std::string text = std::string{"module a { typedef double nine[9]; struct A { "} + members + " }; };";
    CHECK(Definitions::parse("a/A", text, true, reason) == nullptr);
  }
  std::string bomb;  // each type holds the next twice
  for (int i = 0; i < 25; ++i)
    bomb += "T" + std::to_string(i) + " a\nT" + std::to_string(i) + " b" + kRule + "a/T" + std::to_string(i) + "\n";
  CHECK(Definitions::parse("a/A", bomb, false, reason) == nullptr);
  CHECK(reason.find("too many members") != std::string::npos);
}

TEST_CASE("ros: a type that is missing or holds itself is said, not followed") {
  std::string reason;
  CHECK(recordings::ros::Definitions::parse("a/B", "C c", false, reason) == nullptr);
  CHECK(reason == "type a/C is not defined");
  CHECK(recordings::ros::Definitions::parse("a/B", "B b", false, reason) == nullptr);
  CHECK(reason.find("holds itself") != std::string::npos);
  CHECK(recordings::ros::usual_definition("nav_msgs/msg/Odometry").find("MSG: geometry_msgs/Quaternion") !=
        std::string::npos);
}

TEST_CASE("rosbag 1: messages of several chunks, the end cut off, a type by its own definition") {
  const std::string definition = "Header header\ntime[] when\nbool on\nfloat64 value\n" + std::string(80, '=') +
                                 "\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n";
  const auto body = [](double value) {
    return packed(std::uint32_t{1}, std::uint32_t{47}, std::uint32_t{500'000'000}, std::uint32_t{2}) + "ab" +
           packed(std::uint32_t{1}, std::uint32_t{9}, std::uint32_t{8}, std::uint8_t{1}, value);
  };
  test::BagLog log;
  log.connection(3, "/reading", "test_msgs/Reading", definition);
  log.message(3, 48, 0, body(1.0));
  log.chunk();
  log.message(3, 47, 600'000'000, body(2.0));
  log.message(3, 49, 0, body(3.0));
  log.chunk();
  const auto file = test::hear(log.bytes);
  CHECK(file.format == "rosbag1");
  CHECK(file.damage.none());
  const auto& topic = file.heard.of("/reading");
  CHECK(topic.column("value") == std::vector<double>{1.0, 2.0, 3.0});
  CHECK(topic.stamps[1].log == 47'600'000);
  CHECK(topic.stamps[1].measured == 47'500'000);
  CHECK(topic.column("when[0].nsec")[0] == 8.0);
  const auto cut = test::hear(log.bytes.substr(0, log.bytes.size() - 5));
  CHECK(cut.heard.of("/reading").column("value") == std::vector<double>{1.0, 2.0});
  CHECK(cut.damage.places("records cut off by the end of the file") == 1);
  test::BagLog strange;  // cut off, and packed by what is not known: no byte that is not there is counted as lost
  test::BagLog::record(strange.bytes, {{"op", "\x05"}, {"compression", "zip"}}, std::string(4000, 'x'));
  const auto short_of = test::hear(strange.bytes.substr(0, 100));
  CHECK(short_of.damage.places("chunks packed by 'zip', which is not known here") == 1);
  CHECK(short_of.damage.bytes() <= 100);
  CHECK(test::complaint_of<InputError>([] { (void)test::hear("#ROSBAG V1.2\n"); }).find("another version") !=
        std::string::npos);
}

TEST_CASE("rosbag 2: usual types without definitions, nothing left beside the file, parts joined, damage said") {
  const test::Scratch scratch;
  const auto make = [&](const std::string& path, double first) {
    sqlite3* database = nullptr;
    REQUIRE(sqlite3_open(path.c_str(), &database) == SQLITE_OK);
    const char* tables =
        "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT);"
        "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB);"
        "INSERT INTO topics VALUES(4, '/pressure', 'sensor_msgs/FluidPressure', 'cdr');"
        "INSERT INTO topics VALUES(5, '/own', 'my_msgs/msg/Own', 'cdr'); BEGIN;";
    REQUIRE(sqlite3_exec(database, tables, nullptr, nullptr, nullptr) == SQLITE_OK);
    for (int i = 0; i < 300; ++i) {
      test::CdrMessage cdr;
      cdr.header(first + i, "p").add(101325.0 + i).add(0.0);
      sqlite3_stmt* row = nullptr;
      sqlite3_prepare_v2(database, "INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)", -1, &row,
                         nullptr);
      sqlite3_bind_int(row, 1, i % 100 == 99 ? 5 : 4);
      sqlite3_bind_int64(row, 2, static_cast<std::int64_t>(first + i) * 1'000'000'000 + 5'000'000);
      sqlite3_bind_blob(row, 3, cdr.bytes.data(), static_cast<int>(cdr.bytes.size()), SQLITE_TRANSIENT);
      REQUIRE(sqlite3_step(row) == SQLITE_DONE);
      sqlite3_finalize(row);
    }
    REQUIRE(sqlite3_exec(database, "COMMIT;", nullptr, nullptr, nullptr) == SQLITE_OK);  // a disk waits once
    sqlite3_close(database);
  };
  make(scratch.path("run_0.db3"), 1000.0);
  make(scratch.path("run_1.db3"), 1300.0);
  const auto file = test::hear_file(scratch.path("run_0.db3"));
  CHECK(file.format == "rosbag2");
  CHECK(file.heard.of("/pressure").column("fluid_pressure")[2] == 101327.0);
  CHECK(file.heard.of("/pressure").stamps[2].measured == 1'002'000'000);
  CHECK(file.heard.of("/own").stamps.size() == 3);
  CHECK(file.damage.sentences().front().find("my_msgs/msg/Own is not defined") != std::string::npos);
  int beside = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator{std::filesystem::path(scratch.path("x")).parent_path()}) {
    (void)entry;
    ++beside;
  }
  CHECK(beside == 2);

  const recordings::Format* format = recordings::format_of(scratch.path("run_0.db3"));
  const recordings::Content content =
      recordings::read_files({{scratch.path("run_0.db3"), scratch.path("run_1.db3")}, format},
                             {"/pressure.fluid_pressure"}, recordings::Collector::Take::kColumns);
  CHECK(content.topics->topics().size() == 2);
  CHECK(content.topics->rows()[0].stamps.size() == 594);

  const std::string bytes = test::read_bytes(scratch.path("run_0.db3"));
  test::write_bytes(scratch.path("cut.db3"), bytes.substr(0, bytes.size() / 2));
  const std::string complaint = test::complaint_of<InputError>([&] { (void)test::hear_file(scratch.path("cut.db3")); });
  CHECK(complaint.find("cut.db3") != std::string::npos);
  test::write_bytes(scratch.path("other.db3"), std::string("SQLite format 3\0 and nothing else", 33));
  CHECK_FALSE(test::complaint_of<InputError>([&] { (void)test::hear_file(scratch.path("other.db3")); }).empty());
}

}  // namespace fathom
