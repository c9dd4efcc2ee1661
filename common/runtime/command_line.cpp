#include "common/runtime/command_line.hpp"

#include <cmath>
#include <cstdio>
#include <string>
#include <string_view>

#include "common/base/near_name.hpp"
#include "common/base/version.hpp"
#include "common/runtime/command_pages.hpp"

namespace fathom::runtime {
namespace {

/// Every option of `app` and of its subcommands that takes a real number refuses one that is not finite.
void expect_finite_numbers(CLI::App& app) {
  const auto refuse = [](const std::string& text) {
    double value = 0.0;
    const bool odd = CLI::detail::lexical_cast(text, value) && !std::isfinite(value);
    return odd ? text + " is not a finite number" : std::string{};
  };
  const auto takes_real = [](const CLI::Option* option) { return option->get_type_name().starts_with("FLOAT"); };
  for (CLI::Option* option : app.get_options(takes_real)) option->check(refuse);
  for (CLI::App* command : app.get_subcommands({})) expect_finite_numbers(*command);
}

/// "; did you mean check?"; nothing where no command is near.
std::string meant(const CLI::App& app, std::string_view word) {
  std::string near;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    const std::string& name = command->get_name();
    const bool begins = word.size() > 2 && name.starts_with(word);
    if (begins || looks_like(name, word)) near += (near.empty() ? "" : " or ") + name;
  }
  return near.empty() ? "" : "; did you mean " + near + "?";
}

}  // namespace

void parse(CLI::App& app, int argc, const char* const* argv) {
  app.set_version_flag("--version", app.get_name() + " " + std::string{version()}, "print the version and exit");
  if (argc == 4 && std::string_view{argv[1]} == "--pages") {
    write_pages(app, argv[3], argv[2]);
    throw CLI::Success{};
  }
  expect_finite_numbers(app);
  app.parse(argc, argv);
}

int run_command_line(CLI::App& app, int argc, char** argv) {
  app.require_subcommand(1);
  try {
    const auto is_first = [&](const CLI::App* known) { return known->check_name(argv[1]); };
    if (argc > 1 && argv[1][0] != '-' && app.get_subcommands(is_first).empty())
      throw CLI::ExtrasError(std::string(argv[1]) + " is no command" + meant(app, argv[1]),
                             CLI::ExitCodes::ExtrasError);
    parse(app, argc, argv);
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
