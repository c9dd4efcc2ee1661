#include "common/runtime/command_pages.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/version.hpp"

namespace fathom::runtime {
namespace {

/// Text for troff: a backslash and a hyphen mean themselves; a line that begins with a control character is none.
std::string troff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (out.empty() || out.back() == '\n') out += c == '.' || c == '\'' ? "\\&" : "";
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      out += c;
    }
  }
  return out;
}

std::string bold(const std::string& text) { return "\\fB" + troff(text) + "\\fR"; }
std::string italic(const std::string& text) { return "\\fI" + troff(text) + "\\fR"; }

std::string upper(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

bool takes_value(const CLI::Option& option) { return option.get_type_size() != 0 && option.get_expected_max() > 0; }
bool takes_many(const CLI::Option& option) {
  return option.get_expected_max() >= CLI::detail::expected_max_vector_size;
}

/// The words between braces of CLI::IsMember's name; empty for a value of another kind.
std::vector<std::string> choices(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const auto open = type.find('{'), close = type.find('}');
  std::vector<std::string> words;
  if (open == std::string::npos || close == std::string::npos || close < open) return words;
  std::istringstream list{type.substr(open + 1, close - open - 1)};
  for (std::string word; std::getline(list, word, ',');) words.push_back(word);
  return words;
}

/// What stands for the value in a page: TEXT, FLOAT or the choices.
std::string placeholder(const CLI::Option& option) {
  const std::vector<std::string> words = choices(option);
  if (words.empty()) {
    const std::string type = option.get_type_name();
    return type.substr(0, type.find(':')) + (takes_many(option) ? "..." : "");
  }
  std::string all;
  for (const std::string& each : words) all += (all.empty() ? "" : "|") + each;
  return all;
}

std::vector<const CLI::Option*> options_of(const CLI::App& app, bool positional) {
  return app.get_options([positional](const CLI::Option* option) {
    return !option->get_group().empty() && (positional ? option->get_positional() : option->nonpositional());
  });
}

std::vector<const CLI::App*> subcommands(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* each) { return !each->get_name().empty(); });
}

/// Every name of an option, "-u" and "--lcmurl".
std::vector<std::string> names(const CLI::Option& option) {
  std::vector<std::string> all;
  for (const std::string& each : option.get_snames()) all.push_back("-" + each);
  for (const std::string& each : option.get_lnames()) all.push_back("--" + each);
  return all;
}

std::string synopsis(const CLI::App& app, const std::string& command) {
  std::string line = bold(command);
  bool more = false;
  for (const CLI::Option* each : options_of(app, false)) {
    if (!each->get_required()) {
      more = true;
      continue;
    }
    line += " " + bold(names(*each).back()) + " " + italic(placeholder(*each));
  }
  if (more) line += " [" + italic("OPTION") + "]...";
  for (const CLI::Option* each : options_of(app, true)) {
    const std::string name = italic(each->get_name(true, false)) + (takes_many(*each) ? "..." : "");
    line += each->get_required() ? " " + name : " [" + name + "]";
  }
  if (!subcommands(app).empty()) line += " " + italic("COMMAND") + " ...";
  return line + "\n";
}

std::string option_list(const CLI::App& app, bool positional) {
  std::string text;
  for (const CLI::Option* each : options_of(app, positional)) {
    text += ".TP\n";
    if (positional) {
      text += italic(each->get_name(true, false));
    } else {
      std::string heads;
      for (const std::string& name : names(*each)) heads += (heads.empty() ? "" : ", ") + bold(name);
      text += heads + (takes_value(*each) ? " " + italic(placeholder(*each)) : "");
    }
    std::string description = each->get_description();
    if (!each->get_default_str().empty()) description += " [" + each->get_default_str() + "]";
    if (each->get_required() && !positional) description += (description.empty() ? "" : "; ") + std::string{"required"};
    text += "\n" + troff(description.empty() ? "(see below)" : description) + "\n";
  }
  return text;
}

std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string{"'\\''"} : std::string{c};
  return out + "'";
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& each : words) text += (text.empty() ? "" : " ") + each;
  return text;
}

void save(const std::string& path, const std::string& text) {
  std::ofstream file{path, std::ios::binary};
  file << text;
  if (!file.flush()) throw InputError(path + ": cannot be written; check the folder's permissions and free space");
}

/// The first statement of a description, for the line that `apropos` searches.
std::string summary(const std::string& description) {
  std::string first = description.substr(0, std::min(description.find(". "), description.find("; ")));
  if (first.ends_with('.')) first.pop_back();
  return first;
}

}  // namespace

std::string manual_page(const CLI::App& app, const std::string& program) {
  const bool whole = app.get_parent() == nullptr;
  const std::string page = whole ? program : program + "-" + app.get_name();
  std::string text = ".TH \"" + upper(page) + "\" 1 \"\" \"Fathom " + std::string{version()} + "\" \"Fathom\"\n";
  text += ".SH NAME\n" + troff(page) + " \\- " + troff(summary(app.get_description())) + "\n";
  text += ".SH SYNOPSIS\n" + synopsis(app, whole ? program : program + " " + app.get_name());
  text += ".SH DESCRIPTION\n" + troff(app.get_description()) + "\n";
  if (const std::string list = option_list(app, true); !list.empty()) text += ".SH ARGUMENTS\n" + list;
  if (const std::string list = option_list(app, false); !list.empty()) text += ".SH OPTIONS\n" + list;
  if (!subcommands(app).empty()) text += ".SH COMMANDS\n";
  for (const CLI::App* each : subcommands(app))
    text += ".TP\n" + bold(app.get_name() + "-" + each->get_name()) + "(1)\n" + troff(each->get_description()) + "\n";
  constexpr std::string_view kExample = "Example: ";
  if (const std::string example = app.get_footer(); example.starts_with(kExample))
    text += ".SH EXAMPLE\n" + troff(example.substr(kExample.size())) + "\n";
  text +=
      ".SH EXIT STATUS\n0 when what was asked for was done; otherwise another number, and a line on standard error "
      "that "
      "says why.\n";
  text += ".SH SEE ALSO\n" + (page == "fathom" ? "" : bold("fathom") + "(1), ") +
          "the files of docs/ in /usr/share/doc/fathom\n";
  return text;
}

std::string completion_table(const CLI::App& app, const std::string& program) {
  const std::string command = app.get_parent() == nullptr ? program : program + " " + app.get_name();
  std::vector<std::string> words;
  std::string values;
  for (const CLI::App* each : subcommands(app)) words.push_back(each->get_name());
  for (const CLI::Option* each : options_of(app, true)) {
    const auto listed = choices(*each);
    words.insert(words.end(), listed.begin(), listed.end());
  }
  for (const CLI::Option* each : options_of(app, false)) {
    for (const std::string& name : names(*each)) {
      words.push_back(name);
      if (takes_value(*each))
        values += "_fathom_values[" + quoted(command + " " + name) + "]=" + quoted(joined(choices(*each))) + "\n";
    }
  }
  return "_fathom_words[" + quoted(command) + "]=" + quoted(joined(words)) + "\n" + values;
}

void write_pages(const CLI::App& app, const std::string& program, const std::string& folder) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  std::string table = completion_table(app, program);
  save(folder + "/" + program + ".1", manual_page(app, program));
  for (const CLI::App* each : subcommands(app)) {
    if (each->get_prefix_command()) continue;
    table += completion_table(*each, app.get_name());
    save(folder + "/" + app.get_name() + "-" + each->get_name() + ".1", manual_page(*each, app.get_name()));
  }
  save(folder + "/" + program + ".completion", table);
}

}  // namespace fathom::runtime
