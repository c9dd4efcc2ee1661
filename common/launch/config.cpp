#include "common/launch/config.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>

#include "common/base/error.hpp"
#include "common/launch/tokens.hpp"

namespace fathom::launch {
namespace {

using Kind = Token::Kind;

struct Group {
  std::string path;
  std::vector<ConfiguredCommand> commands;
  std::vector<Group> groups;

  Group& sub(const std::string& name) {
    const std::string full = path.empty() ? name : path + "/" + name;
    for (Group& each : groups) {
      if (each.path == full) return each;
    }
    groups.push_back({.path = full, .commands = {}, .groups = {}});
    return groups.back();
  }
  void list(std::vector<ConfiguredCommand>& into) const {
    into.insert(into.end(), commands.begin(), commands.end());
    for (const Group& each : groups) each.list(into);
  }
};

class Parser {
 public:
  Parser(const std::string& text, const std::string& path) : path_{path}, tokens_{tokenize(text, path)} {}

  LaunchConfig file() {
    LaunchConfig config{.path = path_, .commands = {}, .scripts = {}};
    Group root;
    while (now().kind != Kind::kEnd) {
      if (now().text == "script" && now().kind == Kind::kName) {
        config.scripts.push_back(script());
      } else if (!entry(root)) {
        fail("expected cmd, group or script instead of " + describe(now()));
      }
    }
    root.list(config.commands);
    for (std::size_t i = 0; i < config.scripts.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (config.scripts[i].name != config.scripts[j].name) continue;
        fail("a second script \"" + config.scripts[i].name + "\"; the first is in line " +
                 std::to_string(config.scripts[j].line),
             config.scripts[i].line);
      }
    }
    return config;
  }

 private:
  [[noreturn]] void fail(const std::string& what, int line) const {
    throw InputError(path_ + ":" + std::to_string(line) + ": " + what);
  }
  [[noreturn]] void fail(const std::string& what) const { fail(what, now().line); }
  [[nodiscard]] const Token& now() const { return tokens_[at_]; }
  Token take() { return tokens_[at_ + 1 < tokens_.size() ? at_++ : at_]; }
  bool word(const std::string& text) {
    if (now().kind != Kind::kName || now().text != text) return false;
    take();
    return true;
  }
  void sign(const std::string& text, const std::string& after) {
    if (now().kind != Kind::kSign || now().text != text) {
      fail("expected " + text + " after " + after + " instead of " + describe(now()));
    }
    take();
  }
  std::string string(const std::string& what) {
    if (now().kind != Kind::kString) fail("expected " + what + " in double quotes instead of " + describe(now()));
    return take().text;
  }
  int integer(const std::string& what, int least, int most) {
    int value{};
    const std::string& text = now().text;
    if (now().kind != Kind::kInteger) fail(what + " must be a whole number, not " + describe(now()));
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || value < least || value > most) {
      fail(what + " must be a whole number from " + std::to_string(least) + " to " + std::to_string(most) + ", not " +
           text);
    }
    take();
    return value;
  }

  bool entry(Group& group) {
    if (word("cmd")) {
      command(group);
    } else if (word("group")) {
      const std::string name = string("a group's name");
      if (name.find('/') != std::string::npos ||
          std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isspace(c) != 0; })) {
        fail("a group's name must not be blank nor hold '/'; nest groups instead");
      }
      sign("{", "the group's name");
      constexpr int kDeepest = 50;
      if (++depth_ > kDeepest) fail("groups are nested more than 50 deep");
      Group& inner = group.sub(name);
      while (!(now().kind == Kind::kSign && now().text == "}")) {
        if (now().kind == Kind::kEnd) fail("group \"" + name + "\" is not closed; a } is missing");
        if (!entry(inner)) fail("expected cmd or group inside a group instead of " + describe(now()));
      }
      take();
      --depth_;
    } else {
      return false;
    }
    return true;
  }

  void command(Group& group) {
    ConfiguredCommand made{.command = {.group = group.path}, .deputy = {}, .line = now().line};
    if (now().kind != Kind::kString) fail("cmd without a name; write cmd \"NAME\" { ... }");
    made.command.id = take().text;
    const std::string name = "cmd \"" + made.command.id + "\"";
    if (made.command.id.empty() || made.command.id.find('/') != std::string::npos) {
      fail(name + ": a command's name must not be empty nor hold '/'", made.line);
    }
    if (!ids_.emplace(made.command.id, made.line).second) {
      fail(name + " stands in line " + std::to_string(ids_[made.command.id]) + " already", made.line);
    }
    sign("{", name);
    while (!(now().kind == Kind::kSign && now().text == "}")) {
      if (now().kind != Kind::kName) fail(name + ": expected an attribute or } instead of " + describe(now()));
      const std::string attribute = take().text;
      sign("=", attribute);
      value(made, attribute);
      sign(";", "the value of " + attribute);
    }
    take();
    if (made.command.exec.empty()) fail(name + " has no exec", made.line);
    if (made.deputy.empty()) fail(name + " has no deputy: which host shall run it?", made.line);
    group.commands.push_back(std::move(made));
  }

  void value(ConfiguredCommand& made, const std::string& attribute) {
    if (attribute == "exec") {
      made.command.exec = string("a command line");
    } else if (attribute == "deputy") {
      made.deputy = string("a deputy's name");
    } else if (attribute == "group") {
      string("a group's name");  // accepted, without effect
    } else if (attribute == "auto_respawn") {
      std::string text = string("true or false");
      std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
      made.command.auto_respawn = text == "true" || text == "yes";
    } else if (attribute == "stop_signal") {
      made.command.stop_signal = static_cast<std::int8_t>(integer(attribute, 1, 64));
    } else if (attribute == "stop_time_allowed") {
      made.command.stop_time_allowed = static_cast<float>(integer(attribute, 1, 86400));
    } else {
      fail("no attribute '" + attribute +
           "'; there are exec, deputy, auto_respawn, stop_signal, stop_time_allowed and group" +
           (attribute == "host" ? " (host is the older procman's word for deputy)" : ""));
    }
  }

  Script script() {
    const int line = take().line;
    Script made{.name = string("a script's name"), .actions = {}, .line = line};
    sign("{", "the script's name");
    while (!(now().kind == Kind::kSign && now().text == "}")) {
      if (now().kind == Kind::kEnd) fail("script \"" + made.name + "\" is not closed; a } is missing");
      made.actions.push_back(action());
      sign(";", "the action");
    }
    take();
    return made;
  }

  Action action() {
    Action made{.line = now().line};
    if (word("wait")) {
      made.verb = Action::Verb::kPause;
      if (word("ms")) {
        made.pause_ms = integer("wait ms", 0, 86'400'000);
        return made;
      }
      made.verb = Action::Verb::kAwait;
      made.target = target(false);
      if (!word("status")) fail("expected status \"running\" or \"stopped\" instead of " + describe(now()));
      made.awaited = awaited();
      return made;
    }
    if (word("run_script")) {
      made.verb = Action::Verb::kScript;
      made.script = string("a script's name");
      return made;
    }
    if (word("start")) {
      made.verb = Action::Verb::kStart;
    } else if (word("stop")) {
      made.verb = Action::Verb::kStop;
    } else if (word("restart")) {
      made.verb = Action::Verb::kRestart;
    } else {
      fail("expected start, stop, restart, wait or run_script instead of " + describe(now()));
    }
    made.target = target(true);
    if (word("wait")) made.awaited = awaited();
    return made;
  }

  Target target(bool everything) {
    if (word("cmd")) return {Target::Kind::kCommand, string("a command's name")};
    if (word("group")) return {Target::Kind::kGroup, string("a group's name")};
    if (everything && word("everything")) return {Target::Kind::kEverything, ""};
    fail(std::string{"expected cmd or group"} + (everything ? " or everything" : "") + " instead of " +
         describe(now()));
  }

  Awaited awaited() {
    const std::string text = string("running or stopped");
    if (text == "running") return Awaited::kRunning;
    if (text == "stopped") return Awaited::kStopped;
    --at_;
    fail("one can wait for \"running\" or \"stopped\", not for " + describe(now()));
  }

  const std::string& path_;
  std::vector<Token> tokens_;
  std::size_t at_{};
  int depth_{};                     ///< of groups
  std::map<std::string, int> ids_;  ///< with the line of each
};

// Every name that a script uses is there, and no script comes back to itself.
void check_script(const LaunchConfig& config, const Script& script, std::vector<std::string> callers) {
  callers.push_back(script.name);
  for (const Action& action : script.actions) {
    const auto fail = [&](const std::string& what) {
      throw InputError(config.path + ":" + std::to_string(action.line) + ": " + what);
    };
    if (action.verb == Action::Verb::kScript) {
      const Script* called = config.script(action.script);
      if (called == nullptr) fail("no script \"" + action.script + "\"");
      if (std::find(callers.begin(), callers.end(), action.script) != callers.end()) {
        fail("script \"" + action.script + "\" would run itself again and again");
      }
      check_script(config, *called, callers);
    } else if (action.verb != Action::Verb::kPause && action.target.kind != Target::Kind::kEverything) {
      const bool found =
          std::any_of(config.commands.begin(), config.commands.end(),
                      [&](const ConfiguredCommand& each) { return covers(action.target, each.command); });
      const bool group = action.target.kind == Target::Kind::kGroup;
      if (!found) fail((group ? "no commands in group \"" : "no cmd \"") + action.target.name + "\"");
    }
  }
}

}  // namespace

LaunchConfig LaunchConfig::parse(const std::string& text, const std::string& path) {
  LaunchConfig config = Parser{text, path}.file();
  for (const Script& each : config.scripts) check_script(config, each, {});
  const auto hash = text.rfind('#');
  const bool in_comment = hash != std::string::npos && text.find('\n', hash) == std::string::npos;
  config.ends_in_a_word = !text.empty() && !in_comment && std::isalnum(static_cast<unsigned char>(text.back())) != 0;
  return config;
}

LaunchConfig LaunchConfig::load(const std::string& path) {
  std::ifstream file{path, std::ios::binary};
  if (!file || std::filesystem::is_directory(path)) {
    throw InputError(path + ": cannot be read; give one of procman/*.cfg");
  }
  return parse({std::istreambuf_iterator<char>{file}, {}}, path);
}

const Script* LaunchConfig::script(const std::string& name) const {
  for (const Script& each : scripts) {
    if (each.name == name) return &each;
  }
  return nullptr;
}

const Script& LaunchConfig::require_script(const std::string& name) const {
  if (const Script* found = script(name)) return *found;
  std::string names;
  for (const Script& each : scripts) names += (names.empty() ? "" : ", ") + each.name;
  throw InputError(path + ": no script \"" + name + "\"; there " + (names.empty() ? "is none" : "are " + names));
}

std::vector<std::string> LaunchConfig::deputies() const {
  std::vector<std::string> names;
  for (const ConfiguredCommand& each : commands) {
    if (std::find(names.begin(), names.end(), each.deputy) == names.end()) names.push_back(each.deputy);
  }
  return names;
}

bool covers(const Target& target, const LaunchCommand& command) {
  if (target.kind == Target::Kind::kEverything) return true;
  if (target.kind == Target::Kind::kCommand) return command.id == target.name;
  return command.group == target.name || command.group.starts_with(target.name + "/");
}

}  // namespace fathom::launch
