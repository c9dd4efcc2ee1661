// Manual pages and shell completion, made from what parses the command line: neither can name an
// option that the program has not, or miss one.
#pragma once

#include <string>

#include "common/runtime/command_line.hpp"

namespace fathom::runtime {

/// Source of a page of section 1 in man(7)'s macros. `program` is the installed name, such as fathom-estimator; a
/// subcommand NAME has the page `program`-NAME.
[[nodiscard]] std::string manual_page(const CLI::App& app, const std::string& program);

/// Lines of bash for cmake/completion.bash: which words may follow `program` (of a subcommand: `program` NAME), which
/// of its options take a value, and which values.
[[nodiscard]] std::string completion_table(const CLI::App& app, const std::string& program);

/// Writes `folder`/`program`.1, `folder`/`program`.completion, and a page per subcommand. Subcommands are called by the
/// name of `app`, since fathom-pictures runs some of fathom's; those that hand their words on to another program
/// (CLI11's prefix commands) are left to it. InputError when `folder` cannot be written.
void write_pages(const CLI::App& app, const std::string& program, const std::string& folder);

}  // namespace fathom::runtime
