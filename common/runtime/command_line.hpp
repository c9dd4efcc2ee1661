// How a program with subcommands ends. Exit 0: done; 1: bad input, one line says what; 2: bad command line.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>

#include "common/runtime/finite_options.hpp"

namespace fathom::runtime {

/// Runs the subcommand that was asked for; the return value of main().
inline int run_command_line(CLI::App& app, int argc, char** argv) {
  app.require_subcommand(1);
  expect_finite_numbers(app);
  try {
    const auto is_first = [&](const CLI::App* known) { return known->check_name(argv[1]); };
    if (argc > 1 && argv[1][0] != '-' && app.get_subcommands(is_first).empty())
      throw CLI::ExtrasError(std::string(argv[1]) + " is no command", CLI::ExitCodes::ExtrasError);
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::Success& asked) {
    return app.exit(asked);
  } catch (const CLI::ParseError& error) {
    std::fprintf(stderr, "fathom: %s; see fathom --help\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fathom: %s\n", error.what());
    return 1;
  }
}

}  // namespace fathom::runtime
