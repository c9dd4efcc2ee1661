// Trials by the offline tool: a recorded manoeuvre smoothed, regressed, and its derivatives flown again.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "common/wire/log_reader.hpp"
#include "common/wire/log_writer.hpp"
#include "test/support/offline_tool.hpp"
#include "test/support/scratch.hpp"
#include "test/support/shell.hpp"
#include "test/support/timing.hpp"
#include "test/support/trial_recording.hpp"
#include "test/support/virtual_dive.hpp"

namespace fathom {
namespace {

using test::file;
using test::program;
using test::Scratch;
using test::shell;

const std::string kVehicle = file("config/vehicles/pap104_half.yaml");
const std::string kPipeline = file("config/pipelines/pap104_half.yaml");

test::TrialRecording zigzag() {
  model::Manoeuvre manoeuvre{.kind = model::ManoeuvreKind::kZigzag, .duration = 60.0, .difference = 4.5};
  return test::record_trial(test::vehicle_from_repository("pap104_half"),
                            test::instruments_from_repository("pap104_half"), {.manoeuvre = manoeuvre});
}

}  // namespace

TEST_CASE("fathom smooth, regress and compare --manoeuvre: from a log to derivatives that fly") {
  const Scratch scratch;
  const auto trial = zigzag();
  wire::write_log(trial.recording, scratch.path("zigzag.lcmlog"));
  const auto smoothed = shell(program("fathom") + " smooth " + scratch.path("zigzag.lcmlog") + " --out " +
                              scratch.path("smooth.lcmlog") + " --config " + kPipeline);
  REQUIRE_MESSAGE(smoothed.code == 0, smoothed.text);
  CHECK_MESSAGE(smoothed.says("noises from"), smoothed.text);
  CHECK_MESSAGE(smoothed.says("most probable process noise"), smoothed.text);
  const Recording result = wire::read_log(scratch.path("smooth.lcmlog")).recording;
  CHECK(result.smoothed.size() == trial.flight.size());
  CHECK(result.loads.size() == trial.recording.loads.size());

  const auto regressed = shell(program("fathom") + " regress " + scratch.path("smooth.lcmlog") + " --vehicle " +
                               kVehicle + " --write " + scratch.path("found.yaml") + " --json " +
                               scratch.path("found.json") + " --page " + scratch.path("found.html"));
  REQUIRE_MESSAGE(regressed.code == 0, regressed.text);
  std::ifstream file{scratch.path("found.html")};
  const std::string page{std::istreambuf_iterator<char>{file}, {}};
  CHECK(page.find("selected derivatives stand</div>") != std::string::npos);
  CHECK(page.find("X, surge") != std::string::npos);
  CHECK(page.find("</html>") != std::string::npos);
  std::ifstream told{scratch.path("found.json")};
  const auto json = nlohmann::json::parse(told);
  CHECK(json.at("axes").size() == 6);
  CHECK(json.at("axes")[0].at("together").at("terms").size() > 0);
  const auto& known = json.at("axes")[0].at("reference")[0];  // X_uu: -0.012, 4.2 %
  CHECK(known.at("std").get<double>() == doctest::Approx(0.042 * 0.012));
  CHECK(json.at("axes")[0].at("manoeuvres")[0].at("name") == "smooth");
  CHECK_MESSAGE(regressed.says("X_uu"), regressed.text);
  CHECK_MESSAGE(regressed.says("forces from load cells"), regressed.text);
  CHECK_MESSAGE(regressed.says("N_ur"), regressed.text);
  const auto at_once = shell(program("fathom") + " regress " + scratch.path("zigzag.lcmlog") + " --vehicle " +
                             kVehicle + " --config " + kPipeline + " --write " + scratch.path("once.yaml"));
  REQUIRE_MESSAGE(at_once.code == 0, at_once.text);
  CHECK_MESSAGE(at_once.says("smoothed first"), at_once.text);
  CHECK(test::read_bytes(scratch.path("once.yaml")) == test::read_bytes(scratch.path("found.yaml")));

  const auto compared = shell(program("fathom") + " compare " + kVehicle + " " + kVehicle + " --manoeuvre circle");
  REQUIRE_MESSAGE(compared.code == 0, compared.text);
  CHECK_MESSAGE(compared.says("largest: 0.00 m"), compared.text);
  const auto drawn = shell(program("fathom") + " compare " + kVehicle + " " + scratch.path("found.yaml") +
                           " --manoeuvre zigzag --plot " + scratch.path("tracks.svg"));
  REQUIRE_MESSAGE(drawn.code == 0, drawn.text);
  std::ifstream svg{scratch.path("tracks.svg")};
  const std::string picture{std::istreambuf_iterator<char>{svg}, {}};
  CHECK(picture.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\""));  // without it no viewer shows the file
  CHECK(picture.find("found.yaml") != std::string::npos);                   // which line is whose
}

TEST_CASE("fathom smooth, regress and compare --manoeuvre: what is wrong is said in one line") {
  const Scratch scratch;
  const auto trial = zigzag();
  wire::write_log(trial.recording, scratch.path("zigzag.lcmlog"));
  const auto raw = shell(program("fathom") + " regress " + scratch.path("zigzag.lcmlog") + " --vehicle " + kVehicle);
  CHECK(raw.code == 1);
  CHECK_MESSAGE(raw.says("zigzag: no SMOOTHED in it; smoothed first"), raw.text);
  CHECK_MESSAGE(raw.says("nothing that is known tells the position"), raw.text);
  const auto bare =
      shell(program("fathom") + " smooth " + scratch.path("zigzag.lcmlog") + " --out " + scratch.path("x.lcmlog"));
  CHECK_MESSAGE(bare.says("RANGES are not used"), bare.text);
  CHECK(bare.code == 1);
  CHECK_MESSAGE(bare.says("nothing that is known tells the position"), bare.text);
  const auto drifting = shell(program("fathom") + " smooth " + scratch.path("zigzag.lcmlog") + " --out " +
                              scratch.path("x.lcmlog") + " --without-position");
  CHECK_MESSAGE(drifting.code == 0, drifting.text);
  const auto itself =
      shell(program("fathom") + " smooth " + scratch.path("zigzag.lcmlog") + " --out " + scratch.path("zigzag.lcmlog"));
  CHECK(itself.code == 1);
  CHECK_MESSAGE(itself.says("--out is the run itself"), itself.text);
  const auto nothing =
      shell(program("fathom") + " regress " + scratch.path("x.lcmlog") + " --rate 0.1 --vehicle " + kVehicle);
  CHECK(nothing.code == 1);
  CHECK_MESSAGE(nothing.says("regression needs 20 at least"), nothing.text);
  const auto thresholds = shell(program("fathom") + " regress " + scratch.path("zigzag.lcmlog") +
                                " --f-in 2 --f-out 4 --vehicle " + kVehicle);
  CHECK(thresholds.code == 1);
  CHECK_MESSAGE(thresholds.says("--f-out must not exceed --f-in"), thresholds.text);
  CHECK_FALSE_MESSAGE(thresholds.says("smoothed first"), thresholds.text);  // told before anything is smoothed
  const auto unknown = shell(program("fathom") + " compare " + kVehicle + " " + kVehicle + " --manoeuvre loop");
  CHECK(unknown.code == 1);
  CHECK_MESSAGE(unknown.says("'loop' is no manoeuvre: line, zigzag, circle"), unknown.text);
  std::ofstream{scratch.path("bad.yaml")} << "coefficients: {X_uuu: 1}\n";
  const auto bad =
      shell(program("fathom") + " compare " + kVehicle + " " + scratch.path("bad.yaml") + " --manoeuvre line");
  CHECK(bad.code == 1);
  CHECK_MESSAGE(bad.says("'X_uuu' is no coefficient of gertler_submarine"), bad.text);
}

TEST_CASE("fathom smooth and regress: an instrument of which more is refused than outliers are is named by both") {
  const Scratch scratch;
  auto trial = zigzag();
  // After the rest at the start, from which noises are estimated: 167 of 601.
  for (std::size_t k = 100; k < trial.recording.depth.size(); k += 3) trial.recording.depth[k].z += 5.0;
  wire::write_log(trial.recording, scratch.path("zigzag.lcmlog"));
  const std::string run = scratch.path("zigzag.lcmlog") + " --config " + kPipeline;
  for (const std::string& line :
       {"smooth " + run + " --out " + scratch.path("x.lcmlog"), "regress " + run + " --vehicle " + kVehicle}) {
    const auto ran = shell(program("fathom") + " " + line);
    CHECK_MESSAGE(ran.code == 0, ran.text);
    CHECK_MESSAGE(ran.says("zigzag: depth: 28 % refused; its noise is stated too small"), ran.text);
  }
}

TEST_CASE("fathom compare --manoeuvre: craft that steer by rudders turn as their published sets say") {
  const test::Scratch scratch;
  const std::string vehicles = std::string{FATHOM_SOURCE_DIR} + "/config/vehicles/";
  const std::string compare = program("fathom") + " compare " + vehicles + "kvlcc2_l3.yaml ";
  test::write_bytes(scratch.path("sway.yaml"), "coefficients: {Y_v: -0.25}\n");
  const auto turned = shell(compare + scratch.path("sway.yaml") + " --over --manoeuvre circle --rudder 35");
  REQUIRE_MESSAGE(turned.code == 0, turned.text);
  CHECK_MESSAGE(turned.says("rudder at 35 deg, each from its cruising speed"), turned.text);
  CHECK_MESSAGE(turned.says("tactical diameter"), turned.text);
  CHECK_MESSAGE(!turned.says("largest: 0.00 m"), turned.text);
  const auto swung = shell(compare + vehicles + "kvlcc2_l3.yaml --manoeuvre zigzag --rudder 10");
  REQUIRE_MESSAGE(swung.code == 0, swung.text);
  CHECK_MESSAGE(swung.says("overshoot of heading"), swung.text);
  test::one_line(shell(compare + kVehicle + " --manoeuvre circle"), 1, "one of the two steers by a rudder");
  test::write_bytes(scratch.path("gertler.yaml"), "coefficients: {Y_vw: -0.3}\n");
  test::one_line(shell(compare + scratch.path("gertler.yaml") + " --manoeuvre circle"), 1,
                 "'Y_vw' is no coefficient of mmg_3");
  const std::string glider = vehicles + "slocum.yaml ";
  test::one_line(shell(program("fathom") + " compare " + glider + glider + "--manoeuvre circle"), 1,
                 "flown with two thrusters, or with a rudder");
}

TEST_CASE("fathom compare --manoeuvre: the paper's tables are flown, and what diverges says when, where and by what") {
  const auto set = [](const char* name) { return file(std::string{"config/coefficients/pap104_"} + name + ".yaml"); };
  const std::string compare = program("fathom") + " compare ";
  // The reference of the tables, over what the vehicle file assumes: a set that flies.
  const auto over = shell(compare + kVehicle + " " + set("pmm") + " --over --manoeuvre circle");
  CHECK_MESSAGE(over.code == 0, over.text);
  CHECK_MESSAGE(!over.says("diverges"), over.text);
  // What the line alone identified has no drag at all, and K_vq of another size than the hull's.
  const auto alone = shell(compare + set("line") + " " + set("pmm") + " --manoeuvre zigzag --vehicle " + kVehicle);
  CHECK_MESSAGE(alone.code == 0, alone.text);
  CHECK_MESSAGE(alone.says("pap104_line.yaml diverges at "), alone.text);
  CHECK_MESSAGE(alone.says(" along p "), alone.text);
  CHECK_MESSAGE(alone.says("driven by K_vq"), alone.text);
  for (const char* name : {"circle", "zigzag"}) {
    const auto flown = shell(compare + kVehicle + " " + set(name) + " --over --manoeuvre " + name);
    CHECK_MESSAGE(flown.code == 0, flown.text);
    CHECK_MESSAGE(flown.says("difference, largest"), flown.text);
  }
  const auto homeless = shell(compare + set("line") + " " + set("pmm") + " --manoeuvre line");
  CHECK(homeless.code == 1);
  CHECK_MESSAGE(homeless.says("coefficients alone; name the vehicle that they are for (--vehicle)"), homeless.text);
}

TEST_CASE("fathom methods: both methods on the same recording, judged on another") {
  const Scratch scratch;
  std::ifstream from{std::string{FATHOM_SOURCE_DIR} + "/test/data/beluga/surge-1.csv"};
  std::ofstream first{scratch.path("first.csv")}, second{scratch.path("second.csv")};
  std::string line;
  for (int i = 0; i < 2000 && std::getline(from, line); ++i) {
    if (i == 0 || i <= 1000) first << line << "\n";
    if (i == 0 || i > 1000) second << line << "\n";
  }
  first.close();
  second.close();
  const auto ran =
      shell(program("fathom") + " methods --vehicle " + file("config/vehicles/beluga.yaml") + " --config " +
            file("config/pipelines/beluga.yaml") + " --map " + file("config/maps/beluga.yaml") + " --train " +
            scratch.path("first.csv") + " --validate " + scratch.path("second.csv"));
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  CHECK_MESSAGE(ran.says("complementary filter, recursive"), ran.text);
  CHECK_MESSAGE(ran.says("smoother, regression under AR(1)"), ran.text);
  CHECK_MESSAGE(ran.says("m_X"), ran.text);
}

TEST_CASE("fathom methods: against a truth it tells what each estimate was worth, and what each set of parameters") {
  const Scratch scratch;
  const auto dive =
      test::make_dive(test::vehicle_from_repository("seabotix_lbv150"), {.duration = 60.0, .dt = 0.05, .spread = 0.0});
  Recording recording;
  for (std::size_t k = 0; k < dive.trial.size(); ++k) {
    const Utime utime = utime_after(1'700'000'000'000'000, dive.trial.t[k]);
    const Vector6d& nu = dive.trial.nu[k];
    recording.ahrs.push_back({.utime = utime, .w_WB_B = nu.tail<3>(), .has_rates = true});
    recording.pose_capture.push_back({.utime = utime, .p_WB = dive.trial.p_WB[k], .q_WB = dive.trial.q_WB[k]});
    recording.dvl.push_back({.utime = utime, .v_WB_B = nu.head<3>()});
    const Eigen::VectorXd& f = dive.trial.input[k];
    recording.thrusters.push_back({.utime = utime, .force = {f.data(), f.data() + f.size()}});
    recording.truth.push_back({.utime = utime, .p_WB = dive.trial.p_WB[k], .q_WB = dive.trial.q_WB[k], .nu = nu});
  }
  wire::write_log(recording, scratch.path("dive.lcmlog"));
  const auto ran =
      shell(program("fathom") + " methods --vehicle " + file("config/vehicles/seabotix_lbv150.yaml") + " --config " +
            file("test/trials/dives.yaml") + " --truth --train " + scratch.path("dive.lcmlog"));
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  for (const char* row : {"complementary filter", "Kalman filter", "Kalman smoother", "parameter error"}) {
    CHECK_MESSAGE(ran.says(row), ran.text);
  }
}

TEST_CASE("scripts/pap104: three manoeuvres flown, smoothed, drawn and regressed, on one page") {
  if (shell("unshare -rn ip link set lo up").code != 0) {
    MESSAGE("skipped: this machine allows no private network (unshare -rn)");
    return;
  }
  const Scratch scratch;
  const auto ran = shell("FATHOM_BIN='" + std::string{FATHOM_BINARY_DIR} + "/bin' " + file("scripts/pap104") + " " +
                         scratch.path("out") + " 3");
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  const auto text = [&](const std::string& name) {
    std::ifstream from{scratch.path("out/" + name)};
    return std::string{std::istreambuf_iterator<char>{from}, {}};
  };
  const std::string report = text("report.html");
  for (const char* told : {"X, surge", "-0.0120 ± 0.00099",  // reference of X_uu, 4.2 %
                           "The umbilical on M: residual had it not been measured", "<h2>line</h2>", "<h2>zigzag</h2>",
                           "<h2>circle</h2>", "degrees ahead of U"})
    CHECK_MESSAGE(report.find(told) != std::string::npos, told);
  for (const std::string told : {"which the filter never saw", "How its instruments fared", "crosses filter",
                                 "6. Derivative of v in the body: line smoother, dashed truth."}) {
    std::size_t times = 0;
    for (auto at = report.find(told); at != std::string::npos; at = report.find(told, at + 1)) ++times;
    CHECK_MESSAGE(times >= 3, told);  // of line, zigzag and circle each
  }
  CHECK(text("derivatives.txt").find("X (surge): dimensionless") != std::string::npos);
}

TEST_CASE("fathom smooth: a table with a column map, whose instruments are compared where they contradict each other") {
  for (const char* run : {"yaw-1", "random-2"}) {
    CAPTURE(run);
    const Scratch scratch;
    const auto ran = shell(program("fathom") + " smooth " + file(std::string{"test/data/beluga/"} + run + ".csv") +
                           " --map " + file("config/maps/beluga.yaml") + " --out " + scratch.path("run.lcmlog"));
    REQUIRE_MESSAGE(ran.code == 0, ran.text);
    CHECK_MESSAGE(ran.says("pose position"), ran.text);
    // Capture and gyro are turned against each other, and their clocks differ.
    CHECK_MESSAGE(ran.says("once more with what the comparison of sensors corrects"), ran.text);
    CHECK_MESSAGE(ran.says("(delay)"), ran.text);
    CHECK_FALSE_MESSAGE(ran.says("refused; its noise is stated too small"), ran.text);
    const Recording after = wire::read_log(scratch.path("run.lcmlog")).recording;
    CHECK(after.smoothed.size() > 1000);
  }
}

TEST_CASE("estimator: with `filter: ekf` it gives STATE from ranges, twice the same bytes") {
  const Scratch scratch;
  const auto trial = zigzag();
  wire::write_log(trial.recording, scratch.path("zigzag.lcmlog"));
  for (const std::string turn : {"1", "2"}) {
    const auto ran = shell(program("estimator") + " --log-level warning --config " + kPipeline + " --in file://" +
                           scratch.path("zigzag.lcmlog") + " --out file://" + scratch.path("state" + turn + ".lcmlog"));
    REQUIRE_MESSAGE(ran.code == 0, ran.text);
  }
  const Recording first = wire::read_log(scratch.path("state1.lcmlog")).recording;
  const Recording second = wire::read_log(scratch.path("state2.lcmlog")).recording;
  REQUIRE(first.state.size() > 2900);
  REQUIRE(second.state.size() == first.state.size());
  const StateEstimate &a = first.state.back(), &b = second.state.back();
  CHECK(a.p_WB == b.p_WB);
  CHECK((a.p_WB - trial.flight.back().p_WB).norm() < 0.6);  // m: filtered from ranges of 10 cm
  CHECK(a.valid);
}

TEST_CASE("simulator --manoeuvre: a circle on every channel, an estimator on line, and a log that can be smoothed") {
  if (shell("unshare -rn ip link set lo up").code != 0) {
    MESSAGE("skipped: this machine allows no private network (unshare -rn)");
    return;
  }
  const Scratch scratch;
  const std::string where = " --config " + file("config/sites/pap104_half.yaml");
  const std::string fly = program("simulator") + " --config " + kVehicle + where + " --config " +
                          file("config/simulation/pap104_half.yaml") + " --config " +
                          file("config/operators/simulated.yaml") + " --out-dir " + scratch.path("truth");
  const auto on_network = [](const std::string& script) {
    return shell(test::limit(60) +
                 "unshare -rn sh -c \"ip link set lo up; ip route add 224.0.0.0/4 dev lo; "
                 "export LCM_DEFAULT_URL='udpm://239.255.76.67:7667?ttl=0'\n" +
                 script + "\"");
  };
  const auto ran = on_network(program("recorder") + " --lockstep --file " + scratch.path("circle.lcmlog") + " &\n" +
                              program("estimator") + " --lockstep --config " + kPipeline + " --config " + kVehicle +
                              where + " --config " + file("config/corrections/none.yaml") + " &\n" + fly +
                              " --manoeuvre circle --seed 3 --speed 0 --wait-for recorder,estimator\ncode=\\$?\nwait\n"
                              "exit \\$code");
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  const Recording flown = wire::read_log(scratch.path("circle.lcmlog")).recording;
  CHECK(flown.ahrs.size() == doctest::Approx(50 * 95).epsilon(0.01));
  CHECK(flown.ranges.size() == doctest::Approx(95).epsilon(0.02));
  CHECK(flown.depth.size() == doctest::Approx(950).epsilon(0.01));
  REQUIRE(flown.loads.size() > 4700);
  CHECK(flown.loads.front().load.size() == 8);
  REQUIRE(flown.truth.size() > 4700);
  // The estimator's filter, on line, beside the truth that nobody heard.
  REQUIRE(flown.state.size() > 1000);
  const StateEstimate& last = flown.state.back();
  CHECK((last.p_WB - flown.truth.back().p_WB).norm() < 0.5);

  const auto smoothed = shell(program("fathom") + " smooth " + scratch.path("circle.lcmlog") + " --out " +
                              scratch.path("smooth.lcmlog") + " --config " + kPipeline);
  REQUIRE_MESSAGE(smoothed.code == 0, smoothed.text);
  const Recording result = wire::read_log(scratch.path("smooth.lcmlog")).recording;
  REQUIRE(result.smoothed.size() == flown.ahrs.size());
  double square = 0.0, n = 0.0;
  for (const SmoothedState& one : result.smoothed) {
    const auto truth = std::find_if(flown.truth.begin(), flown.truth.end(),
                                    [&](const Truth& each) { return each.utime == one.utime; });
    if (truth == flown.truth.end()) continue;
    square += (one.p_WB - truth->p_WB).squaredNorm();
    n += 1.0;
  }
  REQUIRE(n > 4000.0);
  CHECK(std::sqrt(square / n) < 0.15);  // m

  const auto wrong =
      shell(program("simulator") + " --config " + file("config/vehicles/seabotix_lbv150.yaml") + " --config " +
            file("config/sites/deep.yaml") + " --config " + file("config/simulation/seabotix_lbv150.yaml") +
            " --config " + file("config/operators/simulated.yaml") + " --manoeuvre circle");
  CHECK(wrong.code == 1);
  CHECK_MESSAGE(wrong.says("flown with two thrusters"), wrong.text);
  const auto unknown = on_network(fly + " --manoeuvre loop");
  CHECK(unknown.code == 1);
  CHECK_MESSAGE(unknown.says("'loop' is no manoeuvre"), unknown.text);
}

}  // namespace fathom
