// The command line of a program, with CLI11 behind it in one source: reading CLI11's headers costs a compiler three
// seconds in every file. What all programs share is here as well: --version, --pages, numbers that are finite.
#pragma once

#include <functional>
#include <initializer_list>
#include <iosfwd>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/error.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
class Option;
}  // namespace CLI

namespace fathom::runtime {

/// Bad words on a command line: what is wrong, and where to read more.
class UsageError : public InputError {
  using InputError::InputError;
};

/// One option, flag or positional argument; belongs to its command line. Every rule returns the option itself.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_{option} {}
  Option* required();
  Option* positive();
  Option* not_negative();
  Option* within(int least, int most);
  Option* within(double least, double most);
  Option* one_of(std::initializer_list<const char*> words);
  Option* one_of(std::initializer_list<int> numbers);
  Option* existing_file();
  Option* expected(int values);         // negative: at least so many
  Option* take_all();                   // given twice, it has both values
  Option* delimiter(char sign);         // between values of one word
  Option* allow_extra_args(bool more);  // one word behind the name, or all up to the next name
  Option* type_name(const std::string& name);
  Option* each(std::function<void(const std::string& word)> look);
  Option* needs(const Option* other);
  Option* excludes(const Option* other);
  Option* envname(const std::string& variable);

 private:
  CLI::Option* option_;
};

class CommandLine {
 public:
  CommandLine(std::string description, std::string name);
  explicit CommandLine(CLI::App* app) : app_{app} {}

  CommandLine* add_subcommand(const std::string& name, const std::string& description);
  /// `names`: "-u,--url", or "file" for a positional one. `value` must outlive parse(); kinds of values:
  /// command_line.cpp.
  template <typename Value>
  Option* add_option(const std::string& names, Value& value, const std::string& description = {});
  Option* add_flag(const std::string& names, bool& value, const std::string& description = {});
  /// Run by run() when this subcommand was asked for.
  void callback(std::function<void()> what);
  /// The last line of --help, and a section of the manual page: "Example: PROGRAM NAME words".
  void example(const std::string& words);
  /// Null where there is none of that name.
  [[nodiscard]] CommandLine* subcommand(const std::string& name);
  /// All words behind its name go on unread, --help too; `what` is given them.
  void hand_on(std::function<void(const std::vector<std::string>& words)> what);

  /// False: --help, --version (name and fathom::version()) or --pages was asked for and is done. `--pages FOLDER
  /// fathom-NAME` as the first words writes the manual and the table for completion (command_pages.hpp) of the program
  /// as it is installed. "nan" and "inf", which CLI11's checks let pass, are refused. UsageError; and what the
  /// subcommand that was asked for throws.
  [[nodiscard]] bool parse(int argc, const char* const* argv);
  [[nodiscard]] bool parse(int argc, const char* const* argv, std::ostream& answer);  // to --help and --version
  /// parse() for a main(): the exit code, 0 or 2, where the program is to end; one line on stderr says why.
  [[nodiscard]] std::optional<int> parse_or_tell(int argc, const char* const* argv);
  /// Runs the subcommand that was asked for; the return value of main(). 0: done; 1: bad input, one line says what;
  /// 2: bad command line.
  int run(int argc, const char* const* argv);

  [[nodiscard]] const CLI::App& cli() const { return *app_; }

 private:
  CLI::App* app_;
  std::shared_ptr<CLI::App> own_;  // of the whole program; subcommands belong to it
  std::list<Option> options_;
  std::list<CommandLine> commands_;
};

}  // namespace fathom::runtime
