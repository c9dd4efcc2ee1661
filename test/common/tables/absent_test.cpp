// Tables that lack components along axes which the vehicle does not move along, canonical and through a map.
#include "common/tables/absent.hpp"

#include <doctest/doctest.h>

#include <string>

#include "common/base/error.hpp"
#include "common/base/spatial.hpp"
#include "common/tables/import.hpp"

using Eigen::Vector3d;
using namespace fathom;
using namespace fathom::tables;

namespace {

constexpr double kAttitude = 1e-12;  // rad: Euler angles and back
constexpr SimulatedAxes kPlanar{true, true, false, false, false, true};
constexpr SimulatedAxes kTurning{false, false, false, true, true, true};
constexpr SimulatedAxes kYawing{false, false, false, false, false, true};
constexpr SimulatedAxes kAll{true, true, true, true, true, true};

Imported read(const std::string& csv, const SimulatedAxes& simulated) {
  const CsvTable table = parse_csv(csv, "run.csv");
  return import_table(table, canonical_map(table), simulated);
}

Imported read(const std::string& csv, const std::string& map, const SimulatedAxes& simulated) {
  const std::string about = "source: nobody\nlicence: none\ntime: {column: t, unit: s}\n";
  return import_table(parse_csv(csv, "run.csv"), ColumnMap::parse(about + map, "map.yaml"), simulated);
}

template <class... Input>
std::string complaint(const Input&... input) {
  try {
    static_cast<void>(read(input...));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no complaint";
}

Vector3d euler(const Eigen::Quaterniond& q) { return euler_from_rotation(q.toRotationMatrix()); }

}  // namespace

TEST_CASE("absent: a planar vehicle's table needs no column out of the plane, and says what is taken as zero") {
  const Imported planar = read("t,x,y,psi,u,v,r,X,Y,N\n0,1,2,0.3,4,5,6,7,8,9\n", kPlanar);
  const Recording& run = planar.recording;
  CHECK(run.pose_capture.at(0).p_WB == Vector3d(1, 2, 0));
  CHECK((euler(run.pose_capture[0].q_WB) - Vector3d(0, 0, 0.3)).norm() < kAttitude);
  CHECK(run.dvl.at(0).v_WB_B == Vector3d(4, 5, 0));
  CHECK(run.ahrs.at(0).w_WB_B == Vector3d(0, 0, 6));
  CHECK(run.thrusters.at(0).tau == std::array<double, 6>{7, 8, 0, 0, 0, 9});
  REQUIRE(planar.notes.size() == 1);
  CHECK(planar.notes[0] ==
        "columns for phi, theta, z, w, p, q, Z, K, M are missing and taken as zero: the vehicle simulates surge, sway, "
        "yaw only");
}

TEST_CASE("absent: a vehicle that only turns needs moments alone, one that only yaws a single one") {
  const Recording turning = read("t,phi,theta,psi,p,q,r,K,M,N\n0,0.1,0.2,0.3,4,5,6,7,8,9\n", kTurning).recording;
  CHECK(turning.pose_capture.empty());
  CHECK(turning.ahrs.at(0).w_WB_B == Vector3d(4, 5, 6));
  CHECK(turning.thrusters.at(0).tau == std::array<double, 6>{0, 0, 0, 7, 8, 9});
  const Recording yawing = read("t,psi,r,N\n0,0.3,6,9\n", kYawing).recording;
  CHECK((euler(yawing.ahrs.at(0).q_WB) - Vector3d(0, 0, 0.3)).norm() < kAttitude);
  CHECK(yawing.thrusters.at(0).tau == std::array<double, 6>{0, 0, 0, 0, 0, 9});
}

TEST_CASE("absent: what a simulated axis needs is not taken as zero") {
  CHECK(complaint("t,x,y,u,v,w\n0,1,2,3,4,5\n", kAll) ==
        "run.csv:1: columns 'x', 'y' stand without 'z'; the vehicle simulates heave, where z cannot be taken as zero: "
        "add "
        "what was measured, or leave heave out of 'dof' in the vehicle file");
  // Turned, a vehicle that only goes ahead moves along y too.
  CHECK(complaint("t,x,u\n0,1,2\n", SimulatedAxes{true}) == "no complaint");
  CHECK(complaint("t,x,psi,u\n0,1,0.2,2\n", SimulatedAxes{true}).rfind("run.csv:1: columns 'x' stand without 'y'", 0) ==
        0);
  CHECK(complaint("t,ax,ay,p,q,r\n0,1,2,3,4,5\n", kYawing) ==
        "run.csv:1: columns 'ax', 'ay' stand without 'az'; they go together");
}

TEST_CASE("absent: a short list in a map goes to the axes that the vehicle simulates, 'none' says so in any case") {
  const std::string csv = "t,e,n,h,w,fx,fy,mz\n0,1,2,30,4,5,6,7\n";
  const std::string map =
      "pose_capture:\n  position: {columns: [e, n], unit: m, frame: ENU}\n"
      "  euler: {columns: [h], unit: deg, world: NED, body: FRD}\n"
      "ahrs:\n  rates: {columns: [none, none, w], unit: rad/s, frame: FLU}\n"
      "thrusters:\n  wrench: {columns: [fx, fy, mz], force_unit: N, moment_unit: N m, frame: FLU}\n";
  const Recording run = read(csv, map, kPlanar).recording;
  CHECK(run.pose_capture.at(0).p_WB == Vector3d(2, 1, 0));
  CHECK((euler(run.pose_capture[0].q_WB) - Vector3d(0, 0, M_PI / 6)).norm() < kAttitude);
  CHECK(run.ahrs.at(0).w_WB_B == Vector3d(0, 0, -4));
  CHECK(run.thrusters.at(0).tau == std::array<double, 6>{5, -6, 0, 0, 0, -7});
  CHECK(
      complaint(csv, map, kAll) ==
      "map.yaml:6: 'columns' needs 3 columns, not 1; 1 of 3 would do where the vehicle simulates no more (phi, theta, "
      "psi are needed), with 'none' in the place of the others");
  CHECK(complaint(csv, std::string("ahrs:\n  rates: {columns: [none, none, none], unit: rad/s, frame: FLU}\n"), kAll) ==
        "map.yaml:5: 'columns' names no column");
}
