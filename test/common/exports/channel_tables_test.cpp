// Every channel goes out as a table and comes back from it, byte by byte.
#include "common/exports/channel_tables.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <set>
#include <type_traits>
#include <vector>

#include "common/base/error.hpp"
#include "common/exports/log_export.hpp"
#include "common/exports/separated_text.hpp"
#include "common/wire/log_writer.hpp"
#include "common/wire/streams.hpp"
#include "test/support/filled_samples.hpp"
#include "test/support/scratch.hpp"

namespace fathom {
namespace {

/// Three samples of every stream, a different number in every field.
Recording everything() {
  test::Fill fill;
  Recording recording;
  for (int k = 0; k < 3; ++k) {
    wire::visit_streams(recording, [&](const char*, auto& stream) {
      typename std::remove_reference_t<decltype(stream)>::value_type sample;
      test::fill(fill, sample);
      stream.push_back(sample);
    });
  }
  recording.process_info[1].config = "# file a.yaml\nfilter: \"ekf\", of two\r\n";
  recording.thrusters[1].force.clear();  // lists of other lengths stand in one table
  recording.thrusters[1].pwm_us.push_back(1512.5);
  return recording;
}

std::vector<exports::ChannelTable> tables_in(const std::string& folder) {
  std::vector<exports::ChannelTable> tables;
  for (const auto& entry : std::filesystem::directory_iterator{folder}) {
    if (entry.path().extension() != ".csv") continue;
    const auto table = exports::channel_table(entry.path().string());
    REQUIRE_MESSAGE(table, entry.path());
    CHECK(table->channel == entry.path().stem());
    tables.push_back(*table);
  }
  return tables;
}

struct Exported {
  test::Scratch scratch;
  std::string log = scratch.path("run.lcmlog"), folder = scratch.path("csv"), back = scratch.path("back.lcmlog");
  Exported() {
    (void)wire::write_log(everything(), log);
    (void)exports::to_csv(log, folder, {});
  }
};

}  // namespace

TEST_CASE("channels: what was exported as tables comes back byte by byte, whatever channel it is of") {
  const Exported run;
  const std::vector<exports::ChannelTable> tables = tables_in(run.folder);
  std::set<std::string> channels;
  const Recording none;
  wire::visit_streams(none, [&](const char* channel, const auto&) { channels.insert(channel); });
  CHECK(tables.size() == channels.size());
  const exports::Restored restored = exports::from_csv(tables, run.back);
  CHECK(restored.note.empty());
  for (const std::string& channel : channels) CHECK(restored.written.at(channel) == 3);
  CHECK(test::read_bytes(run.back) == test::read_bytes(run.log));
  CHECK_FALSE(std::filesystem::exists(run.back + ".part"));
}

TEST_CASE("channels: a table alone is stamped with its messages' own times") {
  const Exported run;
  std::filesystem::remove(std::filesystem::path{run.folder} / "columns.txt");
  const std::vector<exports::ChannelTable> dvl{*exports::channel_table(run.folder + "/DVL.csv")};
  (void)exports::from_csv(dvl, run.back);
  Recording only;
  only.dvl = everything().dvl;
  (void)wire::write_log(only, run.log);
  CHECK(test::read_bytes(run.back) == test::read_bytes(run.log));
}

TEST_CASE("channels: tables that a spreadsheet has saved again are read, others are not taken for channels") {
  const test::Scratch scratch;
  const std::string path = scratch.path("d.csv");
  const auto table_of = [&](const std::string& text) {
    test::write_bytes(path, text);
    return exports::channel_table(path);
  };
  const std::string head = "t,utime,v_WB_B[0],v_WB_B[1],v_WB_B[2],altitude,valid,held\r\n";
  const auto table = table_of(head + "0.0,1000000.0,0.1,0.2,0.3,2,True,0\r\n0.1,1100000,0.1,,0.3,2,FALSE,1");
  REQUIRE(table);
  CHECK(table->channel == "DVL");
  CHECK(exports::from_csv(std::span{&*table, 1}, scratch.path("d.lcmlog")).written.at("DVL") == 2);
  CHECK_FALSE(table_of("t,u,v,w\n0,1,2,3\n"));
  CHECK_FALSE(table_of("t,utime,z,more\n0,1,2,3\n"));
  CHECK_FALSE(table_of(""));
  const auto refused = [&](const std::string& row, const std::string& because) {
    const auto bad = table_of(head + row);
    REQUIRE(bad);
    const std::string said = test::complaint_of<InputError>([&] {
      (void)exports::from_csv(std::span{&*bad, 1}, scratch.path("bad.lcmlog"));
    });
    CAPTURE(said);
    CHECK(said.find(because) != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(scratch.path("bad.lcmlog")));
  };
  refused("0,1,2,x,0,0,true,false\n", "d.csv:2: column 'v_WB_B[1]': 'x' is not a number");
  refused("0,1.5,2,3,0,0,true,false\n", "d.csv:2: column 'utime': '1.5' is no whole number");
  refused("0,1,2,3,0,0,perhaps,false\n", "'perhaps' is neither true nor false");
  refused("0,1,2,3\n", "this row has 4 cells, the header names 8");
  refused("0,1,2,3,0,0,\"true,false\n", "a quote that begins here is not closed");
}

TEST_CASE("channels: a list needs the columns that its length says, and pictures do not come back") {
  const test::Scratch scratch;
  const std::string path = scratch.path("l.csv");
  test::write_bytes(path, "t,utime,n_load,load[0]\n0,1,1,5\n1,2,2,5\n");
  const auto loads = exports::channel_table(path);
  REQUIRE(loads);
  const auto back = [&](const exports::ChannelTable& table) {
    return test::complaint_of<InputError>([&] {
      (void)exports::from_csv(std::span{&table, 1}, scratch.path("l.lcmlog"));
    });
  };
  CHECK(back(*loads).find("l.csv:3: column 'load[1]': is not in the table") != std::string::npos);
  test::write_bytes(path, "t,utime,camera,width,height,n_jpeg,jpeg\n0,1,front,640,480,3,3\n");
  const auto camera = exports::channel_table(path);
  REQUIRE(camera);
  CHECK(back(*camera).find("CAMERA (a table counts its bytes") != std::string::npos);
}

}  // namespace fathom
