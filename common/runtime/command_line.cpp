#include "common/runtime/command_line.hpp"

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <iostream>
#include <string_view>

#include "common/base/brief_number.hpp"
#include "common/base/error.hpp"
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

/// ", but check is"; nothing where no command is near.
std::string meant(const CLI::App& app, std::string_view word) {
  std::string near;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    const std::string& name = command->get_name();
    const bool begins = word.size() > 2 && name.starts_with(word);
    if (begins || looks_like(name, word)) near += (near.empty() ? "" : " or ") + name;
  }
  return near.empty() ? "" : ", but " + near + " is";
}

Option* with(Option* self, CLI::Option* option, const CLI::Validator& rule) {
  option->check(rule);
  return self;
}

/// A bound on numbers with the help's words of `rule`, which itself would name the largest number there is, in all of
/// its three hundred digits, and six decimals of the smallest. What is no finite number is refused by itself.
template <typename Accepts>
Option* bounded(Option* self, CLI::Option* option, const CLI::Validator& rule, std::string must, Accepts accepts) {
  const auto refuse = [must = std::move(must), accepts](const std::string& text) {
    double value = 0.0;
    if (!CLI::detail::lexical_cast(text, value)) return text + " is no number";
    return !std::isfinite(value) || accepts(value) ? std::string{} : "must " + must + ", not " + text;
  };
  option->check(refuse, rule.get_description());
  return self;
}

}  // namespace

Option* Option::required() { return option_->required(), this; }
Option* Option::positive() {
  return bounded(this, option_, CLI::PositiveNumber, "be more than 0", [](double value) { return value > 0.0; });
}
Option* Option::not_negative() {
  return bounded(this, option_, CLI::NonNegativeNumber, "not be negative", [](double value) { return value >= 0.0; });
}
Option* Option::within(int least, int most) { return with(this, option_, CLI::Range(least, most)); }
Option* Option::within(double least, double most) {
  return bounded(this, option_, CLI::Range(least, most),
                 "lie from " + brief_number(least) + " to " + brief_number(most),
                 [=](double value) { return value >= least && value <= most; });
}
Option* Option::one_of(std::initializer_list<const char*> words) {
  return with(this, option_, CLI::IsMember(std::vector<std::string>(words.begin(), words.end())));
}
Option* Option::one_of(std::initializer_list<int> numbers) {
  return with(this, option_, CLI::IsMember(std::vector<int>{numbers}));
}
Option* Option::existing_file() { return with(this, option_, CLI::ExistingFile); }
Option* Option::expected(int values) { return option_->expected(values), this; }
Option* Option::take_all() { return option_->take_all(), this; }
Option* Option::delimiter(char sign) { return option_->delimiter(sign), this; }
Option* Option::allow_extra_args(bool more) { return option_->allow_extra_args(more), this; }
Option* Option::type_name(const std::string& name) { return option_->type_name(name), this; }
Option* Option::each(std::function<void(const std::string&)> look) { return option_->each(std::move(look)), this; }
Option* Option::needs(const Option* other) { return option_->needs(other->option_), this; }
Option* Option::excludes(const Option* other) { return option_->excludes(other->option_), this; }
Option* Option::envname(const std::string& variable) { return option_->envname(variable), this; }

CommandLine::CommandLine(std::string description, std::string name)
    : app_{new CLI::App{std::move(description), std::move(name)}}, own_{app_} {}

CommandLine* CommandLine::add_subcommand(const std::string& name, const std::string& description) {
  return &commands_.emplace_back(app_->add_subcommand(name, description));
}

template <typename Value>
Option* CommandLine::add_option(const std::string& names, Value& value, const std::string& description) {
  return &options_.emplace_back(app_->add_option(names, value, description));
}
template Option* CommandLine::add_option(const std::string&, bool&, const std::string&);
template Option* CommandLine::add_option(const std::string&, int&, const std::string&);
template Option* CommandLine::add_option(const std::string&, std::uint64_t&, const std::string&);
template Option* CommandLine::add_option(const std::string&, double&, const std::string&);
template Option* CommandLine::add_option(const std::string&, std::string&, const std::string&);
template Option* CommandLine::add_option(const std::string&, std::optional<double>&, const std::string&);
template Option* CommandLine::add_option(const std::string&, std::vector<double>&, const std::string&);
template Option* CommandLine::add_option(const std::string&, std::vector<std::string>&, const std::string&);

Option* CommandLine::add_flag(const std::string& names, bool& value, const std::string& description) {
  return &options_.emplace_back(app_->add_flag(names, value, description));
}

void CommandLine::callback(std::function<void()> what) { app_->callback(std::move(what)); }

void CommandLine::example(const std::string& words) {
  const std::string program = app_->get_parent() == nullptr ? "" : app_->get_parent()->get_name() + " ";
  app_->footer("Example: " + program + app_->get_name() + (words.empty() ? "" : " ") + words);
}

CommandLine* CommandLine::subcommand(const std::string& name) {
  for (CommandLine& each : commands_) {
    if (each.app_->get_name() == name) return &each;
  }
  return nullptr;
}

void CommandLine::hand_on(std::function<void(const std::vector<std::string>&)> what) {
  app_->prefix_command();
  app_->set_help_flag();
  app_->callback([app = app_, what = std::move(what)] { what(app->remaining()); });
}

bool CommandLine::parse(int argc, const char* const* argv) { return parse(argc, argv, std::cout); }

bool CommandLine::parse(int argc, const char* const* argv, std::ostream& answer) {
  app_->set_version_flag("--version", app_->get_name() + " " + std::string{version()}, "print the version and exit");
  if (argc == 4 && std::string_view{argv[1]} == "--pages") {
    write_pages(*app_, argv[3], argv[2]);
    return false;
  }
  expect_finite_numbers(*app_);
  try {
    app_->parse(argc, argv);
    return true;
  } catch (const CLI::Success& asked) {
    app_->exit(asked, answer, answer);
    return false;
  } catch (const CLI::ParseError& error) {
    std::string asked = app_->get_name();
    for (const CLI::App* command : app_->get_subcommands()) asked += " " + command->get_name();
    throw UsageError(std::string{error.what()} + "; see " + asked + " --help");
  }
}

std::optional<int> CommandLine::parse_or_tell(int argc, const char* const* argv) {
  try {
    return parse(argc, argv) ? std::nullopt : std::optional{0};
  } catch (const UsageError& error) {
    std::fprintf(stderr, "%s: %s\n", app_->get_name().c_str(), error.what());
    return 2;
  }
}

int CommandLine::run(int argc, const char* const* argv) {
  app_->require_subcommand(1);
  const auto is_first = [&](const CLI::App* known) { return known->check_name(argv[1]); };
  if (argc > 1 && argv[1][0] != '-' && app_->get_subcommands(is_first).empty()) {
    const char* name = app_->get_name().c_str();
    std::fprintf(stderr, "%s: %s is no command%s; see %s --help\n", name, argv[1], meant(*app_, argv[1]).c_str(), name);
    return 2;
  }
  try {
    return parse_or_tell(argc, argv).value_or(0);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", app_->get_name().c_str(), error.what());
    return 1;
  }
}

}  // namespace fathom::runtime
