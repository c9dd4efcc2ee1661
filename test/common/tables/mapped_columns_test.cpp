// Columns that people have: world-frame velocity and rates, latitude and longitude, pressure, course and speed, flags
// of what is valid, streams in rows of their own, units in headers, a depth that is called z.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "common/base/error.hpp"
#include "common/base/spatial.hpp"
#include "common/tables/header_units.hpp"
#include "common/tables/import.hpp"
#include "common/tables/map_writer.hpp"

using Eigen::Vector3d;
using namespace fathom;
using namespace fathom::tables;

namespace {

constexpr double kRounding = 1e-9;
const std::string kAbout = "source: nobody\nlicence: none\ntime: {column: t, unit: s}\n";

Imported import_text(const std::string& csv, const std::string& map, const std::optional<SimulatedAxes>& axes = {}) {
  return import_table(parse_csv(csv, "run.csv"), ColumnMap::parse(kAbout + map, "map.yaml"), axes);
}
bool noted(const Imported& imported, const std::string& part) {
  return std::ranges::any_of(imported.notes, [&](const auto& note) { return note.find(part) != std::string::npos; });
}
const std::string kYawed = "ahrs:\n  euler: {columns: [a, b, c], unit: deg, world: NED, body: FRD}\n";

}  // namespace

TEST_CASE("columns: velocity along the world's axes is turned into the body's by the attitude of its moment") {
  // Heading east: what goes north goes to port. Between rows at 80 and 100 deg it is 90.
  const std::string csv = "t,a,b,c,vn,ve,vd\n0,0,0,80,,,\n0.1,,,,1,2,0.5\n0.2,0,0,100,,,\n";
  const std::string velocity = "dvl: {velocity: {columns: [vn, ve, vd], unit: m/s, frame: NED}}\n";
  const Imported ned = import_text(csv, kYawed + velocity);
  REQUIRE(ned.recording.dvl.size() == 1);
  CHECK((ned.recording.dvl[0].v_WB_B - Vector3d(2.0, -1.0, 0.5)).norm() < kRounding);
  const Imported enu = import_text(csv, kYawed + "dvl: {velocity: {columns: [ve, vn, vd], unit: m/s, frame: ENU}}\n");
  CHECK((enu.recording.dvl[0].v_WB_B - Vector3d(2.0, -1.0, -0.5)).norm() < kRounding);
  CHECK_THROWS_WITH_AS(import_text(csv, velocity), doctest::Contains("need an attitude"), InputError);
  const Imported rates = import_text("t,a,b,c,wn,we,wd\n0,0,0,90,1,2,3\n",
                                     "ahrs:\n  rates: {columns: [wn, we, wd], unit: rad/s, frame: NED}\n"
                                     "  euler: {columns: [a, b, c], unit: deg, world: NED, body: FRD}\n");
  CHECK((rates.recording.ahrs[0].w_WB_B - Vector3d(2.0, -1.0, 3.0)).norm() < kRounding);
}

TEST_CASE("columns: latitude and longitude become north and east of the first fix") {
  const std::string map = "pose_capture: {geodetic: {columns: [lat, lon, alt], unit: deg}}\n";
  const Imported imported = import_text("t,lat,lon,alt\n0,,,\n1,60,5,10\n2,60.001,5,10\n3,60,5.001,8\n", map);
  const auto& pose = imported.recording.pose_capture;
  REQUIRE(pose.size() == 3);
  CHECK(pose[0].p_WB.norm() < kRounding);
  // A degree of latitude at 60 deg is 111.412 km, one of longitude 55.800 km (WGS84, printed tables).
  CHECK(pose[1].p_WB.x() == doctest::Approx(111.412).epsilon(1e-4));
  CHECK(pose[2].p_WB.y() == doctest::Approx(55.800).epsilon(1e-4));
  CHECK(pose[2].p_WB.z() == doctest::Approx(2.0));
  CHECK(noted(imported, "from the first fix, 60.0000000 deg, 5.0000000 deg"));
  const Imported boat =
      import_text("t,lat,lon\n0,60,5\n1,60.001,5\n", "pose_capture: {geodetic: {columns: [lat, lon], unit: deg}}\n",
                  SimulatedAxes{true, true, false, false, false, true});
  CHECK(boat.recording.pose_capture[1].p_WB.z() == 0.0);
}

TEST_CASE("columns: pressure is depth by the water's density and the atmosphere") {
  const Imported imported = import_text("t,p\n0,1013.25\n1,2013.25\n",
                                        "depth: {pressure: {column: p, unit: mbar, surface: 101325 Pa, "
                                        "density: 1000 kg/m^3}}\n");
  CHECK(std::abs(imported.recording.depth[0].z) < kRounding);
  CHECK(imported.recording.depth[1].z == doctest::Approx(1e5 / 9806.65));
  const Imported relative = import_text("t,p\n0,10\n1,20\n",
                                        "depth: {pressure: {column: p, unit: dbar, surface: 0 Pa, "
                                        "density: 1025 kg/m^3}}\n");
  CHECK(relative.recording.depth[0].z == doctest::Approx(1e5 / (1025.0 * 9.80665)));
}

TEST_CASE("columns: course and speed over ground are a velocity") {
  const Imported boat =
      import_text("t,a,b,c,cog,sog\n0,0,0,60,90,2\n1,0,0,60,90,2\n",
                  kYawed + "dvl: {course: {column: cog, unit: deg}, speed: {column: sog, unit: m/s}}\n",
                  SimulatedAxes{true, true, false, false, false, true});
  CHECK((boat.recording.dvl[0].v_WB_B - Vector3d(std::sqrt(3.0), 1.0, 0.0)).norm() < kRounding);
}

TEST_CASE("columns: valid_where marks what is not valid, beside invalid_where") {
  const Imported imported = import_text("t,u,v,w,ok,bad\n0,1,1,1,1,0\n1,2,1,1,0,0\n2,3,1,1,1,1\n",
                                        "dvl:\n  velocity: {columns: [u, v, w], unit: m/s, frame: FRD}\n"
                                        "  valid_where: [ok]\n  invalid_where: [bad]\n");
  const auto& dvl = imported.recording.dvl;
  REQUIRE(dvl.size() == 3);
  CHECK(dvl[0].valid);
  CHECK_FALSE(dvl[1].valid);
  CHECK_FALSE(dvl[2].valid);
}

TEST_CASE("columns: streams in rows of their own are kept whole, and empty cells of the others refuse nothing") {
  std::string csv = "t,x,y,z,phi,theta,psi,p,q,r\n";
  for (int k = 0; k < 100; ++k) {
    const std::string t = std::to_string(0.01 * k);
    csv += k % 10 == 5 ? t + ",1,2,3,,,,,,\n" : k % 2 == 0 ? t + ",,,,0,0," + t + ",,,\n" : t + ",,,,,,,1,2,3\n";
  }
  const CsvTable table = parse_csv(csv, "run.csv");
  const Imported imported = import_table(table, canonical_map(table));
  CHECK(imported.recording.pose_capture.size() == 10);
  CHECK(euler_from_rotation(imported.recording.pose_capture[0].q_WB.toRotationMatrix()).z() == doctest::Approx(0.05));
  CHECK(imported.recording.ahrs.size() == 50 + 40);
  CHECK(std::ranges::is_sorted(imported.recording.ahrs, {}, &Ahrs::utime));
  CHECK(std::ranges::count_if(imported.recording.ahrs, &Ahrs::has_attitude) == 50);
  CHECK(std::ranges::count_if(imported.recording.ahrs, &Ahrs::has_rates) == 40);
  CHECK_FALSE(noted(imported, "refused"));
}

TEST_CASE("columns: a header's unit is obeyed, another dimension and an unknown one are refused") {
  CsvTable table = parse_csv("t [ms],psi (deg),u [kn],v [m/s],w,f1 [kN]\n0,180,1,1,1,2\n100,90,1,1,1,2\n", "run.csv");
  const auto notes = to_si(table);
  CHECK(notes.size() == 4);
  CHECK((*table.find("t"))[1] == doctest::Approx(0.1));
  CHECK((*table.find("psi"))[0] == doctest::Approx(std::numbers::pi));
  CHECK((*table.find("u"))[0] == doctest::Approx(0.514444).epsilon(1e-5));
  CHECK((*table.find("f1"))[0] == doctest::Approx(2000.0));
  CsvTable wrong = parse_csv("t,u [deg]\n0,1\n", "run.csv");
  CHECK_THROWS_WITH_AS((void)to_si(wrong), doctest::Contains("column 'u' is in deg, where m/s is meant"), InputError);
  CsvTable unknown = parse_csv("t,u [furlong]\n0,1\n", "run.csv");
  CHECK_THROWS_WITH_AS((void)to_si(unknown), doctest::Contains("its unit is not known"), InputError);
}

TEST_CASE("columns: a depth alone is understood where it is called z") {
  const CsvTable table = parse_csv("t,z,theta,u,w,q\n0,12.2,-0.39,0.33,0.01,0\n1,12.4,-0.39,0.33,0.01,0\n", "run.csv");
  const Imported imported =
      import_table(table, canonical_map(table), SimulatedAxes{true, false, true, false, false, false});
  CHECK(imported.recording.depth.at(1).z == 12.4);
  CHECK(imported.recording.pose_capture.empty());
  CHECK(imported.recording.ahrs.at(0).has_attitude);
  CHECK(noted(imported, "'z' without 'x' and 'y' is read as the column 'depth'"));
}

TEST_CASE("columns: heading senses, conjugate quaternions, rates of Euler angles and a heading offset, by hand") {
  const auto heading = [](const std::string& more) {
    const Imported imported = import_text(
        "t,a,b,c\n0,0,0,30\n", "ahrs:\n  euler: {columns: [a, b, c], unit: deg, " + more + "world: NED, body: FRD}\n");
    return euler_from_rotation(imported.recording.ahrs[0].q_WB.toRotationMatrix()).z() * 180.0 / std::numbers::pi;
  };
  CHECK(heading("") == doctest::Approx(30.0));
  CHECK(heading("heading: from_east, ") == doctest::Approx(60.0));
  CHECK(heading("heading: anticlockwise, ") == doctest::Approx(-30.0));
  CHECK(heading("heading_offset: 25 deg, ") == doctest::Approx(55.0));
  const Imported conjugate = import_text("t,w,x,y,z\n0,0.8,0.6,0,0\n",
                                         "ahrs:\n  quaternion: {columns: [w, x, y, z], order: wxyz, turns: "
                                         "world_to_body, world: NED, body: FRD}\n");
  CHECK(conjugate.recording.ahrs[0].q_WB.x() == doctest::Approx(-0.6));
  // Pitched up by 30 deg a turn in yaw is felt half as roll the other way.
  const Imported euler = import_text("t,a,b,c,da,db,dc\n0,0,30,0,0,0,2\n",
                                     "ahrs:\n  rates: {columns: [da, db, dc], unit: rad/s, frame: euler}\n"
                                     "  euler: {columns: [a, b, c], unit: deg, world: NED, body: FRD}\n");
  CHECK((euler.recording.ahrs[0].w_WB_B - Vector3d(-1.0, 0.0, std::sqrt(3.0))).norm() < kRounding);
}

TEST_CASE("columns: a map that is written is read as the same map") {
  const std::string text = kAbout +
                           "pose_capture:\n  position: {columns: [x, y, none], unit: mm, frame: ENU}\n"
                           "  euler: {columns: [none, none, c], unit: deg, heading: from_east, heading_offset: 3 deg, "
                           "world: NED, body: FRD}\n"
                           "  held: detect\n  valid_where: [ok]\n"
                           "ahrs:\n  rates: {columns: [p, q, r], unit: deg/s, frame: NED}\n"
                           "  specific_force: {columns: [\"a x\", ay, az], unit: m/s^2, frame: FLU}\n"
                           "dvl:\n  velocity: {columns: [u, v, none], unit: kn, frame: NWU}\n  invalid_where: [bad]\n"
                           "depth: {column: d, unit: m, direction: up, invalid_where: [flooded]}\n"
                           "thrusters:\n  wrench: {columns: [X, Y, N], force_unit: N, moment_unit: N m, frame: FRD}\n"
                           "battery: {column: \"volts 'main'\", unit: mV, valid_where: [on]}\n";
  const ColumnMap map = ColumnMap::parse(text, "map.yaml");
  const std::string once = to_yaml(map);
  CHECK(to_yaml(ColumnMap::parse(once, "again.yaml")) == once);
  const ColumnMap again = ColumnMap::parse(once, "again.yaml");
  CHECK(again.pose_capture->position->factor == doctest::Approx(1e-3));
  CHECK(again.pose_capture->position->to_house == map.pose_capture->position->to_house);
  CHECK(again.pose_capture->attitude->heading_sign == -1.0);
  CHECK(again.pose_capture->attitude->heading_offset == doctest::Approx(map.pose_capture->attitude->heading_offset));
  CHECK(again.pose_capture->invalid_where.at(0).negated);
  CHECK(again.ahrs->rates_in_world);
  CHECK(again.ahrs->specific_force->columns[0].name == "a x");
  CHECK(again.dvl->velocity.columns[2].absent);
  CHECK(again.depth->group.factor == doctest::Approx(-1.0));
  CHECK(again.depth->invalid_where.at(0).name == "flooded");
  CHECK(again.battery->group.columns[0].name == "volts 'main'");
  CHECK(again.battery->invalid_where.at(0).negated);
}

TEST_CASE("columns: a depth by its pressure is written as one") {
  const ColumnMap map = ColumnMap::parse(
      kAbout + "depth: {pressure: {column: p, unit: mbar, surface: 1013.25 mbar, density: 1025 kg/m^3}}\n", "map.yaml");
  const ColumnMap again = ColumnMap::parse(to_yaml(map), "again.yaml");
  CHECK(again.depth->group.factor == doctest::Approx(map.depth->group.factor).epsilon(1e-9));
  CHECK(again.depth->offset == doctest::Approx(map.depth->offset).epsilon(1e-9));
  CHECK(to_yaml(map).find("unit: hPa") != std::string::npos);
}

TEST_CASE("columns: shaft speeds become forces by k n |n|, commands between -1 and 1 become pulses") {
  const std::string csv = "t,port,starboard,a,b\n0,600,-600,0,1\n0.1,0,300,-0.5,0.25\n";
  const std::string map =
      "thrusters:\n  speed: {columns: [port, starboard], unit: rpm, ahead: 0.0111 N/(rad/s)^2, astern: 0.0064 "
      "N/(rad/s)^2}\n"
      "  command: {columns: [a, b], neutral: 1500 us, full: 400 us}\n";
  const Imported imported = import_text(csv, map);
  REQUIRE(imported.recording.thrusters.size() == 2);
  const double n = 600.0 * 2.0 * std::numbers::pi / 60.0;  // rad/s
  CHECK(imported.recording.thrusters[0].force[0] == doctest::Approx(0.0111 * n * n));
  CHECK(imported.recording.thrusters[0].force[1] == doctest::Approx(-0.0064 * n * n));
  CHECK(imported.recording.thrusters[1].force[1] == doctest::Approx(0.0111 * n * n / 4.0));
  CHECK(imported.recording.thrusters[0].pwm_us == std::vector<double>{1500.0, 1900.0});
  CHECK(imported.recording.thrusters[1].pwm_us == std::vector<double>{1300.0, 1600.0});
  const ColumnMap parsed = ColumnMap::parse(kAbout + map, "map.yaml");
  const ColumnMap again = ColumnMap::parse(to_yaml(parsed), "again.yaml");
  CHECK(again.thrusters->speed->astern == doctest::Approx(0.0064).epsilon(1e-9));
  CHECK(again.thrusters->command->full == 400.0);
  CHECK(to_yaml(again) == to_yaml(parsed));
  CHECK_THROWS_AS((void)ColumnMap::parse(kAbout + map + "  pwm: {columns: [a, b], unit: us}\n", "map.yaml"),
                  InputError);
}

TEST_CASE("columns: the pilot's sticks become pulses of the motors as ArduSub mixes them") {
  // pitch, roll, throttle, yaw, forward, lateral; full ahead, then half up with a quarter to starboard, then no signal
  const std::string csv =
      "t,p,r,th,y,f,l\n0,1500,1500,1500,1500,1900,1500\n1,1500,1500,1700,1500,1500,1600\n2,0,0,0,0,0,0\n";
  const std::string sticks =
      "thrusters:\n  sticks: {frame: vectored-6dof, columns: [p, r, th, y, f, l], neutral: 1500 us, full: 400 us";
  const Imported imported = import_text(csv, sticks + "}\n");
  const auto& thrusters = imported.recording.thrusters;
  REQUIRE(thrusters.size() == 2);
  CHECK(thrusters[0].pwm_us == std::vector<double>{1100, 1100, 1900, 1900, 1500, 1500, 1500, 1500});
  CHECK(thrusters[1].pwm_us == std::vector<double>{1600, 1400, 1600, 1400, 1300, 1300, 1300, 1300});
  CHECK(noted(imported, "1 samples left out: a stick's channel told no pulse"));
  const Imported reversed = import_text(csv, sticks + ", reversed: [1, 5]}\n");
  CHECK(reversed.recording.thrusters[1].pwm_us == std::vector<double>{1400, 1400, 1600, 1400, 1700, 1300, 1300, 1300});
  const std::string without =
      "thrusters:\n  sticks: {frame: vectored, columns: [none, none, th, y, f, none], neutral: 1500 us, full: 400 us, "
      "coupling: 1.2, reversed: [2]}\n";
  const ColumnMap parsed = ColumnMap::parse(kAbout + without, "map.yaml");
  CHECK(to_yaml(ColumnMap::parse(to_yaml(parsed), "again.yaml")) == to_yaml(parsed));
  CHECK(import_text(csv, without).recording.thrusters[0].pwm_us.size() == 6);
  CHECK_THROWS_WITH_AS(
      import_text(
          csv,
          "thrusters: {sticks: {frame: vectored9, columns: [p, r, th, y, f, l], neutral: 1500 us, full: 400 us}}\n"),
      doctest::Contains("did you mean vectored"), InputError);
  CHECK_THROWS_WITH_AS(import_text(csv, sticks + ", reversed: [9]}\n"), doctest::Contains("has motors 1 to 8"),
                       InputError);
  CHECK_THROWS_AS(import_text(csv, sticks + "}\n  pwm: {columns: [p, r], unit: us}\n"), InputError);
}

TEST_CASE("columns: acoustic fixes, ranges and loads come in from tables; an empty range is no echo") {
  const std::string csv = "t,e,n,up,good,ra,rb,l1\n0,1,2,-3,1,10,,5\n1,1,2,-3,0,0,12,\n2,,,,1,,,6\n";
  const std::string map =
      "usbl:\n  position: {columns: [e, n, up], unit: m, frame: ENU}\n  sigma: 0.5 m\n  valid_where: [good]\n"
      "ranges: {columns: [ra, rb], unit: m}\nloads: {columns: [l1], unit: N}\n";
  const Imported imported = import_text(csv, map);
  const Recording& r = imported.recording;
  REQUIRE(r.usbl.size() == 2);
  CHECK(r.usbl[0].p_WB == Vector3d(2, 1, 3));
  CHECK(r.usbl[0].sigma == Vector3d(0.5, 0.5, 0.5));
  CHECK(r.usbl[0].valid);
  CHECK_FALSE(r.usbl[1].valid);
  REQUIRE(r.ranges.size() == 2);
  CHECK(r.ranges[0].range == std::vector<double>{10.0, 0.0});
  CHECK(r.ranges[0].valid == std::vector<std::uint8_t>{1, 0});
  CHECK(r.ranges[1].valid == std::vector<std::uint8_t>{0, 1});
  REQUIRE(r.loads.size() == 2);
  CHECK(r.loads[1].utime == 2'000'000);
  const ColumnMap parsed = ColumnMap::parse(kAbout + map, "map.yaml");
  const std::string once = to_yaml(parsed);
  CHECK(to_yaml(ColumnMap::parse(once, "again.yaml")) == once);
  CHECK(once.find("sigma: 0.5 m") != std::string::npos);
  // Standard deviations of their own stand along the position's axes.
  const Imported own = import_text("t,e,n,up,se,sn,su\n0,1,2,3,0.1,0.2,0.3\n",
                                   "usbl:\n  position: {columns: [e, n, up], unit: m, frame: ENU}\n"
                                   "  sigma: {columns: [se, sn, su], unit: m}\n");
  CHECK(own.recording.usbl.at(0).sigma == Vector3d(0.2, 0.1, 0.3));
}

TEST_CASE("columns: wind and whatever else was measured are carried under their names, in SI where the unit is known") {
  const std::string csv = "t,ws,wd,winch,salinity,bad\n0,10,90,60,35.1,0\n1,,180,,35.2,0\n2,20,270,30,35.3,1\n";
  const std::string map =
      "wind:\n  reference: apparent\n  speed: {column: ws, unit: kn}\n  from: {column: wd, unit: deg}\n"
      "signals:\n  columns: [winch, salinity]\n  units: [rpm, 'g/kg of salt']\n  invalid_where: [bad]\n";
  const ColumnMap first = ColumnMap::parse(kAbout + map, "map.yaml");
  for (const std::string& text : {kAbout + map, to_yaml(first)}) {
    CAPTURE(text);
    const Imported in = import_table(parse_csv(csv, "run.csv"), ColumnMap::parse(text, "map.yaml"));
    const std::vector<Signal>& all = in.recording.signals;
    REQUIRE(all.size() == 2 + 3 + 1 + 2);
    CHECK(std::ranges::is_sorted(all, {}, &Signal::utime));
    const auto of = [&](const std::string& name) {
      std::vector<Signal> some;
      std::ranges::copy_if(all, std::back_inserter(some), [&](const Signal& one) { return one.name == name; });
      return some;
    };
    CHECK(of("ws")[1].value == doctest::Approx(20.0 * 1852.0 / 3600.0));
    CHECK(of("ws")[1].utime == 2'000'000);
    CHECK(of("ws")[0].quantity == "wind_speed_apparent");
    CHECK(of("ws")[0].unit == "m/s");
    CHECK(of("wd")[0].value == doctest::Approx(0.5 * std::numbers::pi));
    CHECK(of("wd")[0].quantity == "wind_from_apparent");
    CHECK(of("winch")[0].value == doctest::Approx(2.0 * std::numbers::pi));
    CHECK(of("winch")[0].unit == "rad/s");
    CHECK(of("winch").size() == 1);
    CHECK(of("salinity")[1].value == 35.2);
    CHECK(of("salinity")[0].unit == "g/kg of salt");
    CHECK(of("salinity")[0].quantity.empty());
    CHECK(noted(in, "column 'salinity': 1 samples marked or left out as invalid by their flags"));
  }
  CHECK_THROWS_WITH_AS(import_text(csv, "wind: {speed: {column: ws, unit: kn}, reference: ground}\n"),
                       doctest::Contains("must be true (over ground"), InputError);
  CHECK_THROWS_WITH_AS(import_text(csv, "wind: {speed: {column: ws, unit: deg}, reference: true}\n"),
                       doctest::Contains("does not fit"), InputError);
  CHECK_THROWS_WITH_AS(import_text(csv, "signals: {columns: [ws, wd], units: [kn]}\n"),
                       doctest::Contains("one unit for each"), InputError);
}

TEST_CASE("columns: ranges and loads by their names need no map") {
  const CsvTable table = parse_csv("t,range_A,range_B,load_x\n0,1,2,3\n1,1,,3\n", "run.csv");
  const Imported imported = import_table(table, canonical_map(table));
  CHECK(imported.notes.empty());
  CHECK(imported.recording.ranges.at(1).valid == std::vector<std::uint8_t>{1, 0});
  CHECK(imported.recording.loads.size() == 2);
}

TEST_CASE("columns: tags, optical flow and laser dots come in from tables, and their map can be written again") {
  const std::string csv =
      "t,id,tx,ty,tz,qx,qy,qz,qw,err,fx,fy,dt,n,lx,ly,lz,ok\n"
      "0,7,1,2,3,0,0,0.6,0.8,0.4,1,2,100,35,4,5,6,1\n"
      "0.1,8.5,1,2,3,0,0,0.6,0.8,0.4,,,,,4,5,6,0\n"
      "0.2,9,1,2,3,0,0,0,0.5,0.4,1,2,100,,4,,6,1\n";
  const std::string map =
      "tag_pose: {camera: front, tag: {column: id}, position: {columns: [tx, ty, tz], unit: cm}, quaternion: {columns: "
      "[qx, qy, qz, qw], order: xyzw}, reprojection_error: {column: err}}\n"
      "optical_flow: {camera: down, flow: {columns: [fx, fy], unit: deg/s}, interval: {column: dt, unit: ms}, sigma: "
      "0.02 rad/s, tracks: {column: n}}\n"
      "laser_range: {camera: down, position: {columns: [lx, ly, lz], unit: m}, sigma: 5 mm, valid_where: [ok]}\n";
  const ColumnMap first = ColumnMap::parse(kAbout + map, "map.yaml");
  for (const std::string& text : {kAbout + map, to_yaml(first)}) {
    CAPTURE(text);
    const Imported in = import_table(parse_csv(csv, "run.csv"), ColumnMap::parse(text, "map.yaml"));
    const Recording& run = in.recording;
    REQUIRE(run.tag_pose.size() == 1);  // a tag of half a number, and a quaternion that is none
    CHECK(run.tag_pose[0].camera == "front");
    CHECK(run.tag_pose[0].tag == 7);
    CHECK((run.tag_pose[0].p_CT - Vector3d(0.01, 0.02, 0.03)).norm() < kRounding);
    CHECK(run.tag_pose[0].q_CT.angularDistance(Eigen::Quaterniond(0.8, 0, 0, 0.6)) < kRounding);
    CHECK(run.tag_pose[0].reprojection_error == 0.4);
    CHECK(noted(in, "tag_pose: 1 samples refused"));
    CHECK(noted(in, "tag_pose: 1 samples invalid because their quaternion is not of unit length"));
    REQUIRE(run.optical_flow.size() == 1);
    CHECK(run.optical_flow[0].flow_C.y() == doctest::Approx(2.0 * std::numbers::pi / 180.0));
    CHECK(run.optical_flow[0].interval == doctest::Approx(0.1));
    CHECK(run.optical_flow[0].sigma_across() == doctest::Approx(0.02));
    CHECK_FALSE(run.optical_flow[0].tells_approach());
    CHECK(run.optical_flow[0].n_tracks == 35);
    REQUIRE(run.laser_range.size() == 1);
    CHECK(run.laser_range[0].p_CL == Vector3d(4, 5, 6));
    CHECK(run.laser_range[0].sigma_range == doctest::Approx(0.005));
    CHECK(noted(in, "laser_range: 1 samples marked or left out as invalid by their flags"));
  }
  CHECK_THROWS_WITH_AS(import_text(csv,
                                   "laser_range: {camera: c, position: {columns: [lx, none, lz], unit: m}, sigma: "
                                   "5 mm}\n"),
                       doctest::Contains("each component is needed"), InputError);
  CHECK_THROWS_WITH_AS(import_text(csv, "usbl: {position: {columns: [lx, ly], unit: m, frame: ENU}, sigma: 1 m}\n"),
                       doctest::Contains("'columns' needs 3 columns, not 2"), InputError);
}

TEST_CASE("columns: a signal that is the water's velocity or a tether's length says so, in a unit that fits") {
  const std::string csv = "t,cn,winch,temp\n0,20,3,11\n1,30,4,12\n";
  const std::string map =
      "signals: {columns: [cn, winch, temp], units: [cm/s, m, C], quantities: [water_velocity_north, tether_paid_out, "
      "none]}\n";
  const ColumnMap first = ColumnMap::parse(kAbout + map, "map.yaml");
  for (const std::string& text : {kAbout + map, to_yaml(first)}) {
    CAPTURE(text);
    const Imported in = import_table(parse_csv(csv, "run.csv"), ColumnMap::parse(text, "map.yaml"));
    REQUIRE(in.recording.signals.size() == 6);
    for (const Signal& one : in.recording.signals) {
      if (one.name == "cn") CHECK(one.quantity == "water_velocity_north");
      if (one.name == "winch") CHECK(one.quantity == "tether_paid_out");
      if (one.name == "temp") CHECK(one.quantity.empty());
    }
    CHECK(in.recording.signals[0].value == doctest::Approx(0.2));
  }
  CHECK_THROWS_WITH_AS(import_text(csv, "signals: {columns: [cn], units: [kn], quantities: [flow]}\n"),
                       doctest::Contains("is no quantity"), InputError);
  CHECK_THROWS_WITH_AS(import_text(csv, "signals: {columns: [cn], units: [kn], quantities: [tether_paid_out]}\n"),
                       doctest::Contains("told in m"), InputError);
  CHECK_THROWS_WITH_AS(import_text(csv, "signals: {columns: [cn, temp], units: [kn, C], quantities: [none]}\n"),
                       doctest::Contains("one word for each"), InputError);
}
