#include "common/tables/import.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "common/base/error.hpp"
#include "common/base/spatial.hpp"

using Eigen::Vector3d;
using namespace fathom;
using namespace fathom::tables;

namespace {

constexpr double kRounding = 1e-12;  // products of a few rotations
constexpr double kPi = std::numbers::pi;
const std::string kAbout = "source: nobody\nlicence: none\ntime: {column: t, unit: s}\n";

Imported import_text(const std::string& csv, const std::string& map) {
  return import_table(parse_csv(csv, "run.csv"), ColumnMap::parse(map, "map.yaml"));
}

std::string complaint(const std::string& csv, const std::string& map) {
  try {
    static_cast<void>(import_text(csv, map));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no complaint";
}

bool noted(const Imported& imported, const std::string& note) {
  return std::find(imported.notes.begin(), imported.notes.end(), note) != imported.notes.end();
}

}  // namespace

TEST_CASE("import: forward-left-up body vectors and wrenches turn over in y and z") {
  const Imported imported = import_text(
      "t,u,v,w,p,q,r,ax,ay,az,X,Y,Z,K,M,N\n5,1,2,3,10,20,30,0.1,0.2,9.81,1,2,3,4,5,6\n",
      kAbout +
          "dvl:\n  velocity: {columns: [u, v, w], unit: cm/s, frame: FLU}\n"
          "ahrs:\n  rates: {columns: [p, q, r], unit: deg/s, frame: FLU}\n"
          "  specific_force: {columns: [ax, ay, az], unit: m/s^2, frame: FLU}\n"
          "thrusters:\n  wrench: {columns: [X, Y, Z, K, M, N], force_unit: kN, moment_unit: N m, frame: FLU}\n");
  REQUIRE(imported.recording.dvl.size() == 1);
  CHECK(imported.recording.dvl[0].utime == 5'000'000);
  CHECK(imported.recording.dvl[0].v_WB_B.isApprox(Vector3d(0.01, -0.02, -0.03), kRounding));
  CHECK(imported.recording.ahrs[0].w_WB_B.isApprox(Vector3d(10, -20, -30) * kPi / 180.0, kRounding));
  // At rest an upward accelerometer reads +g; downward it reads -g.
  CHECK(imported.recording.ahrs[0].f_B.isApprox(Vector3d(0.1, -0.2, -9.81), kRounding));
  CHECK_FALSE(imported.recording.ahrs[0].has_attitude);
  const auto& tau = imported.recording.thrusters[0].tau;
  CHECK(tau == std::array<double, 6>{1000, -2000, -3000, 4, -5, -6});
}

TEST_CASE("import: a time that the map calls seconds, and that is not, is told with the line of the map") {
  const std::string csv = "stamp,u,v,w\n0,1,2,3\n20,1,2,4\n40,1,2,5\n";
  const std::string rest = "}\ndvl:\n  velocity: {columns: [u, v, w], unit: m/s, frame: FRD}\n";
  const std::string about = "source: nobody\nlicence: none\n";
  CHECK(complaint(csv, about + "time: {column: stamp, unit: s" + rest)
            .rfind("map.yaml:3: run.csv: column 'stamp': the median step between rows is 20.000 s", 0) == 0);
  CHECK(complaint(csv, about + "time: {column: stamp, unit: ms" + rest) == "no complaint");
  CHECK(complaint(csv, about + "time: {column: stamp, unit: min" + rest).find("is its unit right?") !=
        std::string::npos);
}

TEST_CASE("import: a pose in z-up worlds becomes NED, by hand") {
  // NWU, nose turned 90 degrees to the left (counter-clockwise from above): in NED that is yaw -90, pointing west.
  const Imported nwu =
      import_text("t,x,y,z,qw,qx,qy,qz\n0,1,2,3,0.7071067811865476,0,0,0.7071067811865476\n",
                  kAbout +
                      "pose_capture:\n  position: {columns: [x, y, z], unit: m, frame: NWU}\n"
                      "  quaternion: {columns: [qw, qx, qy, qz], order: wxyz, world: NWU, body: FLU}\n");
  const PoseCapture& west = nwu.recording.pose_capture.at(0);
  CHECK(west.p_WB.isApprox(Vector3d(1, -2, -3), kRounding));
  CHECK(euler_from_rotation(west.q_WB.toRotationMatrix()).isApprox(Vector3d(0, 0, -kPi / 2), kRounding));

  // ENU, nose along x (east), in NED yaw +90; nose up 10 degrees in FLU is a negative rotation about y (left).
  const Imported enu = import_text("t,x,y,z,roll,pitch,yaw\n0,1,2,3,20,-10,0\n",
                                   kAbout +
                                       "pose_capture:\n  position: {columns: [x, y, z], unit: mm, frame: ENU}\n"
                                       "  euler: {columns: [roll, pitch, yaw], unit: deg, world: ENU, body: FLU}\n");
  const PoseCapture& east = enu.recording.pose_capture.at(0);
  CHECK(east.p_WB.isApprox(Vector3d(0.002, 0.001, -0.003), kRounding));
  CHECK(euler_from_rotation(east.q_WB.toRotationMatrix()).isApprox(Vector3d(20, 10, 90) * kPi / 180.0, kRounding));
}

TEST_CASE("import: quaternion order is obeyed and one that is not of unit length is invalid") {
  const Imported imported = import_text(
      "t,a,b,c,d\n0,0,0,1,0\n1,0,0,0.5,0\n2,0,0,0,0\n",
      kAbout + "pose_capture:\n  quaternion: {columns: [a, b, c, d], order: xyzw, world: NED, body: FRD}\n");
  const auto& poses = imported.recording.pose_capture;
  REQUIRE(poses.size() == 3);
  CHECK(poses[0].q_WB.isApprox(Eigen::Quaterniond(0, 0, 0, 1), kRounding));
  CHECK(poses[0].valid);
  CHECK_FALSE(poses[0].has_position);
  CHECK_FALSE(poses[1].valid);
  CHECK_FALSE(poses[2].valid);
  CHECK(poses[2].q_WB.coeffs().allFinite());
  CHECK(noted(imported, "pose_capture: 2 samples invalid because their quaternion is not of unit length"));
}

TEST_CASE("import: NaN refuses only its own stream's sample, flags mark, held values are found") {
  const Imported imported = import_text(
      "t,u,v,w,volts,bad,extra\n0,1,1,1,12,0,0\n1,1,1,1,,0,0\n2,nan,1,1,11,0,0\n3,2,1,1,10,1,0\n",
      kAbout +
          "dvl:\n  velocity: {columns: [u, v, w], unit: m/s, frame: FRD}\n  held: detect\n  invalid_where: [bad]\n"
          "battery: {column: volts, unit: V}\n");
  const auto& dvl = imported.recording.dvl;
  REQUIRE(dvl.size() == 3);
  CHECK_FALSE(dvl[0].held);
  CHECK(dvl[1].held);
  CHECK(dvl[1].valid);
  CHECK_FALSE(dvl[2].held);
  CHECK_FALSE(dvl[2].valid);
  CHECK(imported.recording.battery.size() == 3);
  CHECK(noted(imported, "dvl: 1 samples refused (empty or NaN)"));
  CHECK(noted(imported, "dvl: 1 samples repeat the one before (held)"));
  CHECK(noted(imported, "dvl: 1 samples marked or left out as invalid by their flags"));
  CHECK(noted(imported, "battery: 1 samples refused (empty or NaN)"));
  CHECK(noted(imported, "columns not used: extra"));
}

TEST_CASE("import: rows whose time does not rise are dropped and counted, a gap is kept and named") {
  const std::string map = kAbout + "depth: {column: z, unit: m, direction: up}\n";
  const Imported imported = import_text("t,z\n0,-1\n1,-2\n1,-3\n0.5,-4\n,5\n2,-6\n3,-6\n20,-7\n", map);
  REQUIRE(imported.recording.depth.size() == 5);
  CHECK(imported.recording.depth[1].z == 2.0);
  CHECK(imported.recording.depth[4].utime == 20'000'000);
  CHECK(noted(imported, "time: 2 rows dropped because time did not rise, first at run.csv:4"));
  CHECK(noted(imported, "time: 1 rows dropped (empty or NaN)"));
  CHECK(noted(imported, "time: the longest gap is 17.000 s, after 3.000 s"));
  CHECK(complaint("t,z\n5,1\n4,1\n3,1\n2,1\n", map) ==
        "run.csv:3: time does not rise here nor in 2 more of 4 rows; is it the time column, and is its unit right? "
        "Seconds and nanoseconds in two columns: time: {columns: [SECONDS, NANOSECONDS], units: [s, ns]} in the map");
  CHECK(complaint("t,z\n1e18,1\n", map).rfind("run.csv:2: time ", 0) == 0);
}

TEST_CASE("import: a map that does not fit is refused with its own line") {
  const std::string csv = "t,u,v,w\n0,1,2,3\n";
  const auto dvl = [](const std::string& line) { return kAbout + "dvl:\n  velocity: " + line + "\n"; };
  CHECK(complaint(csv, dvl("{columns: [u, v, speed], unit: m/s, frame: FLU}")) ==
        "map.yaml:5: column 'speed' is not in run.csv, which has: t, u, v, w");
  CHECK(complaint(csv, dvl("{columns: [u, v, w], unit: m, frame: FLU}")) ==
        "map.yaml:5: unit 'm' does not fit: expected 'm/s'");
  CHECK(complaint(csv, dvl("{columns: [u, v, w], unit: knots, frame: FLU}")) ==
        "map.yaml:5: unit 'knots': 'knots' is not a known unit");
  CHECK(complaint(csv, dvl("{columns: [u, v, w], frame: FLU}")) ==
        "map.yaml:5: key 'unit' is missing in 'dvl.velocity'");
  CHECK(complaint(csv, dvl("{columns: [u, v], unit: m/s, frame: FLU}")) ==
        "map.yaml:5: 'columns' needs 3 columns, not 2");
  CHECK(complaint(csv, dvl("{columns: [u, v, w], unit: m/s, frame: NUE}")) ==
        "map.yaml:5: 'NUE' is no frame of a vehicle's motion: FRD (forward, right, down) or FLU (forward, left, up) "
        "along the body, NED, ENU or NWU along the world");
  CHECK(complaint(csv, dvl("{columns: [u, v, w], unit: m/s, fram: FLU}")) ==
        "map.yaml:5: unknown key 'fram' in 'dvl.velocity'; did you mean 'frame'?");
  CHECK(complaint(csv, kAbout + "dvll: 3\n") == "map.yaml:4: unknown key 'dvll'; did you mean 'dvl'?");
  CHECK(complaint(csv, "source: a\ntime: {column: t, unit: s}\n") == "map.yaml:1: key 'licence' is missing");
  CHECK(complaint("t,u,v,w\n0,1,,3\n1,1,nan,3\n", dvl("{columns: [u, v, w], unit: m/s, frame: FLU}")) ==
        "run.csv: column 'v' holds no number at all; leave out of the table what was not measured");
  CHECK(complaint("t,u,v,w\n0,1,,3\n1,,2,3\n", dvl("{columns: [u, v, w], unit: m/s, frame: FLU}")) ==
        "run.csv: not one whole sample of dvl");
  CHECK(complaint(csv, kAbout + "thrusters: {invalid_where: [u]}\n") ==
        "map.yaml:4: 'thrusters' needs pwm, command, force, speed or wrench");
}

TEST_CASE("beluga: every run is imported with the counts that its flag columns state") {
  const std::string root = FATHOM_SOURCE_DIR;
  struct Facts {
    const char* run;
    std::size_t rows;
    std::size_t held;
    std::size_t invalid;
  };
  // Counted with awk over the files.
  for (const Facts& facts :
       {Facts{"heave-1", 2629, 566, 1}, Facts{"random-1", 6664, 1334, 48}, Facts{"random-2", 5980, 1170, 96},
        Facts{"surge-1", 7961, 1577, 205}, Facts{"sway-1", 7988, 1602, 210}, Facts{"yaw-1", 6597, 1299, 12}}) {
    CAPTURE(facts.run);
    const Imported imported =
        import_csv(root + "/test/data/beluga/" + facts.run + ".csv", root + "/config/maps/beluga.yaml");
    const Recording& run = imported.recording;
    CHECK(run.name == facts.run);
    CHECK(run.pose_capture.size() == facts.rows);
    CHECK(run.ahrs.size() == facts.rows);
    CHECK(run.dvl.size() == facts.rows);
    CHECK(run.thrusters.size() == facts.rows);
    CHECK(run.battery.size() == facts.rows);
    CHECK(run.depth.empty());
    const auto held = std::count_if(run.dvl.begin(), run.dvl.end(), [](const Dvl& one) { return one.held; });
    CHECK(static_cast<std::size_t>(held) == facts.held);
    const auto invalid = std::count_if(run.pose_capture.begin(), run.pose_capture.end(),
                                       [](const PoseCapture& one) { return !one.valid; });
    CHECK(static_cast<std::size_t>(invalid) == facts.invalid);
  }
}

TEST_CASE("beluga: the first row of surge-1 arrives in NED and forward-right-down") {
  const std::string root = FATHOM_SOURCE_DIR;
  const Imported imported = import_csv(root + "/test/data/beluga/surge-1.csv", root + "/config/maps/beluga.yaml");
  const Recording& run = imported.recording;
  CHECK(imported.licence == "MIT, Copyright (c) 2021 Vortex NTNU");
  CHECK(run.pose_capture[0].utime == 0);
  CHECK(run.pose_capture[1].utime == 100'000);
  CHECK(run.pose_capture[0].p_WB.isApprox(Vector3d(-1.65704, 0.09614, -0.29673), kRounding));
  // (w, x, y, z) = (0.8178, 0.070642, 0.001202, -0.571149) turned over in y and z on both sides.
  const Eigen::Quaterniond expected = Eigen::Quaterniond(0.817800, 0.070642, -0.001202, 0.571149).normalized();
  CHECK(run.pose_capture[0].q_WB.angularDistance(expected) < 1e-9);
  CHECK(run.ahrs[0].w_WB_B.isApprox(Vector3d(-0.00172, 0.00200, 0.00108), kRounding));
  CHECK(run.dvl[0].v_WB_B.isApprox(Vector3d(0.00153, 0.00140, -0.00926), kRounding));
  CHECK(run.thrusters[0].tau == std::array<double, 6>{-0.0888, -0.6513, -6.4308, 0.0, 0.0, 0.0004});
  CHECK(run.thrusters[0].pwm_us == std::vector<double>{1598, 1525, 1635, 1547, 1562.2, 1525, 1635, 1613});
  CHECK(run.thrusters[0].force.empty());
  CHECK(run.battery[0].voltage == 15.301);
}

TEST_CASE("import: angles in another unit than said are named by what carries the velocities along the track") {
  // A vehicle that swings its heading and drives ahead, its compass off by `turn`.
  const auto table = [](double unit, double swing = 1.5, double turn = 0.0) {
    std::string csv = "t,x,y,z,phi,theta,psi,u,v,w\n";
    double x = 0.0, y = 0.0;
    for (int k = 0; k < 1200; ++k) {
      const double t = 0.05 * k, heading = 0.5 + swing * std::sin(0.2 * t);
      for (const double number : {t, x, y, 1.0, 0.0, 0.0, (heading + turn) * unit, 0.4, 0.0})
        csv += std::to_string(number) + ",";
      csv += "0.0\n";
      x += 0.05 * 0.4 * std::cos(heading);
      y += 0.05 * 0.4 * std::sin(heading);
    }
    return csv;
  };
  const auto complaint_about = [&](const std::string& csv, const std::string& unit) -> std::string {
    const std::string map = kAbout +
                            "pose_capture:\n  position: {columns: [x, y, z], unit: m, frame: NED}\n"
                            "  euler: {columns: [phi, theta, psi], unit: " +
                            unit + ", world: NED, body: FRD}\n" +
                            "dvl:\n  velocity: {columns: [u, v, w], unit: m/s, frame: FRD}\n";
    return complaint(csv, map);
  };
  constexpr double kInDegrees = 180.0 / kPi;
  CHECK(complaint_about(table(1.0), "rad") == "no complaint");
  CHECK(complaint_about(table(kInDegrees), "deg") == "no complaint");
  CHECK(complaint_about(table(kInDegrees), "rad").find("only with headings in deg (100 % of it") != std::string::npos);
  CHECK(complaint_about(table(1.0), "deg").find("only with headings in rad") != std::string::npos);
  // A wrong compass is not a wrong unit, though read as degrees a held heading would lie along the track.
  CHECK(complaint_about(table(1.0, 0.1, 2.0), "rad") == "no complaint");
  CHECK(complaint_about(table(1.0, 1.5, 2.0), "rad") == "no complaint");
}

TEST_CASE(
    "import: a table in slices gives what it gives whole, and never more samples at once than rows are asked for") {
  std::string csv = "t,x,y,z,roll,pitch,yaw,u,v,w,p,q,r,d,f1,f2\n";
  for (int k = 0; k < 200; ++k) {
    const double t = 0.1 * k, held = std::floor(0.5 * k);  // every second velocity repeats the one before
    for (const double number : {t, std::sin(t), t, 2.0, 0.1, 0.0, 0.3 * t, held, 0.0, 0.0, 0.0, 0.0, 0.3, t})
      csv += std::to_string(number) + ",";
    csv += k % 7 == 0 ? ",2\n" : "1,2\n";
  }
  const std::string map = kAbout +
                          "pose_capture:\n  position: {columns: [x, y, z], unit: m, frame: NED}\n"
                          "  euler: {columns: [roll, pitch, yaw], unit: rad, world: NED, body: FRD}\n"
                          "ahrs:\n  rates: {columns: [p, q, r], unit: rad/s, frame: FRD}\n"
                          "dvl:\n  velocity: {columns: [u, v, w], unit: m/s, frame: FRD}\n  held: detect\n"
                          "depth: {column: d, unit: m, direction: down}\n"
                          "thrusters:\n  force: {columns: [f1, f2], unit: N}\n";
  const CsvTable table = parse_csv(csv, "run.csv");
  const Imported whole = import_table(table, ColumnMap::parse(map, "map.yaml"));
  constexpr std::size_t kRows = 9;
  TableImport import{table, ColumnMap::parse(map, "map.yaml"), {}};
  Recording all;
  std::size_t slices = 0;
  for (Recording part; import.next(kRows, part); part = {}) {
    ++slices;
    CHECK(part.pose_capture.size() <= kRows);
    CHECK(part.ahrs.size() <= kRows);
    CHECK(part.dvl.size() <= kRows);
    CHECK(part.thrusters.size() <= kRows);
    all.pose_capture.insert(all.pose_capture.end(), part.pose_capture.begin(), part.pose_capture.end());
    all.dvl.insert(all.dvl.end(), part.dvl.begin(), part.dvl.end());
    all.thrusters.insert(all.thrusters.end(), part.thrusters.begin(), part.thrusters.end());
    all.depth.insert(all.depth.end(), part.depth.begin(), part.depth.end());
  }
  CHECK(slices == 23);
  CHECK(import.finish() == whole.notes);
  CHECK(noted(whole, "dvl: 100 samples repeat the one before (held)"));
  REQUIRE(all.dvl.size() == whole.recording.dvl.size());
  for (std::size_t i = 0; i < all.dvl.size(); ++i) CHECK(all.dvl[i].held == whole.recording.dvl[i].held);
  REQUIRE(all.pose_capture.size() == whole.recording.pose_capture.size());
  CHECK(all.pose_capture.back().p_WB == whole.recording.pose_capture.back().p_WB);
  CHECK(all.thrusters.size() == whole.recording.thrusters.size());
  CHECK(all.depth.back().z == whole.recording.depth.back().z);
}

TEST_CASE("import: what an attitude turns is not cut, since attitudes lie on both sides of it") {
  const CsvTable table = parse_csv("t,psi,vn,ve,vd\n0,0,1,0,0\n0.1,,1,0,0\n0.2,0.4,1,0,0\n0.3,0.4,1,0,0\n", "run.csv");
  const std::string map = kAbout +
                          "ahrs:\n  euler: {columns: [none, none, psi], unit: rad, world: NED, body: FRD}\n"
                          "dvl:\n  velocity: {columns: [vn, ve, vd], unit: m/s, frame: NED}\n";
  TableImport import{table, ColumnMap::parse(map, "map.yaml"), SimulatedAxes{true, true, true, false, false, true}};
  Recording part;
  REQUIRE(import.next(1, part));
  REQUIRE(part.dvl.size() == 4);
  CHECK(part.dvl[1].v_WB_B.isApprox(Vector3d(std::cos(0.2), -std::sin(0.2), 0.0), 1e-12));
  CHECK_FALSE(import.next(1, part));
}
