// What the command lines of all programs share: --version, numbers that are finite, and pages about themselves.
#pragma once

#include <CLI/CLI.hpp>

namespace fathom::runtime {

/// CLI11's parse, with these in addition: `--version` prints the name and fathom::version(); "nan" and "inf", which
/// CLI11's checks let pass, are refused; a first word `--pages` writes the manual and the table for completion
/// (command_pages.hpp) of the program as it is installed, `PROGRAM --pages FOLDER fathom-NAME`, and is CLI::Success.
void parse(CLI::App& app, int argc, const char* const* argv);

/// Runs the subcommand that was asked for; the return value of main(). 0: done; 1: bad input, one line says what;
/// 2: bad command line.
int run_command_line(CLI::App& app, int argc, char** argv);

}  // namespace fathom::runtime
