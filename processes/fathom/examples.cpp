// The last line of every command's --help and manual page: an example. The tests run each of them.
#include <array>
#include <string>

#include "common/runtime/command_line.hpp"
#include "processes/fathom/commands.hpp"

namespace fathom::tool {
namespace {

struct Example {
  const char* command;
  const char* words;  // behind the command
};

constexpr std::array kExamples{Example{"vehicle", "bluerov2_heavy"},
                               Example{"import", "DIVE.csv --out NEW.lcmlog"},
                               Example{"check", "--vehicle V.yaml RUN.lcmlog"},
                               Example{"diagnose", "--vehicle V.yaml --train RUN.lcmlog --out DIAGNOSIS"},
                               Example{"explain", "BEFORE"},
                               Example{"diff", "BEFORE AFTER"},
                               Example{"info", "RUN.lcmlog"},
                               Example{"export", "RUN.lcmlog --to csv --out TABLES"},
                               Example{"compare", "A.lcmlog B.lcmlog --intervals"},
                               Example{"smooth", "RUN.lcmlog --out SMOOTH.lcmlog"},
                               Example{"regress", "LINE.lcmlog ZIGZAG.lcmlog --vehicle V.yaml"},
                               Example{"methods", "--vehicle V.yaml --config P.yaml --train A.csv --validate Z.csv"},
                               Example{"plan", "--vehicle V.yaml --site S.yaml --excitation paper"},
                               Example{"decode", "pd0 DIVE.pd0 --csv DIVE.csv"},
                               Example{"emulate", "ig500 --to pty:AHRS --seconds 1"},
                               Example{"arm", "--operator OPERATOR.yaml"},
                               Example{"order", "hold --operator OPERATOR.yaml"},
                               Example{"fly", "zigzag --operator OPERATOR.yaml"},
                               Example{"steer", "--operator OPERATOR.yaml --force 5"},
                               Example{"abort", ""},
                               Example{"status", ""},
                               Example{"doctor", ""},
                               Example{"repair-log", "BROKEN.lcmlog --out WHOLE.lcmlog"},
                               Example{"watch", ""},
                               Example{"bus", "--seconds 1"},
                               Example{"spy", "--check"},
                               Example{"trial", "RUN.lcmlog --vehicle V.yaml --site S.yaml --out TRIAL"}};

}  // namespace

void add_examples(runtime::CommandLine& app) {
  for (const Example& one : kExamples) {
    if (runtime::CommandLine* command = app.subcommand(one.command)) command->example(one.words);
  }
}

}  // namespace fathom::tool
