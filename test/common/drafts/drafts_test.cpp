// Vehicle files from SDF, URDF and ArduSub's frames: numbers worked out by hand, and read back as a vehicle.
#include <doctest/doctest.h>

#include <cmath>
#include <fstream>
#include <random>
#include <string>

#include "common/base/error.hpp"
#include "common/drafts/ardusub_frames.hpp"
#include "common/drafts/ardusub_mixer.hpp"
#include "common/drafts/robot.hpp"
#include "common/model/vehicle.hpp"
#include "test/support/scratch.hpp"

using namespace fathom;

namespace {

constexpr double kPrinted = 1e-5;  // six digits of numbers about 1

std::string written(const test::Scratch& scratch, const std::string& name, const std::string& text) {
  const std::string path = scratch.path(name);
  std::ofstream{path} << text;
  return path;
}

model::Vehicle loaded(const test::Scratch& scratch, const drafts::Draft& draft) {
  return model::Vehicle::load(written(scratch, "draft.yaml", drafts::vehicle_file(draft)));
}

bool remarks(const drafts::Draft& draft, const std::string& words) {
  for (const std::string& each : draft.remarks) {
    if (each.find(words) != std::string::npos) return true;
  }
  return false;
}

template <class Call>
std::string refusal(Call&& call) {
  return test::complaint_of<InputError>(call);
}

// A hull of 10 kg whose centre of mass is 0.1 m ahead of its origin, and a battery of 10 kg 0.2 m above the model's
// origin.
constexpr const char* kSdf = R"(<?xml version="1.0"?>
<sdf version="1.9"><model name="Sled">
  <link name="base_link">
    <inertial><pose>0.1 0 0 0 0 0</pose><mass>10</mass>
      <inertia><ixx>0.2</ixx><iyy>0.4</iyy><izz>0.5</izz></inertia></inertial>
  </link>
  <link name="battery"><pose>0.1 0 0.2 0 0 0</pose>
    <inertial><mass>10</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia></inertial>
  </link>
  <link name="left"><pose degrees="true">-0.4 0.3 0 0 0 90</pose><inertial><mass>0</mass></inertial></link>
  <link name="up"><pose relative_to="left">0 0 0.1 0 0 0</pose><inertial><mass>0</mass></inertial></link>
  <link name="mast"/>
  <joint name="left_joint" type="revolute"><parent>base_link</parent><child>left</child>
    <axis><xyz>0 -1 0</xyz></axis></joint>
  <joint name="up_joint" type="revolute"><parent>base_link</parent><child>up</child>
    <axis><xyz expressed_in="__model__">0 0 1</xyz></axis></joint>
  <plugin filename="gz-sim-thruster-system" name="gz::sim::systems::Thruster">
    <joint_name>up_joint</joint_name><fluid_density>1025</fluid_density><max_thrust_cmd>40</max_thrust_cmd></plugin>
  <plugin filename="gz-sim-thruster-system" name="gz::sim::systems::Thruster">
    <joint_name>left_joint</joint_name><max_thrust_cmd>40</max_thrust_cmd></plugin>
</model></sdf>
)";

constexpr const char* kUrdf = R"(<robot name="rov">
  <link name="base"><inertial><origin xyz="0 0 0.05"/><mass value="12"/>
    <inertia ixx="0.3" ixy="0.02" ixz="0" iyy="0.4" iyz="0" izz="0.5"/></inertial></link>
  <link name="thruster_0"/><link name="thruster_1"/>
  <joint name="t1" type="continuous"><origin xyz="-0.2 0.1 0.05" rpy="0 -1.5707963267948966 0"/>
    <parent link="base"/><child link="thruster_1"/><axis xyz="1 0 0"/></joint>
  <joint name="t0" type="continuous"><origin xyz="-0.3 -0.2 0.05" rpy="0 0 0.7853981633974483"/>
    <parent link="base"/><child link="thruster_0"/></joint>
  <gazebo><plugin name="m1" filename="libuuv_thruster_ros_plugin.so"><linkName>thruster_1</linkName>
    <thrusterID>1</thrusterID></plugin></gazebo>
  <gazebo><plugin name="m0" filename="libuuv_thruster_ros_plugin.so"><jointName>t0</jointName>
    <thrusterID>0</thrusterID></plugin></gazebo>
</robot>
)";

}  // namespace

TEST_CASE("drafts: a model of Gazebo becomes a vehicle about its centre of mass") {
  const test::Scratch scratch;
  const drafts::Draft draft = drafts::draft_of(drafts::read_sdf(written(scratch, "sled.sdf", kSdf)), "sled.sdf");
  const model::Vehicle vehicle = loaded(scratch, draft);
  CHECK(vehicle.name == "Sled");
  CHECK(vehicle.mass == doctest::Approx(20.0));
  // Centre of mass: forward 0.1, up 0.1. Each half is 0.1 m from it along the vertical: 2 * 10 * 0.01 about x and y.
  CHECK(vehicle.inertia.isApprox(Eigen::Vector3d{0.2 + 0.1 + 0.2, 0.4 + 0.1 + 0.2, 0.6}, kPrinted));
  CHECK(vehicle.water_density == 1025.0);
  CHECK(vehicle.largest_thrust == 40.0);
  REQUIRE(vehicle.thrusters.size() == 2);
  CHECK(vehicle.thrusters[0].name == "up_joint");
  CHECK(vehicle.thrusters[0].axis_B.isApprox(Eigen::Vector3d{0.0, 0.0, -1.0}, kPrinted));  // up
  CHECK(vehicle.thrusters[0].p_BJ.isApprox(Eigen::Vector3d{-0.5, -0.3, 0.0}, kPrinted));  // port, level with the centre
  // A quarter turn to port makes the link's -y the model's x.
  CHECK(vehicle.thrusters[1].axis_B.isApprox(Eigen::Vector3d{1.0, 0.0, 0.0}, kPrinted));
  CHECK(vehicle.thrusters[1].p_BJ.isApprox(Eigen::Vector3d{-0.5, -0.3, 0.1}, kPrinted));
  CHECK(remarks(draft, "0.1 0 -0.1 m"));              // where the origin went
  CHECK(remarks(draft, "Link mast states no mass"));  // SDF would count a kilogram
  CHECK(remarks(draft, "in the order of the file"));
}

TEST_CASE("drafts: a URDF's thrusters by number, with their links' own axes") {
  const test::Scratch scratch;
  const drafts::Draft draft = drafts::draft_of(drafts::read_urdf(written(scratch, "rov.urdf", kUrdf)), "rov.urdf");
  const model::Vehicle vehicle = loaded(scratch, draft);
  CHECK(vehicle.mass == doctest::Approx(12.0));
  CHECK(vehicle.inertia.isApprox(Eigen::Vector3d{0.3, 0.4, 0.5}, kPrinted));
  REQUIRE(vehicle.thrusters.size() == 2);
  CHECK(vehicle.thrusters[0].name == "t0");
  CHECK(vehicle.thrusters[0].p_BJ.isApprox(Eigen::Vector3d{-0.3, 0.2, 0.0}, kPrinted));
  const double r = std::sqrt(0.5);
  CHECK(vehicle.thrusters[0].axis_B.isApprox(Eigen::Vector3d{r, -r, 0.0}, kPrinted));      // ahead and to port
  CHECK(vehicle.thrusters[1].axis_B.isApprox(Eigen::Vector3d{0.0, 0.0, -1.0}, kPrinted));  // nose up: x points up
  CHECK(remarks(draft, "Products of inertia up to 0.02"));
  CHECK_FALSE(remarks(draft, "in the order of the file"));
}

TEST_CASE("drafts: thrusters by their names where no plugin tells, and a body without any") {
  const test::Scratch scratch;
  std::string plain = kUrdf;
  while (plain.find("<gazebo>") != std::string::npos) {
    plain.erase(plain.find("<gazebo>"), plain.find("</gazebo>") + 9 - plain.find("<gazebo>"));
  }
  const drafts::Draft named = drafts::draft_of(drafts::read_urdf(written(scratch, "a.urdf", plain)), "a.urdf");
  CHECK(named.thrusters.size() == 2);
  CHECK(remarks(named, "No thruster plugin is in the file"));
  const drafts::Draft bare = drafts::draft_of(
      drafts::read_urdf(
          written(scratch, "b.urdf",
                  R"(<robot name="r"><link name="l"><inertial><mass value="3"/><inertia ixx="1" iyy="1" izz="1"/>
                                </inertial></link></robot>)")),
      "b.urdf");
  CHECK(remarks(bare, "No thruster is in the file"));
  CHECK_FALSE(loaded(scratch, bare).has_thrusters());
}

TEST_CASE("drafts: what is wrong in a drawing is said with file, line and remedy") {
  const test::Scratch scratch;
  const auto sdf = [&](const std::string& text) {
    return refusal([&] { (void)drafts::draft_of(drafts::read_sdf(written(scratch, "x.sdf", text)), "x.sdf"); });
  };
  const auto urdf = [&](const std::string& text) {
    return refusal([&] { (void)drafts::draft_of(drafts::read_urdf(written(scratch, "x.urdf", text)), "x.urdf"); });
  };
  CHECK(sdf("<sdf><model name='a'>").find("x.sdf:") != std::string::npos);
  CHECK(sdf("").find("is no XML") != std::string::npos);
  CHECK(sdf(kUrdf).find("is read by --from-urdf") != std::string::npos);
  CHECK(urdf(kSdf).find("is read by --from-sdf") != std::string::npos);
  CHECK(urdf("<robot name='r'><xacro:include filename='x'/></robot>").find("xacro FILE") != std::string::npos);
  CHECK(sdf("<sdf><model name='a'>\n<link name='l'><pose>0 0 zero 0 0 0</pose></link></model></sdf>")
            .find("x.sdf:2: 'zero' in <pose>") != std::string::npos);
  CHECK(sdf("<sdf><model name='a'><link name='l'><pose>0 0 0</pose></link></model></sdf>")
            .find("needs 6 numbers, not 3") != std::string::npos);
  CHECK(sdf("<sdf><model name='a'><link name='l'><pose relative_to='m'>0 0 0 0 0 0</pose></link><link name='m'>"
            "<pose relative_to='l'>0 0 0 0 0 0</pose></link></model></sdf>")
            .find("in a circle") != std::string::npos);
  CHECK(sdf("<sdf><model name='a'><link name='l'/><plugin "
            "name='Thruster'><joint_name>j</joint_name></plugin></model></sdf>")
            .find("drives the joint 'j', which is not there") != std::string::npos);
  CHECK(urdf("<robot name='r'><link name='a'/><link name='b'/><joint name='j'><parent link='b'/><child "
             "link='b'/></joint></robot>")
            .find("hangs on no link of the tree") != std::string::npos);
  CHECK(refusal([] { (void)drafts::read_sdf("nowhere.sdf"); }).find("cannot be read") != std::string::npos);
}

TEST_CASE("drafts: ArduSub's heavy frame agrees with the BlueROV2 Heavy that comes with Fathom") {
  const test::Scratch scratch;
  const model::Vehicle ours =
      model::Vehicle::load(std::string{FATHOM_SOURCE_DIR} + "/config/vehicles/bluerov2_heavy.yaml");
  std::map<int, Eigen::Vector3d> places;
  for (std::size_t i = 0; i < ours.thrusters.size(); ++i) places[static_cast<int>(i) + 1] = ours.thrusters[i].p_BJ;
  drafts::Draft draft = drafts::draft_of_frame("vectored-6dof", places);
  CHECK(drafts::vehicle_file(draft).find("mass: MEASURE kg") != std::string::npos);
  CHECK(refusal([&] { (void)loaded(scratch, draft); }).find("mass") !=
        std::string::npos);  // nothing measured is made up
  draft.mass = 13.5;
  const model::Vehicle vehicle = loaded(scratch, draft);
  REQUIRE(vehicle.thrusters.size() == 8);
  CHECK((vehicle.allocation - ours.allocation).cwiseAbs().maxCoeff() < 1e-3);
}

TEST_CASE("drafts: each frame pushes as its factors say, at places on the side that they name") {
  for (const drafts::ArdusubFrame& frame : drafts::ardusub_frames()) {
    CAPTURE(frame.name);
    const drafts::Draft draft = drafts::draft_of_frame(std::string{frame.name}, {});
    REQUIRE(draft.thrusters.size() == frame.motors.size());
    std::map<int, Eigen::Vector3d> places;
    for (std::size_t i = 0; i < frame.motors.size(); ++i) {
      const drafts::FrameMotor& motor = frame.motors[i];
      const drafts::DraftThruster& thruster = draft.thrusters[i];
      CHECK_FALSE(thruster.p_BJ);
      CHECK(thruster.axis_B.norm() == doctest::Approx(1.0));
      CHECK(thruster.axis_B.x() * motor.forward >= 0.0);
      CHECK(thruster.axis_B.y() * motor.lateral >= 0.0);
      CHECK(thruster.axis_B.z() * motor.throttle <= 0.0);  // up is against z
      const auto side = [&](const char* positive, const char* negative) {
        if (thruster.note.find(positive) != std::string::npos) return 1.0;
        return thruster.note.find(negative) != std::string::npos ? -1.0 : 0.0;
      };
      places[static_cast<int>(i) + 1] = {0.2 * side("ahead", "astern"), 0.1 * side("to starboard", "to port"),
                                         0.05 * side("below", "above")};
    }
    CHECK_NOTHROW((void)drafts::draft_of_frame(std::string{frame.name}, places));
  }
  CHECK(drafts::draft_of_frame("bluerov1", {}).thrusters[2].note == "ahead, to starboard");
  CHECK(drafts::draft_of_frame("vectored", {}).thrusters[3].note == "astern, to port");
}

TEST_CASE("drafts: a place that contradicts the frame, a motor and a frame that are not there") {
  const auto said = [](const std::string& frame, const std::map<int, Eigen::Vector3d>& places) {
    return refusal([&] { (void)drafts::draft_of_frame(frame, places); });
  };
  CHECK(said("vectored-6dof", {{5, {0.12, -0.22, 0.0}}}).find("would roll the vehicle the other way") !=
        std::string::npos);
  CHECK(said("vectored-6dof", {{1, {-0.15, -0.11, 0.0}}}).find("ahead, to starboard") != std::string::npos);
  CHECK(said("vectored", {{7, {0.0, 0.0, 0.0}}}).find("has motors 1 to 6") != std::string::npos);
  CHECK(said("vectored6dof", {}).find("did you mean vectored-6dof") != std::string::npos);
}

TEST_CASE("mixer: one stick alone gives each motor its factor, whatever the frame") {
  for (const drafts::ArdusubFrame& frame : drafts::ardusub_frames()) {
    CAPTURE(frame.name);
    const drafts::ArdusubMixer mixer{std::string{frame.name}, 1.0, {}};
    std::vector<double> commands(mixer.motors());
    const auto expect = [&](const drafts::Sticks& sticks, double drafts::FrameMotor::*factor) {
      mixer.mix(sticks, commands);
      for (std::size_t i = 0; i < commands.size(); ++i)
        CHECK(commands[i] == doctest::Approx(0.5 * frame.motors[i].*factor));
    };
    expect({.roll = 0.5}, &drafts::FrameMotor::roll);
    expect({.pitch = 0.5}, &drafts::FrameMotor::pitch);
    expect({.yaw = 0.5}, &drafts::FrameMotor::yaw);
    expect({.throttle = 0.5}, &drafts::FrameMotor::throttle);
    expect({.forward = 0.5}, &drafts::FrameMotor::forward);
    expect({.lateral = 0.5}, &drafts::FrameMotor::lateral);
  }
}

TEST_CASE("mixer: more than full is shared in the heavy frame, cut in the others, held back where water is drawn off") {
  std::vector<double> eight(8), six(6);
  drafts::ArdusubMixer{"vectored-6dof", 1.0, {}}.mix({.roll = 1.0, .throttle = 1.0, .forward = 1.0}, eight);
  // Motors 6 and 8 would get -2: all vertical ones are halved; 5 and 7 get none. The horizontal ones keep theirs.
  CHECK(eight == std::vector<double>{-1, -1, 1, 1, 0, -1, 0, -1});
  drafts::ArdusubMixer{"vectored-6dof", 1.0, {}}.mix({.yaw = 1.0, .forward = 1.0}, eight);
  CHECK(eight == std::vector<double>{0, -1, 0, 1, 0, 0, 0, 0});
  // Ahead while going up by half: motors 3 and 4, which push ahead, are held to 1 - 1.2 / 2.
  drafts::ArdusubMixer{"vectored", 1.2, {}}.mix({.throttle = 0.5, .forward = 1.0}, six);
  CHECK(six[0] == -1.0);
  CHECK(six[2] == doctest::Approx(0.4));
  CHECK(six[4] == -0.5);
  drafts::ArdusubMixer{"vectored", 0.0, {}}.mix({.throttle = 0.5, .forward = 1.0}, six);
  CHECK(six[2] == 1.0);
}

TEST_CASE("drafts: a damaged drawing is refused in one line or read, and what is read has no number that is none") {
  const test::Scratch scratch;
  std::mt19937 random{4};
  int refused = 0, read = 0;
  for (int round = 0; round < 600; ++round) {
    std::string text = round % 2 == 0 ? kSdf : kUrdf;
    for (int k = 0; k < 1 + round % 3; ++k) {
      const std::size_t at = random() % text.size();
      if (random() % 2 == 0) {
        text[at] = static_cast<char>(random() & 0xFF);
      } else {
        text.erase(at, random() % 20);
      }
    }
    const std::string path = written(scratch, "damaged.xml", text);
    try {
      const drafts::Draft draft =
          drafts::draft_of(round % 2 == 0 ? drafts::read_sdf(path) : drafts::read_urdf(path), "it");
      for (const drafts::DraftThruster& each : draft.thrusters)
        CHECK((each.p_BJ->allFinite() && each.axis_B.allFinite()));
      if (draft.mass) CHECK((std::isfinite(*draft.mass) && *draft.mass > 0.0));
      ++read;
    } catch (const InputError& error) {
      CHECK(std::string{error.what()}.find('\n') == std::string::npos);
      ++refused;
    }
  }
  CHECK(refused > 50);
  CHECK(read > 50);
}
