// fathom decode says why good frames give no sample; fathom vehicle prints drafts from drawings and frames.
#include <doctest/doctest.h>

#include <string>

#include "common/devices/emulation/emulation.hpp"
#include "test/support/scratch.hpp"
#include "test/support/shell.hpp"

namespace fathom {
namespace {

using test::program;
using test::Ran;
using test::Scratch;
using test::shell;

const std::string kTool = program("fathom");

}  // namespace

TEST_CASE("decode: headings that are empty in every frame are said, and velocities that the log does not trust") {
  const Scratch scratch;
  std::string bytes;
  for (int i = 0; i < 8; ++i) bytes += devices::detail::nmea_sentence("PSXN,23,0.10,-0.42,,-0.03");
  bytes += devices::detail::nmea_sentence("PSXN,20,0,0,0,0");
  test::write_bytes(scratch.path("a.bin"), bytes);
  const Ran headings =
      shell(kTool + " decode nmea_attitude " + scratch.path("a.bin") + " --csv " + scratch.path("a.csv"));
  CAPTURE(headings.text);
  CHECK(headings.code == 0);
  CHECK(headings.says("no sample from 8 of 9 frames: heading field empty and no $--HDT before"));

  devices::Instant now = devices::emulated_motion(1.7e9, 1.0, {});
  std::string velocities = devices::emulate("nortek_ad2cp", now, {});
  now.dvl.valid = false;
  velocities += devices::emulate("nortek_ad2cp", now, {});
  test::write_bytes(scratch.path("b.bin"), velocities);
  const Ran invalid =
      shell(kTool + " decode nortek_ad2cp " + scratch.path("b.bin") + " --csv " + scratch.path("b.csv"));
  CAPTURE(invalid.text);
  CHECK(invalid.says("1 of 2 samples are marked as not valid by the instrument"));
  CHECK_FALSE(invalid.says("no sample from"));
}

TEST_CASE("vehicle: drafts on the command line, one source at a time") {
  const Scratch scratch;
  const Ran frame = shell(kTool + " vehicle --from-ardusub-frame vectored --place 1:0.156,0.111,0.085");
  CAPTURE(frame.text);
  CHECK(frame.code == 0);
  CHECK(frame.says("{name: motor_1, position: 0.156 0.111 0.085 m, axis: -0.707107 0.707107 0}"));
  CHECK(frame.says("{name: motor_2, position: MEASURE m, axis: -0.707107 -0.707107 0}  # ahead, to port"));
  const Ran side = shell(kTool + " vehicle --from-ardusub-frame vectored --place 1:-0.156,-0.111,0.085");
  CHECK(side.code == 1);
  CHECK(side.lines() == 1);
  CHECK(side.says("would yaw the vehicle the other way"));
  const Ran words = shell(kTool + " vehicle --from-ardusub-frame vectored --place 1:0.1,0.1");
  CHECK(words.says("is MOTOR:FORWARD,RIGHT,DOWN in m"));
  CHECK(shell(kTool + " vehicle otter --from-ardusub-frame vectored").says("at a time"));
  CHECK(shell(kTool + " vehicle --place 1:0,0,0").says("goes with --from-ardusub-frame"));
  test::write_bytes(
      scratch.path("boat.urdf"),
      R"(<robot name="boat"><link name="hull"><inertial><mass value="20"/><inertia ixx="1" iyy="2" izz="2.5"/>
                       </inertial></link></robot>)");
  const Ran urdf = shell(kTool + " vehicle --from-urdf " + scratch.path("boat.urdf"));
  CHECK(urdf.code == 0);
  CHECK(urdf.says("# From boat.urdf"));
  CHECK(urdf.says("mass: 20 kg\ninertia: 1 2 2.5 kg m^2"));
  CHECK(shell(kTool + " vehicle --from-sdf " + scratch.path("boat.urdf")).says("is read by --from-urdf"));
}

}  // namespace fathom
