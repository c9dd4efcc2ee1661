// A stranger's table: what its columns are, and a map of the usual names that runs as it is.
#include "common/recordings/table_draft.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "common/tables/import.hpp"
#include "common/tables/unit_words.hpp"

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

TEST_CASE("table draft: date and time of day in two columns, wind, units at the ends of names, a wrench") {
  std::string boat = "Date;Time;Latitude;Longitude;HDG [deg];ROT [deg/min];SOG [kn];COG [deg];AWS [kn];AWA [deg]\n";
  std::string pool =
      "elapsed_ms\teast_m\tnorth_m\tdepth_m\tsurge_cm_s\tsway_cm_s\theave_cm_s\tyawrate_deg_s\tFx_N\tFy_N\tFz_N\tMz_"
      "Nm\n";
  for (int k = 0; k < 10; ++k) {
    boat += "03.05.2026;09:00:0" + std::to_string(k) + ",5;54,3;10,1;90;6;2;90;10;" + std::to_string(90 + k) + "\n";
    pool += std::to_string(50 * k) + "\t1\t2\t3\t40\t20\t0\t57.29578\t1\t2\t0\t3\n";
  }
  std::string draft;
  const Recording sailed = drafted(boat, draft, kBoat).recording;
  CAPTURE(draft);
  CHECK(draft.find("time: {columns: [Date, Time], units: [date, date]}") != std::string::npos);
  REQUIRE(sailed.pose_capture.size() == 10);
  CHECK(seconds_between(sailed.pose_capture[0].utime, sailed.pose_capture[9].utime) == doctest::Approx(9.0));
  CHECK(sailed.ahrs.at(0).w_WB_B.z() == doctest::Approx(6.0 / 60.0 * 0.01745329).epsilon(1e-6));
  REQUIRE(sailed.signals.size() == 20);
  CHECK(sailed.signals[0].quantity == "wind_speed_apparent");
  CHECK(sailed.signals[0].value == doctest::Approx(5.14444).epsilon(1e-5));
  CHECK(sailed.signals[1].value == doctest::Approx(1.5707963).epsilon(1e-6));

  const Recording swum = drafted(pool, draft, {true, true, true, false, false, true}).recording;
  CHECK(swum.pose_capture.at(9).p_WB == Eigen::Vector3d(2, 1, 3));
  CHECK(swum.depth.empty());  // the same number twice would prove nothing
  CHECK(swum.dvl.at(0).v_WB_B.x() == doctest::Approx(0.4));
  CHECK(swum.ahrs.at(0).w_WB_B.z() == doctest::Approx(1.0).epsilon(1e-6));
  CHECK(swum.thrusters.at(0).tau[5] == 3.0);
  CHECK(seconds_between(swum.dvl[0].utime, swum.dvl[9].utime) == doctest::Approx(0.45));
}

TEST_CASE("table draft: a Slocum's own names") {
  std::string text = "m_present_time,m_depth,m_pitch,m_roll,m_heading,m_ballast_pumped,m_battpos\n";
  for (int k = 0; k < 10; ++k) text += std::to_string(1700000000 + 4 * k) + ",10,0.4,0,1,-230,0.5\n";
  std::string draft;
  const Recording run = drafted(text, draft, kAll).recording;
  CAPTURE(draft);
  CHECK(run.depth.at(0).z == 10.0);
  CHECK(run.ahrs.at(0).has_attitude);
  CHECK(run.thrusters.at(0).pwm_us.at(0) == doctest::Approx(-230e-6));
  CHECK(run.thrusters[0].pwm_us.at(1) == doctest::Approx(0.0127));
}

TEST_CASE("table draft: columns that are called as the vehicle's actuators are command them, in its order") {
  using By = recordings::Commanded::By;
  const auto draft = [](const std::string& header, const std::string& row,
                        const std::vector<recordings::Commanded>& actuators) {
    std::string text = "t," + header + "\n";
    for (int k = 0; k < 4; ++k) text += std::to_string(k) + "," + row + "\n";
    return recordings::describe_table(tables::parse_csv(text, "run.csv"), actuators);
  };
  const std::vector<recordings::Commanded> ship{{"propeller", By::kShaftSpeed}, {"rudder", By::kAngle}};
  const auto holds = [](const std::string& text, const char* what) { return text.find(what) != std::string::npos; };
  CHECK(holds(draft("u,Rudder,propeller [rev/s]", "1,0.5,17", ship),
              "inputs: {columns: [propeller, Rudder], units: [rev/s, rad]}"));
  CHECK(holds(draft("u,delta,n", "1,20,900", ship), "inputs: {columns: [n, delta], units: [rpm, deg]}"));
  // What is left is a map that runs.
  CHECK(tables::ColumnMap::parse(draft("u,delta", "1,20", ship), "draft.yaml").dvl.has_value());
  CHECK(holds(draft("u,delta", "1,20", ship), "# thrusters, inputs: a column for propeller is to be found"));
  // Pulses of thrusters with the same names are pulses, and nothing is missing.
  const std::vector<recordings::Commanded> pushed{{"thr_1", By::kPulses}, {"thr_2", By::kPulses}};
  std::string pulses = "t,u,thr_1,thr_2\n";
  for (int k = 0; k < 4; ++k)
    pulses += std::to_string(k) + ",1," + std::to_string(1500 + k) + "," + std::to_string(1490 - k) + "\n";
  const std::string drafted_pulses = recordings::describe_table(tables::parse_csv(pulses, "run.csv"), pushed);
  CHECK(holds(drafted_pulses, "pwm: {columns: [thr_1, thr_2], unit: us}"));
  CHECK(!holds(drafted_pulses, "is to be found"));
  const std::vector<recordings::Commanded> twin{{"port", By::kShaftSpeed}, {"starboard", By::kShaftSpeed}};
  CHECK(holds(draft("u,n_starboard,n_port", "1,2,3", twin),
              "inputs: {columns: [n_port, n_starboard], units: [rpm, rpm]}"));
  CHECK(!holds(draft("u,n,rudder", "1,2,3", twin), "inputs"));  // which of two shafts 'n' is, nobody knows
}

TEST_CASE("table draft: names are read by their words and units, however they are written") {
  const std::string rows = [] {
    std::string text;
    for (int k = 0; k < 20; ++k)
      text += std::to_string(0.1 * k) + ",1,2,90," + std::to_string(0.5 + 0.01 * k) + ",0.25,180\n";
    return text;
  }();
  for (const char* header : {"Time (s),X Position (m),Y Position (m),Heading Angle (deg),Surge Velocity (m/s),"
                             "Sway Velocity (m/s),Yaw Rate (deg/s)",
                             "time,posNorth,posEast,yawDeg,dvlVelX,dvlVelY,gyroZ_dps",
                             "elapsed_s,northing_m,easting_m,compass_heading_deg,v_x_mps,v_y_mps,yaw_rate_deg_per_s",
                             "seconds,pos_x,pos_y,heading_measured,surge speed,sway speed,Rate Of Turn [°/s]"}) {
    CAPTURE(header);
    std::string draft;
    const Recording run = drafted(std::string{header} + "\n" + rows, draft, kBoat).recording;
    CAPTURE(draft);
    REQUIRE(run.pose_capture.size() == 20);
    CHECK(run.pose_capture[0].p_WB == Eigen::Vector3d(1, 2, 0));
    CHECK(run.pose_capture[0].q_WB.z() == doctest::Approx(std::sqrt(0.5)));
    CHECK(run.dvl.at(0).v_WB_B == Eigen::Vector3d(0.5, 0.25, 0.0));
    CHECK(run.ahrs.at(0).w_WB_B.z() == doctest::Approx(3.14159265));
  }
  CHECK(tables::unit_at_end("voltage_mV").unit == "mV");
  CHECK(tables::unit_at_end("yawRateDeg").name == "yawRate");
  CHECK(tables::unit_at_end("acc_m_per_s2").unit == "m/s^2");
  CHECK(tables::unit_at_end("m").unit.empty());
  // What is commanded is no measurement, a revolution a second is none of a craft, and what is of other kinds is
  // nothing.
  const auto described = [&](const std::string& header) {
    return recordings::describe_table(tables::parse_csv(header + "\n" + rows, "r.csv"));
  };
  CHECK(described("t,a,b,yaw_cmd,c,d,e").find("No column has a usual name") != std::string::npos);
  CHECK(described("t,a,b,yaw_temperature,u,d,e").find("euler") == std::string::npos);
  CHECK(described("t,a,b,c,r_rps,d,e").find("rates: {columns: [none, none, r_rps], unit: rad/s") != std::string::npos);
  CHECK(described("t,vn,ve,heading,u_cmd,d,e").find("velocity: {columns: [vn, ve, none], unit: m/s, frame: NED}") !=
        std::string::npos);
}

TEST_CASE(
    "table draft: what drives thrusters is told by its columns' words, unit and range, or what is missing is said") {
  using By = recordings::Commanded::By;
  const auto draft = [](const std::string& header, const std::string& row, By by) {
    std::string text = "t,u," + header + "\n";
    for (int k = 0; k < 4; ++k) text += std::to_string(k) + ",1," + row + "\n";
    return recordings::describe_table(tables::parse_csv(text, "run.csv"), {{"port", by}, {"starboard", by}});
  };
  const auto holds = [](const std::string& text, const char* what) { return text.find(what) != std::string::npos; };
  CHECK(holds(draft("rpm_stbd,rpm_port", "300,400", By::kShaftSpeed),
              "inputs: {columns: [rpm_port, rpm_stbd], units: [rpm, rpm]}"));
  CHECK(holds(draft("Left Motor (rpm),Right Motor (rpm),Left Motor Temperature", "300,400,30", By::kForce),
              "#   speed: {columns: ['Left Motor', 'Right Motor'], unit: rpm, ahead: ..."));
  CHECK(holds(draft("thrustStarboard_N,thrustPort_N", "3,4", By::kForce),
              "force: {columns: [thrustPort_N, thrustStarboard_N], unit: N}"));
  CHECK(holds(draft("cmd_port,cmd_stbd", "0.5,-1", By::kForce), "are shares of full thrust"));
  CHECK(holds(draft("port,starboard", "5,-10", By::kForce), "have no unit: force (N), speed (rpm) or pwm (us)?"));
  CHECK(holds(draft("current_port_A,current_stbd_A", "5,10", By::kForce), "without one no model can be fitted"));
}

}  // namespace fathom
