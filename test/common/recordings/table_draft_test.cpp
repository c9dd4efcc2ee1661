// A stranger's table: what its columns are, and a map of the usual names that runs as it is.
#include "common/recordings/table_draft.hpp"

#include <doctest/doctest.h>

#include "common/tables/import.hpp"

namespace fathom {
namespace {

tables::Imported drafted(const std::string& csv, std::string& text, const tables::SimulatedAxes& axes) {
  const tables::CsvTable table = tables::parse_csv(csv, "run.csv");
  text = recordings::describe_table(table);
  return tables::import_table(table, tables::ColumnMap::parse(text, "draft.yaml"), axes);
}
constexpr tables::SimulatedAxes kBoat{true, true, false, false, false, true};
constexpr tables::SimulatedAxes kAll{true, true, true, true, true, true};

}  // namespace

TEST_CASE("table draft: a boat's log of a data frame, milliseconds, degrees, pulses") {
  // The names of a published set of a BlueBoat; numbers made up.
  std::string text = ",original_timestamp,lat,lon,x_ned,y_ned,yaw,surge,sway,yaw_rate,thr_left,thr_right,mode\n";
  for (int k = 0; k < 20; ++k)
    text += std::to_string(k) + "," + std::to_string(1444243 + 100 * k) + ".083,63.4,10.3," + std::to_string(0.1 * k) +
            ",4,74.3,0.5,0.1,-0.016," + std::to_string(1500 + k) + ",1520,MANUAL\n";
  std::string draft;
  const tables::Imported imported = drafted(text, draft, kBoat);
  CAPTURE(draft);
  CHECK(draft.find("# yaw: 20, 74.3 to 74.3") != std::string::npos);
  CHECK(draft.find("# mode: words") != std::string::npos);
  CHECK(draft.find("time: {column: original_timestamp, unit: ms}") != std::string::npos);
  const Recording& run = imported.recording;
  REQUIRE(run.pose_capture.size() == 20);
  CHECK(run.pose_capture[19].p_WB.x() == doctest::Approx(1.9));
  CHECK(run.pose_capture[0].q_WB.angularDistance(Eigen::Quaterniond::Identity()) ==
        doctest::Approx(1.2968).epsilon(1e-3));
  CHECK(seconds_between(run.dvl[0].utime, run.dvl[19].utime) == doctest::Approx(1.9));
  CHECK(run.dvl[0].v_WB_B == Eigen::Vector3d(0.5, 0.1, 0.0));
  CHECK(run.ahrs[0].w_WB_B.z() == doctest::Approx(-0.016));
  CHECK(draft.find("pwm: {columns: [thr_left], unit: us}") != std::string::npos);  // the other one never moves
}

TEST_CASE(
    "table draft: ROS's names are east-north-up and forward-left-up, headers tell units, and what is not known is "
    "said") {
  std::string text =
      "header.stamp.sec,header.stamp.nanosec,pose.pose.position.x,pose.pose.position.y,pose.pose.position.z,"
      "pose.pose.orientation.x,pose.pose.orientation.y,pose.pose.orientation.z,pose.pose.orientation.w,"
      "twist.twist.linear.x,twist.twist.linear.y,twist.twist.linear.z,voltage [mV]\n";
  for (int k = 0; k < 10; ++k)
    text += "1748338850," + std::to_string(100000000 * k) + ",1,2,3,0,0,0,1,0.5,0.25,0.125,16000\n";
  std::string draft;
  const tables::Imported imported = drafted(text, draft, kAll);
  CAPTURE(draft);
  REQUIRE(imported.recording.pose_capture.size() == 10);
  CHECK((imported.recording.pose_capture[0].p_WB - Eigen::Vector3d(2, 1, -3)).norm() < 1e-12);
  CHECK((imported.recording.dvl[0].v_WB_B - Eigen::Vector3d(0.5, -0.25, -0.125)).norm() < 1e-12);
  CHECK(imported.recording.battery.at(0).voltage == doctest::Approx(16.0));

  const auto described = [](const std::string& csv) {
    return recordings::describe_table(tables::parse_csv(csv, "r.csv"));
  };
  CHECK(described("a,b\n0,1\n1,2\n").find("No column looks like the time") != std::string::npos);
  CHECK(described("time,b\n0,1\n1,2\n").find("No column has a usual name") != std::string::npos);
}

}  // namespace fathom
