// procman/spy, which opens lcm-spy: what it says where Java is missing, that it installs that and goes on, and that its
// plugins draw what a log holds.
#include <doctest/doctest.h>

#include <filesystem>

#include "common/wire/log_writer.hpp"
#include "test/support/scratch.hpp"
#include "test/support/shell.hpp"

namespace fathom {
namespace {

namespace fs = std::filesystem;

void put_program(const std::string& path, const std::string& text) {
  test::write_bytes(path, "#!/bin/bash\n" + text + "\n");
  fs::permissions(path, fs::perms::owner_all);
}

/// As it is installed: procman/spy with the types' jar above it, on a machine that has no Java, no sudo and an apt-get
/// that brings whatever it is asked for.
struct Machine {
  test::Scratch scratch;
  Machine() {
    for (const char* folder : {"share/procman", "bin", "java"}) fs::create_directories(scratch.path(folder));
    fs::copy_file(std::string{FATHOM_SOURCE_DIR} + "/procman/spy", scratch.path("share/procman/spy"));
    test::write_bytes(scratch.path("share/fathom_types.jar"), "jar");
    fs::create_symlink("/usr/bin/dirname", scratch.path("bin/dirname"));
    put_program(scratch.path("bin/id"), "echo 0");
    put_program(scratch.path("bin/apt-get"),
                "echo apt-get \"$@\"\n"
                "printf '#!/bin/bash\\necho java \"$@\" with $CLASSPATH on $LCM_DEFAULT_URL\\n' > " +
                    scratch.path("bin/java") + "\n/bin/chmod +x " + scratch.path("bin/java") + "\n: > " +
                    scratch.path("java/lcm.jar") + "\n: > " + scratch.path("java/jchart2d.jar"));
  }
  [[nodiscard]] test::Ran spy(const std::string& words, const std::string& display = ":9") const {
    return test::shell("DISPLAY=" + display + " LCM_DEFAULT_URL='memq://' CLASSPATH= PATH=" + scratch.path("bin") +
                       " FATHOM_JAVA_FOLDER=" + scratch.path("java") + " /bin/bash " +
                       scratch.path("share/procman/spy") + " " + words);
  }
};

Recording said() {
  Recording recording;
  for (int k = 0; k < 50; ++k) {
    const Utime t = 1'700'000'000'000'000 + 100'000 * k;
    StateEstimate state{};
    state.utime = t;
    state.p_WB = {0.1 * k, 0.0, 1.0};
    state.valid = true;
    recording.state.push_back(state);
    ModelEstimate model{};
    model.utime = t;
    model.parameters = {{"X_u", -8.0 - 0.01 * k, 1.0 / (1.0 + k), "N/(m/s)"}};
    model.covariance = {1.0};
    recording.model.push_back(model);
  }
  recording.effects.push_back({.utime = 1'700'000'005'000'000,
                               .verdict = "effect",
                               .candidates = {{.name = "thruster_lag", .log_odds = 40.0, .error_reduction = 0.3},
                                              {.name = "current", .log_odds = -3.0}}});
  return recording;
}

}  // namespace

TEST_CASE("spy: where something is missing one line says what, and how it comes; nothing is opened") {
  const Machine machine;
  for (const char* words : {"", "--check"}) {
    const test::Ran ran = machine.spy(words);
    CHECK(ran.code == 1);
    CHECK(ran.lines() == 1);
    CHECK(ran.says("lcm-spy needs default-jre liblcm-java libjchart2d-java: 'fathom spy --install', or sudo apt-get"));
  }
}

TEST_CASE("spy: one command on a machine without Java installs what is missing and opens lcm-spy with our types") {
  const Machine machine;
  const test::Ran ran = machine.spy("--install");
  CAPTURE(ran.text);
  CHECK(ran.code == 0);
  CHECK(ran.says("apt-get install -y --no-install-recommends default-jre liblcm-java libjchart2d-java"));
  CHECK(ran.says("lcm.spy.Spy with " + machine.scratch.path("share/fathom_types.jar") + ":" +
                 machine.scratch.path("java/lcm.jar")));
  CHECK(ran.says("on memq://"));
  const test::Ran again = machine.spy("");
  CHECK(again.code == 0);
  CHECK_FALSE(again.says("apt-get"));
  CHECK(machine.spy("--check").says("nothing is missing"));
  const test::Ran blind = machine.spy("", "");
  CHECK(blind.code == 1);
  CHECK(blind.says("DISPLAY is not set"));
}

TEST_CASE("spy: the plugins draw STATE, MODEL and EFFECTS of a log, and say what they cannot draw") {
  const std::string lcm = "/usr/share/java/lcm.jar";
  if (!fs::exists(lcm) || test::shell("command -v javac && command -v jar && command -v lcm-gen").code != 0) {
    MESSAGE("no Java: not tried");
    return;
  }
  const test::Scratch scratch;
  const std::string jar = scratch.path("types.jar");
  const test::Ran made = test::shell(test::file("scripts/types_jar") + " " + jar);
  REQUIRE_MESSAGE(made.code == 0, made.text);
  wire::write_log(said(), scratch.path("RUN.lcmlog"));
  const auto draw = [&](const std::string& channel) {
    return test::shell("java -Djava.awt.headless=true -cp " + jar + ":" + lcm + " fathom_spy.PlotSpy " +
                       scratch.path("RUN.lcmlog") + " " + channel + " " + scratch.path(channel + ".png"));
  };
  for (const char* channel : {"STATE", "MODEL", "EFFECTS"}) {
    CAPTURE(channel);
    const test::Ran ran = draw(channel);
    CHECK_MESSAGE(ran.code == 0, ran.text);
    const std::string png = test::read_bytes(scratch.path(std::string{channel} + ".png"));
    CHECK(png.starts_with("\x89PNG"));
    CHECK(png.size() > 5000);  // a blank page of that size is smaller
  }
  const test::Ran none = draw("SONAR");
  CHECK(none.code == 1);
  CHECK(none.says("nothing on channel SONAR that can be drawn (STATE, MODEL, EFFECTS)"));
}

}  // namespace fathom
