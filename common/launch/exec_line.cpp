#include "common/launch/exec_line.hpp"

#include <algorithm>
#include <cctype>

#include "common/launch/config.hpp"

namespace fathom::launch {
namespace {

bool space(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }
bool begins_name(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool in_name(char c) { return begins_name(c) || std::isdigit(static_cast<unsigned char>(c)) != 0; }

std::vector<std::string> split(const std::string& exec) {
  std::vector<std::string> words;
  std::string word;
  bool open = false;  // a word has begun, be it empty quotes
  char quote = '\0';
  for (std::size_t i = 0; i < exec.size(); ++i) {
    const char c = exec[i];
    if (quote == '\0' && space(c)) {
      if (open) words.push_back(std::move(word));
      word.clear();
      open = false;
      continue;
    }
    open = true;
    if (c == '\\' && i + 1 < exec.size()) {
      word += exec[++i];
    } else if (quote == '\0' && (c == '"' || c == '\'')) {
      quote = c;
    } else if (c == quote) {
      quote = '\0';
    } else {
      word += c;
    }
  }
  if (open) words.push_back(std::move(word));
  return words;
}

std::string expand(const std::string& word, const Environment& environment) {
  std::string text;
  for (std::size_t i = 0; i < word.size(); ++i) {
    const bool braced = i + 1 < word.size() && word[i + 1] == '{';
    const std::size_t begin = i + (braced ? 2 : 1);
    if (word[i] != '$' || begin >= word.size() || !begins_name(word[begin])) {
      text += word[i];
      continue;
    }
    std::size_t end = begin;
    while (end < word.size() && in_name(word[end])) ++end;
    const bool closed = !braced || (end < word.size() && word[end] == '}');
    const auto value = closed ? environment(word.substr(begin, end - begin)) : std::nullopt;
    if (!value) {
      text += word[i];
      continue;
    }
    text += *value;
    i = braced ? end : end - 1;
  }
  return text;
}

}  // namespace

ExecLine parse_exec(const std::string& exec, const Environment& environment) {
  ExecLine line;
  bool leading = true;
  for (const std::string& word : split(exec)) {
    const auto equals = word.find('=');
    leading = leading && equals != std::string::npos;
    if (leading) {
      line.settings.emplace_back(word.substr(0, equals), word.substr(equals + 1));
    } else {
      line.words.push_back(expand(word, environment));
    }
  }
  return line;
}

std::vector<std::string> exec_traps(const std::string& exec) {
  std::vector<std::string> traps;
  const std::size_t size = exec.size();
  if (size >= 1 && !space(exec[size - 1]) && exec[size - 1] != '"' && exec[size - 1] != '\'' &&
      (size == 1 || space(exec[size - 2]))) {
    traps.emplace_back("procman loses a last word of one character; write it in quotes");
  }
  const ExecLine line = parse_exec(exec, [](const std::string&) { return std::nullopt; });
  for (const auto& [name, value] : line.settings) {
    if (value.empty()) traps.push_back("procman cannot read " + name + "= without a value");
    if (value.find('$') != std::string::npos) traps.push_back("$ is not replaced in the setting of " + name);
  }
  if (line.words.empty()) {
    traps.emplace_back("names no program");
  } else {
    const auto shell_sign = [](const std::string& word) {
      return word == "|" || word == "&&" || word == "||" || word == ";" || word == "&" || word == ">" || word == ">>" ||
             word == "<" || word == "2>&1" || word.ends_with(";");
    };
    if (std::any_of(line.words.begin(), line.words.end(), shell_sign)) {
      traps.emplace_back("is no shell line: pipes, redirections, && and ; mean nothing; use bash -c \"...\"");
    }
  }
  if (exec.find("\\\\") != std::string::npos) traps.emplace_back("procman stumbles over doubled backslashes");
  return traps;
}

std::vector<std::string> LaunchConfig::traps() const {
  std::vector<std::string> found;
  for (const ConfiguredCommand& each : commands) {
    for (const std::string& what : exec_traps(each.command.exec)) {
      found.push_back(path + ":" + std::to_string(each.line) + ": exec of \"" + each.command.id + "\": " + what);
    }
  }
  for (const Script& script : scripts) {
    for (std::size_t i = 0; i < script.actions.size(); ++i) {
      const Action& action = script.actions[i];
      const std::string place = path + ":" + std::to_string(action.line) + ": ";
      if (action.verb == Action::Verb::kScript) found.push_back(place + "run_script hangs procman's own sheriff");
      const bool stops = action.verb == Action::Verb::kStop || action.verb == Action::Verb::kRestart;
      if (!stops || i == 0) continue;
      const Action& before = script.actions[i - 1];
      if (before.verb == Action::Verb::kStart || before.verb == Action::Verb::kRestart) {
        found.push_back(place + "a stop right behind a start can take procman's own deputy down; wait ms 200 between");
      }
    }
  }
  if (ends_in_a_word) found.push_back(path + ": ends within a word, which hangs procman's parser; end with a line end");
  return found;
}

}  // namespace fathom::launch
