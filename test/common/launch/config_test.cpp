// procman's configuration grammar: what is read, what is refused and with which line, what procman stumbles over.
#include "common/launch/config.hpp"

#include <doctest/doctest.h>

#include <filesystem>

#include "common/base/error.hpp"
#include "common/launch/exec_line.hpp"
#include "test/support/scratch.hpp"

namespace fathom::launch {
namespace {

constexpr char kGood[] = R"(# a comment
cmd "root" { exec = "date -u"; deputy = "topside"; }
group "sensors" {
  group "cameras" { cmd "left" { exec = "cam \"1 2\""; deputy = "vehicle"; group = "ignored"; } }
  cmd "imu" { exec = "imu"; exec = "imu -v"; deputy = "vehicle"; auto_respawn = "YES"; stop_signal = 15; stop_time_allowed = 3; }
}
group "sensors" { cmd "dvl" { exec = "dvl"; deputy = "vehicle"; auto_respawn = "on"; } }
script "go" {
  start group "sensors" wait "running";  # with its subgroups
  wait ms 250;
  wait cmd "imu" status "stopped";
  restart cmd "root";
  run_script "end";
}
script "end" { stop everything wait "stopped"; }
)";

std::string refusal(const std::string& text) {
  return test::complaint_of<InputError>([&] { (void)LaunchConfig::parse(text, "x.cfg"); });
}
std::string command(const std::string& attributes) { return "\ncmd \"a\" { deputy = \"d\"; " + attributes + " }\n"; }

}  // namespace

TEST_CASE("launch config: commands come in procman's order, with groups as paths and procman's defaults") {
  const LaunchConfig config = LaunchConfig::parse(kGood, "x.cfg");
  REQUIRE(config.commands.size() == 4);
  CHECK(config.commands[0].command.id == "root");
  CHECK(config.commands[0].command.group.empty());
  CHECK(config.commands[0].deputy == "topside");
  CHECK(config.commands[0].command.stop_signal == 2);
  CHECK(config.commands[0].command.stop_time_allowed == 7.0F);
  CHECK_FALSE(config.commands[0].command.auto_respawn);
  CHECK(config.commands[1].command.id == "imu");
  CHECK(config.commands[1].command.exec == "imu -v");
  CHECK(config.commands[1].command.auto_respawn);
  CHECK(config.commands[1].command.stop_signal == 15);
  CHECK(config.commands[1].command.stop_time_allowed == 3.0F);
  CHECK(config.commands[2].command.id == "dvl");
  CHECK(config.commands[2].command.group == "sensors");
  CHECK_FALSE(config.commands[2].command.auto_respawn);  // neither true nor yes
  CHECK(config.commands[3].command.id == "left");
  CHECK(config.commands[3].command.group == "sensors/cameras");
  CHECK(config.commands[3].command.exec == "cam \"1 2\"");
  CHECK(config.deputies() == std::vector<std::string>{"topside", "vehicle"});
  CHECK(covers({Target::Kind::kGroup, "sensors"}, config.commands[3].command));
  CHECK_FALSE(covers({Target::Kind::kGroup, "sens"}, config.commands[3].command));
}

TEST_CASE("launch config: scripts keep their actions") {
  const LaunchConfig config = LaunchConfig::parse(kGood, "x.cfg");
  const Script& go = config.require_script("go");
  REQUIRE(go.actions.size() == 5);
  CHECK(go.actions[0].verb == Action::Verb::kStart);
  CHECK(go.actions[0].awaited == Awaited::kRunning);
  CHECK(go.actions[1].pause_ms == 250);
  CHECK(go.actions[2].verb == Action::Verb::kAwait);
  CHECK(go.actions[2].awaited == Awaited::kStopped);
  CHECK(go.actions[3].verb == Action::Verb::kRestart);
  CHECK_FALSE(go.actions[3].awaited.has_value());
  CHECK(go.actions[4].script == "end");
  CHECK(go.actions[4].line == 13);
  CHECK(test::complaint_of<InputError>([&] { (void)config.require_script("went"); }) ==
        "x.cfg: no script \"went\"; there are go, end");
}

TEST_CASE("launch config: CR LF, comments without line end and an empty file are well") {
  CHECK(LaunchConfig::parse("", "x.cfg").commands.empty());
  CHECK(LaunchConfig::parse("# nothing", "x.cfg").commands.empty());
  const auto config = LaunchConfig::parse("cmd \"a\" {\r\n  exec = \"b\\\nc\";\r\n  deputy = \"d\";\r\n}\r\n", "x.cfg");
  REQUIRE(config.commands.size() == 1);
  CHECK(config.commands[0].command.exec == "b\nc");
}

TEST_CASE("launch config: every mistake is one line with its place") {
  CHECK(refusal(command("exec = 'b';")) ==
        "x.cfg:2: single quotes have no meaning here; write strings in double quotes");
  CHECK(refusal("// no\n") == "x.cfg:1: '/' has no meaning here; a comment begins with #");
  CHECK(refusal(command("exec = \"b\n\";")) ==
        "x.cfg:2: the string is not closed on its line; close it with \" or put a backslash before the line end");
  CHECK(refusal(command("exec = \"b\"")) == "x.cfg:2: expected ; after the value of exec instead of '}'");
  CHECK(refusal(command("exec = \"b\"; auto_respawn = true;")) ==
        "x.cfg:2: expected true or false in double quotes instead of 'true'");
  CHECK(refusal(command("exec = \"b\"; stop_signal = 0;")) ==
        "x.cfg:2: stop_signal must be a whole number from 1 to 64, not 0");
  CHECK(refusal(command("exec = \"b\"; stop_time_allowed = 99999999999;"))
            .starts_with("x.cfg:2: stop_time_allowed must be a whole number from 1 to"));
  CHECK(refusal(command("exec = \"b\"; host = \"c\";")).find("(host is the older procman's word for deputy)") !=
        std::string::npos);
  CHECK(refusal(command("exec = \"\";")) == "x.cfg:2: cmd \"a\" has no exec");
  CHECK(refusal("cmd \"a\" { exec = \"b\"; }\n") == "x.cfg:1: cmd \"a\" has no deputy: which host shall run it?");
  CHECK(refusal("cmd { exec = \"b\"; }\n") == "x.cfg:1: cmd without a name; write cmd \"NAME\" { ... }");
  CHECK(refusal("cmd \"a/b\" {}\n") == "x.cfg:1: cmd \"a/b\": a command's name must not be empty nor hold '/'");
  CHECK(refusal(command("exec = \"b\";") + command("exec = \"c\";")) == "x.cfg:4: cmd \"a\" stands in line 2 already");
  CHECK(refusal("group \" \" { }\n").starts_with("x.cfg:1: a group's name must not be blank"));
  CHECK(refusal("group \"g\" {\n") == "x.cfg:2: group \"g\" is not closed; a } is missing");
  CHECK(refusal("group \"g\" { script \"s\" {} }\n") ==
        "x.cfg:1: expected cmd or group inside a group instead of 'script'");
  CHECK(refusal("everything\n") == "x.cfg:1: expected cmd, group or script instead of 'everything'");
  CHECK(refusal("script \"s\" {}\nscript \"s\" {}\n") == "x.cfg:2: a second script \"s\"; the first is in line 1");
  CHECK(refusal("script \"s\" {\n start cmd \"a\";\n}\n") == "x.cfg:2: no cmd \"a\"");
  CHECK(refusal("script \"s\" {\n stop group \"a\";\n}\n") == "x.cfg:2: no commands in group \"a\"");
  CHECK(refusal("script \"s\" { run_script \"t\"; }\n") == "x.cfg:1: no script \"t\"");
  CHECK(refusal("script \"s\" { run_script \"t\"; }\nscript \"t\" { run_script \"s\"; }\n") ==
        "x.cfg:2: script \"s\" would run itself again and again");
  CHECK(refusal("script \"s\" { start everything wait \"dead\"; }\n") ==
        "x.cfg:1: one can wait for \"running\" or \"stopped\", not for \"dead\"");
  CHECK(refusal("script \"s\" { wait everything status \"running\"; }\n") ==
        "x.cfg:1: expected cmd or group instead of 'everything'");
  CHECK(refusal("cmd \"a\" {") == "x.cfg:1: cmd \"a\": expected an attribute or } instead of the end of the file");
  std::string deep;
  for (int i = 0; i < 100'000; ++i) deep += "group \"g\" { ";
  CHECK(refusal(deep) == "x.cfg:1: groups are nested more than 50 deep");
  CHECK(refusal("script \"s\" { wait ms") == "x.cfg:1: wait ms must be a whole number, not the end of the file");
}

TEST_CASE("launch config: what procman accepts and then stumbles over is told") {
  const auto traps = [](const std::string& text) { return LaunchConfig::parse(text, "x.cfg").traps(); };
  CHECK(traps(command("exec = \"sleep 5\";")) ==
        std::vector<std::string>{
            "x.cfg:2: exec of \"a\": procman loses a last word of one character; write it in quotes"});
  CHECK(traps(command("exec = \"sleep \\\"5\\\"\";")).empty());
  CHECK(traps(command("exec = \"sleep 5 \";")).empty());
  CHECK(traps(command("exec = \"A= prog\";")).size() == 1);
  CHECK(traps(command("exec = \"A=$B prog\";")).size() == 1);
  CHECK(traps(command("exec = \"cat x | sort\";")).size() == 1);
  CHECK(traps(command("exec = \"bash -c \\\"cat x | sort\\\"\";")).empty());
  CHECK(traps(command("exec = \"ab \\\\\\\\ c\";")).size() == 2);
  CHECK(traps(command("exec = \"bb\";") +
              "script \"s\" { run_script \"t\"; }\nscript \"t\" { start everything; stop everything; }\n")
            .size() == 2);
}

TEST_CASE("launch config: the configurations that come with Fathom have no mistakes and no traps") {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator{std::string{FATHOM_SOURCE_DIR} + "/procman"}) {
    if (entry.path().extension() != ".cfg") continue;
    ++files;
    const LaunchConfig config = LaunchConfig::load(entry.path().string());
    for (const std::string& trap : config.traps()) FAIL_CHECK(trap);
    CHECK(config.script("stop") != nullptr);
    CHECK(config.script(entry.path().stem() == "replay" ? "replay" : "simulated-trial") != nullptr);
  }
  CHECK(files == 4);
}

TEST_CASE("launch config: stopping begins with the thrusters and ends with the logger") {
  for (const char* name : {"tank.cfg", "deep.cfg"}) {
    const auto config = LaunchConfig::load(std::string{FATHOM_SOURCE_DIR} + "/procman/" + name);
    const auto& actions = config.require_script("stop").actions;
    CHECK(actions.front().target.name == "thruster_driver");
    CHECK(actions.front().awaited == Awaited::kStopped);
    CHECK(actions.back().target.name == "logger");
  }
}

TEST_CASE("launch exec: words, quotes, settings and variables are procman's") {
  const Environment environment = [](const std::string& name) -> std::optional<std::string> {
    if (name == "HERE") return "/a b";
    return std::nullopt;
  };
  const auto words = [&](const std::string& exec) { return parse_exec(exec, environment).words; };
  using Words = std::vector<std::string>;
  CHECK(words("prog  -a\t'b c' \"d e\" f'g h'i") == Words{"prog", "-a", "b c", "d e", "fg hi"});
  CHECK(words("prog '' x") == Words{"prog", "", "x"});
  CHECK(words("sleep 5") == Words{"sleep", "5"});  // better than procman
  CHECK(words(R"(a\ b 'c\'d')") == Words{"a b", "c'd"});
  CHECK(words("prog 'unclosed x") == Words{"prog", "unclosed x"});
  CHECK(words("$HERE/x '${HERE}' $NONE ${NONE $1 $$ $(x) a$") ==
        Words{"/a b/x", "/a b", "$NONE", "${NONE", "$1", "$$", "$(x)", "a$"});
  const ExecLine line = parse_exec("A=1 B=$HERE prog C=2", environment);
  CHECK(line.settings == std::vector<std::pair<std::string, std::string>>{{"A", "1"}, {"B", "$HERE"}});
  CHECK(line.words == Words{"prog", "C=2"});
  CHECK(words("").empty());
}

}  // namespace fathom::launch
