// CLI11's checks of numbers let "nan" pass, and some "inf": no option of any program has a use for either.
#pragma once

#include <CLI/CLI.hpp>
#include <cmath>
#include <string>

namespace fathom::runtime {

/// Every option of `app` and of its subcommands that takes a real number refuses one that is not finite.
inline void expect_finite_numbers(CLI::App& app) {
  const auto refuse = [](const std::string& text) {
    double value = 0.0;
    const bool odd = CLI::detail::lexical_cast(text, value) && !std::isfinite(value);
    return odd ? text + " is not a finite number" : std::string{};
  };
  const auto takes_real = [](const CLI::Option* option) { return option->get_type_name().starts_with("FLOAT"); };
  for (CLI::Option* option : app.get_options(takes_real)) option->check(refuse);
  for (CLI::App* command : app.get_subcommands({})) expect_finite_numbers(*command);
}

}  // namespace fathom::runtime
