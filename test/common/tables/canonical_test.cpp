// Canonical CSV in, and back out again.
#include <doctest/doctest.h>

#include <algorithm>
#include <string>

#include "common/base/error.hpp"
#include "common/base/spatial.hpp"
#include "common/tables/import.hpp"
#include "common/tables/writer.hpp"

using Eigen::Vector3d;
using namespace fathom;
using namespace fathom::tables;

namespace {

constexpr double kAttitude = 1e-12;  // rad: Euler angles and back

Imported read(const std::string& csv) {
  const CsvTable table = parse_csv(csv, "run.csv");
  return import_table(table, canonical_map(table));
}

std::string complaint(const std::string& csv) {
  try {
    static_cast<void>(read(csv));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no complaint";
}

}  // namespace

TEST_CASE("canonical: each group of columns goes to its stream") {
  const Recording run = read(
                            "t,x,y,z,phi,theta,psi,u,v,w,p,q,r,ax,ay,az,f1,f2,voltage,depth\n"
                            "1.5,1,2,3,0.1,0.2,0.3,4,5,6,7,8,9,0,0,-9.8,10,-11,12.5,3.1\n")
                            .recording;
  CHECK(run.pose_capture.at(0).utime == 1'500'000);
  CHECK(run.pose_capture[0].p_WB == Vector3d(1, 2, 3));
  CHECK((euler_from_rotation(run.pose_capture[0].q_WB.toRotationMatrix()) - Vector3d(0.1, 0.2, 0.3)).norm() <
        kAttitude);
  CHECK(run.dvl.at(0).v_WB_B == Vector3d(4, 5, 6));
  CHECK(run.ahrs.at(0).w_WB_B == Vector3d(7, 8, 9));
  CHECK(run.ahrs[0].f_B == Vector3d(0, 0, -9.8));
  CHECK(run.ahrs[0].has_specific_force);
  CHECK_FALSE(run.ahrs[0].has_attitude);
  CHECK(run.thrusters.at(0).force == std::vector<double>{10, -11});
  CHECK_FALSE(run.thrusters[0].has_tau);
  CHECK(run.battery.at(0).voltage == 12.5);
  CHECK(run.depth.at(0).z == 3.1);
}

TEST_CASE("canonical: attitude alone is an attitude sensor, position alone a pose without attitude") {
  const Recording attitude = read("t,phi,theta,psi,X,Y,Z,K,M,N\n0,0,0,1,1,2,3,4,5,6\n").recording;
  CHECK(attitude.pose_capture.empty());
  CHECK(attitude.ahrs.at(0).has_attitude);
  CHECK_FALSE(attitude.ahrs[0].has_rates);
  CHECK(attitude.thrusters.at(0).tau == std::array<double, 6>{1, 2, 3, 4, 5, 6});
  const Recording position = read("t,x,y,z\n0,1,2,3\n").recording;
  CHECK(position.ahrs.empty());
  CHECK(position.pose_capture.at(0).has_position);
  CHECK_FALSE(position.pose_capture[0].has_attitude);
}

TEST_CASE("canonical: unknown and incomplete columns are named") {
  CHECK(complaint("time,u,v,w\n0,1,2,3\n") ==
        "run.csv:1: column 't' (time in seconds, or as a date) is missing; describe other columns with a map (--map)");
  // What looks like the time is named, with its unit by how far its rows lie apart.
  CHECK(
      complaint("original_timestamp,u,v,w\n1444243.083,1,2,3\n1444343.083,1,2,3\n")
          .find(
              "'original_timestamp' looks like it: call it 't', or write in a map 'time: {column: original_timestamp, "
              "unit: ms}'") != std::string::npos);
  CHECK(complaint("header.stamp.sec,header.stamp.nanosec,u\n1,5,1\n1,6,2\n")
            .find("time: {columns: [header.stamp.sec, header.stamp.nanosec], units: [s, ns]}") != std::string::npos);
  CHECK(complaint("Timestamp,u,v,w\n2024-05-27 09:40:00.0,1,2,3\n").find("'time: {column: Timestamp, unit: date}'") !=
        std::string::npos);
  CHECK(complaint("t,u,v\n0,1,2\n") == "run.csv:1: columns 'u', 'v' stand without 'w'; they go together");
  CHECK(complaint("t,u,v,w,foo,Phi,Theta\n0,1,2,3,4,5,6\n")
            .rfind("run.csv:1: unknown columns 'Phi' (did you mean 'phi'?), 'Theta' (did you mean 'theta'?); without a "
                   "map",
                   0) == 0);
  CHECK(complaint("t,foo,bar\n0,1,2\n").rfind("run.csv:1: no column besides time is known; without a map", 0) == 0);
  CHECK(complaint("t,u,v,w,f2\n0,1,2,3,4\n").rfind("run.csv:1: column 'f1' is missing, and 'f2' is there;", 0) == 0);
  CHECK(complaint("t,u,v,w,f0,f1\n0,1,2,3,4,5\n") ==
        "run.csv:1: column 'f0': thrusters are counted from 'f1', in the order of the vehicle file");
  CHECK(complaint("t\n0\n") == "run.csv:1: there is no column besides time");
  CHECK(complaint("t,u,v,w\n0,1,2,\n1,1,2,nan\n") ==
        "run.csv: column 'w' holds no number at all; leave out of the table what was not measured");
  CHECK(complaint("t,u,v,w\n0,1,2,fast\n") == "run.csv:2: column 'w': 'fast' is not a number");
}

TEST_CASE("canonical: columns that nobody knows are left alone and noted, words in them too") {
  const Imported imported = read("mode,t,u,v,w,ping\nsurge,0,1,2,3,7\nyaw,1,1,2,4,7\n");
  REQUIRE(imported.recording.dvl.size() == 2);
  CHECK(imported.recording.dvl[1].v_WB_B == Vector3d(1, 2, 4));
  CHECK(std::ranges::count(imported.notes, "columns not used: mode, ping") == 1);
}

TEST_CASE("canonical: a column that differs by capitals or a slip is told its name") {
  CHECK(complaint("t,Phi,theta,psi\n0,1,2,3\n").rfind("run.csv:1: unknown columns 'Phi' (did you mean 'phi'?);", 0) ==
        0);
  CHECK(
      complaint("t,roll,pitch,Yaw\n0,1,2,3\n")
          .rfind("run.csv:1: unknown columns 'roll' (did you mean 'phi'?), 'pitch' (did you mean 'theta'?), 'Yaw' (did "
                 "you mean 'psi'?);",
                 0) == 0);
  CHECK(complaint("t,u,v,w,U,surge\n0,1,2,3,4,5\n") == "no complaint");  // there is a 'u'
  CHECK(complaint("T,u,v,w\n0,1,2,3\n").find("(is it 'T'?)") != std::string::npos);
}

TEST_CASE("canonical: time in milliseconds is told by its step, with the remedy") {
  CHECK(
      complaint("t,u,v,w\n100000,1,2,3\n100020,1,2,4\n100040,1,2,5\n") ==
      "run.csv: column 't': the median step between rows is 20.000 s, too slow for the motion of any vehicle; is it in "
      "ms? Say so in the map (--map): time: {column: t, unit: ms}");
  CHECK(complaint("t,u,v,w\n0,1,2,3\n20000,1,2,4\n40000,1,2,5\n").find("unit: us}") != std::string::npos);
  CHECK(complaint("t,u,v,w\n0,1,2,3\n1,1,2,4\n2,1,2,5\n100,1,2,5\n") == "no complaint");  // slow, and a gap
  // Seconds since 1970 can be nothing else: gliders write their flight every few seconds.
  CHECK(complaint("t,u,v,w\n1700000000,1,2,3\n1700000004,1,2,4\n1700000008,1,2,5\n") == "no complaint");
  CHECK(complaint("t,u,v,w\n1700000000,1,2,3\n1700003600,1,2,4\n1700007200,1,2,5\n").find("too slow for the motion") !=
        std::string::npos);
  CHECK(complaint("t,u,v,w\n2000000000,1,2,3\n2000010000,1,2,4\n2000020000,1,2,5\n").find("unit: us}") !=
        std::string::npos);  // since the autopilot started
}

TEST_CASE("canonical: a recording survives writing and reading, stream by stream, each on its own clock") {
  Recording run;
  run.pose_capture.push_back(
      {.utime = 100'000, .p_WB = {1, 2, 3}, .q_WB = Eigen::Quaterniond(rotation_from_euler({0.1, -0.2, 3}))});
  run.pose_capture.push_back({.utime = 200'000, .p_WB = {9, 9, 9}, .valid = false});
  run.ahrs.push_back({.utime = 100'001, .w_WB_B = {1.0 / 3.0, 1e-17, -2}, .has_rates = true});
  run.dvl.push_back({.utime = 200'000, .v_WB_B = {0.1, 0.2, 0.3}});
  run.dvl.push_back({.utime = 300'000, .v_WB_B = {0.1, 0.2, 0.3}, .held = true});
  run.thrusters.push_back(
      {.utime = 100'000, .pwm_us = {1500, 1501.5}, .force = {}, .tau = {1, 2, 3, 4, 5, 6}, .has_tau = true});
  run.battery.push_back({.utime = -1'250'000, .voltage = 14.8});
  const Recording back = read(to_csv(run)).recording;
  REQUIRE(back.pose_capture.size() == 1);
  CHECK(back.pose_capture[0].utime == 100'000);
  CHECK(back.pose_capture[0].p_WB == run.pose_capture[0].p_WB);
  CHECK(back.pose_capture[0].q_WB.angularDistance(run.pose_capture[0].q_WB) < kAttitude);
  REQUIRE(back.ahrs.size() == 1);
  CHECK(back.ahrs[0].utime == 100'001);
  CHECK(back.ahrs[0].w_WB_B == run.ahrs[0].w_WB_B);
  REQUIRE(back.dvl.size() == 1);
  CHECK(back.dvl[0].v_WB_B == run.dvl[0].v_WB_B);
  REQUIRE(back.thrusters.size() == 1);
  CHECK(back.thrusters[0].pwm_us == run.thrusters[0].pwm_us);
  CHECK(back.thrusters[0].tau == run.thrusters[0].tau);
  REQUIRE(back.battery.size() == 1);
  CHECK(back.battery[0].utime == -1'250'000);
  CHECK(back.battery[0].voltage == 14.8);
}

TEST_CASE("canonical: a trial is written with its gaps as empty cells") {
  Trial trial;
  trial.name = "box";
  trial.dt = 0.5;
  trial.observed = {.position = false, .attitude = false, .velocity = true, .rates = true};
  trial.t = {0.0, 0.5};
  trial.p_WB.assign(2, Vector3d::Zero());
  trial.q_WB.assign(2, Eigen::Quaterniond::Identity());
  trial.nu.assign(2, (Vector6d() << 1, 2, 3, 4, 5, 6).finished());
  trial.pose_valid = {1, 1};
  trial.velocity_valid = {1, 0};
  trial.rates_valid = {1, 1};
  trial.input.assign(2, Eigen::Vector2d(7, -8));
  trial.voltage = {12, 11.5};
  CHECK(to_csv(trial) == "t,u,v,w,p,q,r,f1,f2,voltage\n0.000000,1,2,3,4,5,6,7,-8,12\n0.500000,,,,4,5,6,7,-8,11.5\n");
  CHECK_THROWS_WITH_AS(write_file("/nowhere/run.csv", "t\n"), "/nowhere/run.csv: cannot write this file", InputError);
}

TEST_CASE("canonical columns: a thruster that is left out is named") {
  const CsvTable table = parse_csv("t,x,y,z,f1,f2,f4\n0,0,0,0,1,1,1\n", "run.csv");
  CHECK_THROWS_WITH_AS(
      (canonical_map(table)),
      "run.csv:1: column 'f3' is missing, and 'f4' is there; a thruster that was not driven has a column of zeros",
      InputError);
}
