// The whole way of a stranger's recording, without an edit: file, describe, import, check, diagnose; for a DataFlash,
// an ULog and an MCAP log of the same two dives.
#include "test/support/foreign_logs.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "common/base/spatial.hpp"
#include "test/support/scratch.hpp"
#include "test/support/shell.hpp"
#include "test/support/virtual_dive.hpp"

namespace fathom {
namespace {

using test::packed;
using test::program;
using test::Ran;
using test::Scratch;
using test::shell;

const std::string kTool = program("fathom");

const char kVehicle[] =
    "name: Sled\ndof: [surge, yaw]\nwater_density: 1000 kg/m^3\nmass: 20 kg\ninertia: 0.5 0.8 1 kg m^2\n"
    "nominal_voltage: 16 V\nthrusters:\n  - {name: starboard, position: 0 0.2 0 m, axis: 1 0 0}\n"
    "  - {name: port, position: 0 -0.2 0 m, axis: 1 0 0}\n"
    "thrust_curve:\n  neutral: 1500 us\n  voltage: 16 V\n  pwm: 900 1500 2100 us\n  force: -60 0 60 N\n";

/// What instruments say of a dive at one time.
struct Moment {
  double t{};
  Eigen::Vector3d p_WB, w_B, f_B;
  Eigen::Quaterniond q_WB;
  std::vector<std::uint16_t> pwm;
};

std::vector<Moment> moments_of(const Trial& trial, unsigned seed) {
  std::mt19937 random{seed};
  std::normal_distribution<double> normal;
  const auto noise = [&](double sigma) {
    return Eigen::Vector3d{sigma * normal(random), sigma * normal(random), sigma * normal(random)};
  };
  std::vector<Moment> moments;
  for (std::size_t k = 1; k + 1 < trial.size(); ++k) {
    Moment one{.t = trial.t[k]};
    const Eigen::Vector3d a_W = (trial.p_WB[k + 1] - 2.0 * trial.p_WB[k] + trial.p_WB[k - 1]) / (trial.dt * trial.dt);
    one.p_WB = trial.p_WB[k] + noise(1e-3);
    one.q_WB = trial.q_WB[k];
    one.w_B = trial.nu[k].tail<3>();
    one.f_B = trial.q_WB[k].conjugate() * (a_W - Eigen::Vector3d{0.0, 0.0, 9.80665}) + noise(0.02);
    for (const double force : trial.input[k])
      one.pwm.push_back(static_cast<std::uint16_t>(std::lround(1500.0 + 10.0 * force)));
    moments.push_back(one);
  }
  return moments;
}

std::string floats(const Eigen::Vector3d& v) {
  return packed(static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()));
}

std::string dataflash_of(const std::vector<Moment>& moments) {
  test::DataFlashLog log;
  log.format(1, 3 + 8 + 1 + 24, "IMU", "QBffffff", "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ");
  log.format(2, 3 + 8 + 24, "VISP", "Qffffff", "TimeUS,PX,PY,PZ,Roll,Pitch,Yaw");
  log.format(3, 3 + 8 + 28, "RCOU", "QHHHHHHHHHHHHHH", "TimeUS,C1,C2,C3,C4,C5,C6,C7,C8,C9,C10,C11,C12,C13,C14");
  log.format(4, 3 + 8 + 1 + 4, "BAT", "QBf", "TimeUS,Instance,Volt");
  log.format(5, 3 + 8 + 1 + 4, "BARO", "QBf", "TimeUS,I,Alt");
  for (const Moment& one : moments) {
    const auto time = static_cast<std::uint64_t>(265e6 + 1e6 * one.t);
    log.record(1, packed(time, std::uint8_t{0}) + floats(one.w_B) + floats(one.f_B));
    log.record(2, packed(time + 500) + floats(one.p_WB) +
                      floats(euler_from_rotation(one.q_WB.toRotationMatrix()) * 180.0 / M_PI));
    std::string outputs = packed(time + 700, one.pwm[0], one.pwm[1]);
    for (int i = 2; i < 14; ++i) outputs += packed(static_cast<std::uint16_t>(i == 12 ? 1100 : 0));  // a lamp at 13
    log.record(3, outputs);
    log.record(4, packed(time + 800, std::uint8_t{0}, 16.0F));
    log.record(5, packed(time + 900, std::uint8_t{0}, -9.2F));  // in the hull
  }
  return log.bytes;
}

std::string ulog_of(const std::vector<Moment>& moments) {
  test::UlogLog log{1000};
  log.format("sensor_combined:uint64_t timestamp;float[3] gyro_rad;float[3] accelerometer_m_s2;");
  log.format("vehicle_visual_odometry:uint64_t timestamp;uint64_t timestamp_sample;float[3] position;float[4] q;");
  log.format("actuator_outputs:uint64_t timestamp;uint32_t noutputs;float[16] output;uint8_t[4] _padding0;");
  log.format("battery_status:uint64_t timestamp;float voltage_v;");
  const char* names[] = {"sensor_combined", "vehicle_visual_odometry", "actuator_outputs", "battery_status"};
  for (std::uint16_t i = 0; i < 4; ++i) log.subscribe(0, i, names[i]);
  for (const Moment& one : moments) {
    const auto time = static_cast<std::uint64_t>(20e6 + 1e6 * one.t);
    log.data(0, packed(time) + floats(one.w_B) + floats(one.f_B));
    // Published 40 ms after it was measured.
    log.data(1, packed(time + 40'000, time) + floats(one.p_WB) +
                    packed(static_cast<float>(one.q_WB.w()), static_cast<float>(one.q_WB.x()),
                           static_cast<float>(one.q_WB.y()), static_cast<float>(one.q_WB.z())));
    std::string outputs =
        packed(time, std::uint32_t{2}, static_cast<float>(one.pwm[0]), static_cast<float>(one.pwm[1]));
    for (int i = 2; i < 16; ++i) outputs += packed(0.0F);
    log.data(2, outputs);
    log.data(3, packed(time, 16.0F));
  }
  return log.bytes;
}

std::string mcap_of(const std::vector<Moment>& moments) {
  test::McapLog log;
  const std::string rule = "\n" + std::string(80, '=') + "\nMSG: ";
  const std::string header = rule + "std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id";
  const std::string quaternion = rule + "geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w";
  log.schema(1, "sensor_msgs/msg/Imu", "ros2msg",
             "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n"
             "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
             "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance" +
                 header + quaternion + rule + "geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z");
  log.schema(2, "geometry_msgs/msg/PoseStamped", "ros2msg",
             "std_msgs/Header header\nPose pose" + header + rule +
                 "geometry_msgs/Pose\nPoint position\nQuaternion orientation" + rule +
                 "geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z" + quaternion);
  log.schema(3, "mavros_msgs/msg/RCOut", "ros2msg", "std_msgs/Header header\nuint16[] channels" + header);
  log.channel(1, 1, "/imu/data");
  log.channel(2, 2, "/mocap/pose");
  log.channel(3, 3, "/mavros/rc/out");
  const auto add = [](test::CdrMessage& cdr, const Eigen::Vector3d& v) { cdr.add(v.x()).add(v.y()).add(v.z()); };
  const Eigen::Quaterniond flip{Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX())};           // FRD and FLU
  const Eigen::Matrix3d swap = (Eigen::Matrix3d() << 0, 1, 0, 1, 0, 0, 0, 0, -1).finished();  // NED and ENU
  const Eigen::Quaterniond world{swap};
  std::size_t count = 0;
  for (const Moment& one : moments) {
    const double time = 1.6e9 + one.t;
    test::CdrMessage imu, pose, out;
    imu.header(time).add(0.0).add(0.0).add(0.0).add(1.0);
    for (int i = 0; i < 9; ++i) imu.add(i == 0 ? -1.0 : 0.0);
    add(imu, flip * one.w_B);
    for (int i = 0; i < 9; ++i) imu.add(0.0);
    add(imu, flip * one.f_B);
    for (int i = 0; i < 9; ++i) imu.add(0.0);
    pose.header(time, "map");
    add(pose, swap * one.p_WB);
    const Eigen::Quaterniond q = world * one.q_WB * flip;
    pose.add(q.x()).add(q.y()).add(q.z()).add(q.w());
    out.header(time).add(std::uint32_t{2}).add(one.pwm[0]).add(one.pwm[1]);
    log.message(1, time + 0.002, imu.bytes);
    log.message(3, time + 0.003, out.bytes);
    log.message(2, time + 0.060 + 0.01 * static_cast<double>(count % 5), pose.bytes);
    if (++count % 100 == 0) log.chunk();
  }
  log.chunk();
  log.end();
  return log.bytes;
}

}  // namespace

TEST_CASE(
    "fathom: a DataFlash, an ULog and an MCAP log of the same dives go the whole way without an edit, to one result") {
  const Scratch scratch;
  test::write_bytes(scratch.path("v.yaml"), kVehicle);
  const model::Vehicle vehicle = model::Vehicle::load(scratch.path("v.yaml"));
  std::vector<double> masses;
  for (const std::string format : {"BIN", "ulg", "mcap"}) {
    CAPTURE(format);
    const std::string vehicle_option = " --vehicle " + scratch.path("v.yaml");
    std::string logs[2];
    for (unsigned run = 0; run < 2; ++run) {
      const auto dive = test::make_dive(vehicle, {.duration = 60.0, .dt = 0.05, .seed = 11 + run});
      const std::vector<Moment> moments = moments_of(dive.trial, run);
      const std::string file = scratch.path("run" + std::to_string(run + 1) + "." + format);
      test::write_bytes(file, format == "BIN"   ? dataflash_of(moments)
                              : format == "ulg" ? ulog_of(moments)
                                                : mcap_of(moments));
      const std::string map = scratch.path("map.yaml");
      if (run == 0) {
        const Ran described = shell(kTool + " import --describe " + file + " > " + map);
        REQUIRE_MESSAGE(described.code == 0, described.text);
        const std::string text = test::read_bytes(map);
        CHECK(text.find("thrusters:") != std::string::npos);
        CHECK(text.find("# !") == std::string::npos);  // nothing stands against fitting
        if (format == "BIN") {
          CHECK(text.find("pwm: {columns: [RCOU.C1, RCOU.C2], unit: us}") != std::string::npos);
          CHECK(text.find("\ndepth:") == std::string::npos);  // the barometer in the hull
          CHECK(text.find("in a sealed hull: no depth") != std::string::npos);
        }
        if (format == "mcap") CHECK(text.find("80 ms in the middle") != std::string::npos);
      }
      logs[run] = scratch.path("run" + std::to_string(run + 1) + "_" + format + ".lcmlog");
      const Ran imported = shell(kTool + " import " + file + " --map " + map + " --out " + logs[run]);
      REQUIRE_MESSAGE(imported.code == 0, imported.text);
      CHECK(imported.says("THRUSTERS 1199"));
      CHECK(imported.says("POSE_CAPTURE 1199"));
    }
    const Ran checked = shell(kTool + " check " + logs[0] + vehicle_option);
    CHECK_MESSAGE(checked.code == 0, checked.text);
    const Ran diagnosed = shell(kTool + " diagnose" + vehicle_option + " --train " + logs[0] + " --validate " +
                                logs[1] + " --out " + scratch.path("out_" + format));
    REQUIRE_MESSAGE(diagnosed.code == 0, diagnosed.text);
    const auto result = nlohmann::json::parse(test::read_bytes(scratch.path("out_" + format + "/result.json")));
    masses.push_back(result.at("parameters").at("after").at("m_X").at("value").get<double>());
  }
  // Of one dive in three formats: pulses, single precision and stamps in us are all that differ.
  for (const double mass : masses) CHECK(mass == doctest::Approx(masses.front()).epsilon(0.05));
}

TEST_CASE("fathom import: several files of one run on one clock, folders, patterns, and what cannot be") {
  const Scratch scratch;
  test::write_bytes(scratch.path("v.yaml"), kVehicle);
  const auto dive =
      test::make_dive(model::Vehicle::load(scratch.path("v.yaml")), {.duration = 60.0, .dt = 0.05, .seed = 3});
  const std::vector<Moment> moments = moments_of(dive.trial, 1);
  std::filesystem::create_directories(scratch.path("dives"));
  test::write_bytes(scratch.path("dives/pilot.ulg"), ulog_of(moments));
  test::write_bytes(scratch.path("dives/mocap.mcap"), mcap_of(moments));
  const std::string out = " --out " + scratch.path("run.lcmlog");
  const Ran merged =
      shell(kTool + " import " + scratch.path("dives/pilot.ulg") + " " + scratch.path("dives/mocap.mcap") + out);
  REQUIRE_MESSAGE(merged.code == 0, merged.text);
  CHECK(merged.says("are added to its times, by the turn rate"));
  CHECK(merged.says("mocap: pose_capture, ahrs, thrusters left out: pilot has them"));
  const Ran each = shell(kTool + " import '" + scratch.path("dives") + "/*' --out " + scratch.path("all/"));
  REQUIRE_MESSAGE(each.code == 0, each.text);
  CHECK(std::filesystem::exists(scratch.path("all/pilot.lcmlog")));
  CHECK(std::filesystem::exists(scratch.path("all/mocap.lcmlog")));
  CHECK(shell(kTool + " import " + scratch.path("dives") + " --out " + scratch.path("all/")).code == 0);
  const std::string check = kTool + " check --vehicle " + scratch.path("v.yaml") + " '" + scratch.path("all");
  const Ran checked = shell(check + "/*'");
  CHECK_MESSAGE(checked.code == 0, checked.text);
  CHECK(checked.says("would have been seen"));
  CHECK(shell(check + "/*' '" + scratch.path("all") + "/pilot.*'").says("pilot.lcmlog again"));  // it was among them
  std::filesystem::create_directories(scratch.path("more"));
  std::filesystem::copy_file(scratch.path("dives/pilot.ulg"), scratch.path("more/pilot.ulg"));
  const Ran twins = shell(kTool + " import " + scratch.path("dives/pilot.ulg") + " " + scratch.path("more/pilot.ulg") +
                          " --out " + scratch.path("all/"));
  CHECK_MESSAGE(twins.code == 0, twins.text);
  CHECK(std::filesystem::exists(scratch.path("all/more-pilot.lcmlog")));

  // Of each name one run, from the pilot's folder and motion capture's.
  std::filesystem::create_directories(scratch.path("mocap"));
  std::filesystem::copy_file(scratch.path("dives/mocap.mcap"), scratch.path("mocap/pilot.mcap"));
  const std::string by_name =
      kTool + " import --merge " + scratch.path("dives/pilot.ulg") + " " + scratch.path("mocap");
  const Ran joined = shell(by_name + " --out " + scratch.path("joined/"));
  CHECK_MESSAGE(joined.code == 0, joined.text);
  CHECK(joined.says("are added to its times, by the turn rate"));
  CHECK(std::filesystem::exists(scratch.path("joined/pilot.lcmlog")));
  CHECK(shell(by_name + out).says("--out FOLDER/"));

  const auto refused = [&](const std::string& words, const std::string& because) {
    const Ran ran = shell(kTool + " import " + words);
    CAPTURE(ran.text);
    CHECK(ran.code == 1);
    CHECK(ran.says(because));
  };
  refused(scratch.path("none.ulg") + out, "no such file");
  refused("'" + scratch.path("dives") + "/*.bag'" + out, "no file matches");
  refused(scratch.path("dives/pilot.ulg"), "--out is missing");
  refused(scratch.path("all/pilot.lcmlog") + " --out " + scratch.path("all/pilot.lcmlog"), "is read from");
  const std::string pilot = scratch.path("all/pilot.lcmlog"), recorded = test::read_bytes(pilot);
  const Ran over = shell(kTool + " export " + pilot + " --to mcap --out " + pilot);
  CHECK(over.code == 1);
  CHECK_MESSAGE(over.says("is read from"), over.text);
  CHECK(test::read_bytes(pilot) == recorded);
  refused(scratch.path("dives/pilot.ulg") + out + " --shift pilot=nan", "must be NAME=SECONDS");
  test::write_bytes(scratch.path("map.yaml"),
                    "source: s\nlicence: l\nahrs:\n  rates: {columns: ['sensor_combined.gyro_rad[0]', "
                    "'sensor_combined.gyro_rad[1]', 'sensor_combined.gyro_rad[3]'], unit: rad/s, frame: FRD}\n");
  refused(scratch.path("dives/pilot.ulg") + " --map " + scratch.path("map.yaml") + out,
          "map.yaml:3: column 'sensor_combined.gyro_rad[3]'");
  test::write_bytes(scratch.path("empty.ulg"), test::UlogLog{}.bytes);
  refused("--describe " + scratch.path("empty.ulg"), "holds no message");
  test::write_bytes(scratch.path("noise.bin"), std::string("\x01\x00\x02\x00", 4));
  refused(scratch.path("noise.bin") + out, "known are: ArduPilot DataFlash");
}

TEST_CASE("fathom: the tables of a log's channels are the log again, for import and for every command") {
  const Scratch scratch;
  test::write_bytes(scratch.path("v.yaml"), kVehicle);
  const auto dive =
      test::make_dive(model::Vehicle::load(scratch.path("v.yaml")), {.duration = 20.0, .dt = 0.05, .seed = 5});
  test::write_bytes(scratch.path("dive.mcap"), mcap_of(moments_of(dive.trial, 1)));
  const std::string log = scratch.path("dive.lcmlog"), folder = scratch.path("dive_csv"),
                    back = scratch.path("b.lcmlog");
  REQUIRE(shell(kTool + " import " + scratch.path("dive.mcap") + " --out " + log).code == 0);
  REQUIRE(shell(kTool + " export " + log + " --to csv --out " + folder).code == 0);
  for (const std::string& given : {folder, "'" + folder + "/*.csv'"}) {
    const Ran imported = shell(kTool + " import " + given + " --out " + back);
    CHECK_MESSAGE(imported.code == 0, imported.text);
    CHECK(imported.says("POSE_CAPTURE 399"));
    CHECK(test::read_bytes(back) == test::read_bytes(log));
  }
  const std::string check = kTool + " check --vehicle " + scratch.path("v.yaml") + " ";
  const Ran of_log = shell(check + log), of_tables = shell(check + folder);
  CHECK(of_log.code == 0);
  CHECK(of_tables.text == of_log.text);
  CHECK(shell(check + "'" + folder + "/*.csv'").text == of_log.text);
  CHECK(shell(kTool + " import " + folder + " --map " + scratch.path("v.yaml") + " --out " + back)
            .says("which need no --map"));
}

}  // namespace fathom
