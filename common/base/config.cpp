#include "common/base/config.hpp"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <sstream>
#include <string_view>

#include "common/base/error.hpp"
#include "common/base/near_name.hpp"
#include "common/base/units.hpp"

namespace fathom {

// The YAML tree, copied once so that every node knows its file, its line and who has asked for it.
struct Config::Node {
  enum class Kind { kEmpty, kScalar, kList, kSection };
  struct Entry {
    std::string key;
    int line{};
    std::shared_ptr<Node> value;
    bool read{false};
  };

  std::shared_ptr<const std::string> file;
  int line{};
  Kind kind{Kind::kEmpty};
  std::string path;  // "thrusters[2].axis", for messages
  std::string scalar;
  std::vector<std::shared_ptr<Node>> items;
  std::vector<Entry> entries;
  std::set<std::string> asked;  // every key a reader wanted here, present or not: what "did you mean" may offer

  [[nodiscard]] std::string at(int where) const { return *file + ":" + std::to_string(where); }
  [[nodiscard]] std::string section_name() const { return path.empty() ? "" : " in '" + path + "'"; }
  Entry* find(const std::string& key);
  Entry& need(const std::string& key);
  void refuse_misspelt() const;
  Node& value(const std::string& key, Kind kind);
  void finish() const;
};

namespace {

constexpr int kMaxDepth = 32;       // of sections; no configuration of ours is deeper than 5
constexpr int kMaxNodes = 200'000;  // aliases can multiply a small file without end

struct Number {
  double value{};
  std::size_t used{};
};

// A decimal number that ends at a blank, a comma, a bracket or the end; nothing when the text begins otherwise.
std::optional<Number> number_at(std::string_view text) {
  const std::size_t plus = !text.empty() && text.front() == '+' ? 1 : 0;
  Number number;
  const auto [end, error] = std::from_chars(text.data() + plus, text.data() + text.size(), number.value);
  number.used = static_cast<std::size_t>(end - text.data());
  if (error != std::errc{} ||
      (number.used < text.size() && std::string_view(" \t,]").find(*end) == std::string_view::npos))
    return std::nullopt;
  return number;
}

std::string_view trim(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\n\r");
  return first == std::string_view::npos ? "" : text.substr(first, text.find_last_not_of(" \t\n\r") - first + 1);
}

// Hears where a document starts and nothing else.
class StartListener : public YAML::EventHandler {
 public:
  int line{};

  void OnDocumentStart(const YAML::Mark& mark) override { line = mark.line + 1; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t, const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {}
  void OnMapEnd() override {}
};

// YAML::Load forgets what follows the first document, and YAML::LoadAll never returns on some broken text (yaml-cpp 0.7
// finds the same empty document again and again), so a second one is looked for here and no further.
void refuse_second_document(const std::string& text, const std::string& name) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  StartListener listener;
  if (!parser.HandleNextDocument(listener) || !parser.HandleNextDocument(listener)) return;
  throw InputError(name + ":" + std::to_string(listener.line) +
                   ": text that does not belong to the document above ('---', or a bracket too many)");
}

}  // namespace

Config::Node::Entry* Config::Node::find(const std::string& key) {
  asked.insert(key);
  const auto found = std::find_if(entries.begin(), entries.end(), [&](const Entry& entry) { return entry.key == key; });
  return found == entries.end() ? nullptr : &*found;
}

Config::Node::Entry& Config::Node::need(const std::string& key) {
  if (Entry* entry = find(key)) {
    entry->read = true;
    return *entry;
  }
  refuse_misspelt();
  throw InputError(at(line) + ": key '" + key + "' is missing" + section_name());
}

// A key that was asked for and is not here, and one that is here and nobody asked for: when the two look alike, that is
// the mistake, and what follows from it would mislead.
void Config::Node::refuse_misspelt() const {
  for (const Entry& entry : entries) {
    if (entry.read || asked.contains(entry.key)) continue;
    for (const std::string& wanted : asked) {
      const bool present = std::any_of(entries.begin(), entries.end(), [&](const Entry& e) { return e.key == wanted; });
      if (present || !looks_like(entry.key, wanted)) continue;
      throw InputError(at(entry.line) + ": unknown key '" + entry.key + "'" + section_name() + "; did you mean '" +
                       wanted + "'?");
    }
  }
}

Config::Node& Config::Node::value(const std::string& key, Kind wanted) {
  Entry& entry = need(key);
  if (entry.value->kind != wanted) {
    const char* words = wanted == Kind::kScalar ? "one value" : wanted == Kind::kList ? "a list" : "a section";
    throw InputError(at(entry.line) + ": '" + key + "' must be " + words);
  }
  return *entry.value;
}

void Config::Node::finish() const {
  for (const Entry& entry : entries) {
    if (entry.read) {
      entry.value->finish();
      continue;
    }
    std::string message = at(entry.line) + ": unknown key '" + entry.key + "'" + section_name();
    for (const std::string& known : asked) {
      if (known == entry.key || !looks_like(known, entry.key)) continue;
      message += "; did you mean '" + known + "'?";
      break;
    }
    throw InputError(message);
  }
  for (const auto& item : items) item->finish();
}

Config Config::parse(const std::string& text, const std::string& name) {
  const auto file = std::make_shared<const std::string>(name);
  int nodes = 0;
  const auto fail = [&](int line, const std::string& what) -> void {
    throw InputError(name + ":" + std::to_string(line) + ": " + what);
  };
  const auto copy = [&](const auto& self, const YAML::Node& yaml, int line, const std::string& path,
                        int depth) -> std::shared_ptr<Node> {
    if (depth > kMaxDepth || ++nodes > kMaxNodes) fail(line, "too deep or too large (an alias that holds itself?)");
    auto node = std::make_shared<Node>();
    node->file = file;
    node->line = line;
    node->path = path;
    if (yaml.IsScalar()) {
      node->kind = Node::Kind::kScalar;
      node->scalar = yaml.Scalar();
    } else if (yaml.IsSequence()) {
      node->kind = Node::Kind::kList;
      for (const auto& item : yaml) {
        const std::string item_path = path + "[" + std::to_string(node->items.size()) + "]";
        node->items.push_back(self(self, item, item.Mark().line + 1, item_path, depth + 1));
      }
    } else if (yaml.IsMap()) {
      node->kind = Node::Kind::kSection;
      for (const auto& pair : yaml) {
        const int key_line = pair.first.Mark().line + 1;
        if (!pair.first.IsScalar()) fail(key_line, "a key must be a word");
        const std::string& key = pair.first.Scalar();
        for (const auto& other : node->entries) {
          if (other.key == key) {
            fail(key_line, "key '" + key + "' stands here twice (first in line " + std::to_string(other.line) + ")");
          }
        }
        std::string key_path = path;
        if (!key_path.empty()) key_path += '.';
        key_path += key;
        node->entries.push_back({key, key_line, self(self, pair.second, key_line, key_path, depth + 1), false});
      }
    }
    return node;
  };
  try {
    refuse_second_document(text, name);
    const YAML::Node document = YAML::Load(text);
    auto root = document.IsDefined() ? copy(copy, document, 1, "", 0) : std::make_shared<Node>();
    root->file = file;
    root->line = 1;
    if (root->kind == Node::Kind::kEmpty) fail(1, "the file is empty");
    if (root->kind != Node::Kind::kSection) fail(1, "expected 'key: value' lines");
    return Config(std::move(root));
  } catch (const YAML::Exception& error) {
    throw InputError(name + ":" + std::to_string(error.mark.line + 1) + ": not valid YAML: " + error.msg);
  }
}

Config Config::load(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (!file || std::filesystem::is_directory(path)) throw InputError(path + ": cannot read this configuration file");
  text << file.rdbuf();
  return parse(text.str(), path);
}

bool Config::has(const std::string& key) const { return node_->find(key) != nullptr; }

bool Config::is_section(const std::string& key) const {
  const Node::Entry* entry = node_->find(key);
  return entry != nullptr && entry->value->kind == Node::Kind::kSection;
}

Config Config::section(const std::string& key) const {
  static_cast<void>(node_->value(key, Node::Kind::kSection));
  return Config(node_->find(key)->value);
}

std::vector<Config> Config::list(const std::string& key) const {
  std::vector<Config> sections;
  for (const auto& item : node_->value(key, Node::Kind::kList).items) {
    if (item->kind != Node::Kind::kSection) {
      throw InputError(item->at(item->line) + ": '" + item->path + "' must be a section");
    }
    sections.push_back(Config(item));
  }
  return sections;
}

std::vector<std::string> Config::keys() const {
  std::vector<std::string> names;
  names.reserve(node_->entries.size());
  for (const auto& entry : node_->entries) names.push_back(entry.key);
  return names;
}

std::string Config::text(const std::string& key) const { return node_->value(key, Node::Kind::kScalar).scalar; }

std::vector<std::string> Config::texts(const std::string& key) const {
  std::vector<std::string> words;
  for (const auto& item : node_->value(key, Node::Kind::kList).items) {
    if (item->kind != Node::Kind::kScalar) {
      throw InputError(item->at(item->line) + ": '" + item->path + "' must be one word");
    }
    words.push_back(item->scalar);
  }
  return words;
}

bool Config::flag(const std::string& key) const { return either(key, "true", "false"); }

bool Config::either(const std::string& key, const std::string& yes, const std::string& no) const {
  const std::string word = text(key);
  if (word != yes && word != no) fail(key, "'" + key + "' must be " + yes + " or " + no + ", not '" + word + "'");
  return word == yes;
}

int Config::integer(const std::string& key) const {
  const std::string word = text(key);
  int value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) {
    fail(key, "'" + key + "' must be a whole number, not '" + word + "'");
  }
  return value;
}

double Config::quantity(const std::string& key, const std::string& unit) const {
  const std::vector<double> values = quantities(key, unit);
  if (values.size() != 1) fail(key, "'" + key + "' must be one number, not " + std::to_string(values.size()));
  return values.front();
}

double Config::positive(const std::string& key, const std::string& unit) const {
  const double value = quantity(key, unit);
  if (!(value > 0.0)) fail(key, "'" + key + "' must be positive");
  return value;
}

double Config::not_negative(const std::string& key, const std::string& unit) const {
  const double value = quantity(key, unit);
  if (!(value >= 0.0)) fail(key, "'" + key + "' must not be negative");
  return value;
}

std::vector<double> Config::quantities(const std::string& key, const std::string& unit) const {
  Node::Entry& entry = node_->need(key);
  std::vector<double> values;
  const auto must_be_finite = [&](const std::string& scalar) {
    fail(key, "'" + key + "' must be finite, not '" + scalar + "'");
  };
  const auto read = [&](const std::string& scalar) {
    std::string_view rest = trim(scalar);
    const bool bracket = !rest.empty() && rest.front() == '[';
    if (bracket) rest = trim(rest.substr(1));
    const std::size_t first = values.size();
    while (const auto number = number_at(rest)) {
      if (!std::isfinite(number->value)) must_be_finite(scalar);
      values.push_back(number->value);
      rest = trim(rest.substr(number->used));
      if (!rest.empty() && rest.front() == ',') rest = trim(rest.substr(1));
    }
    if (bracket) {
      if (rest.empty() || rest.front() != ']') fail(key, "'" + key + "': missing ']' in '" + scalar + "'");
      rest = trim(rest.substr(1));
    }
    if (values.size() == first) {
      fail(key,
           "'" + key + "' must begin with a number" + (unit.empty() ? "" : " in " + unit) + ", not '" + scalar + "'");
    }
    double factor{};
    try {
      factor = unit_factor(rest, unit);
    } catch (const InputError& error) {
      fail(key, "'" + key + "': " + error.what());
    }
    for (std::size_t i = first; i < values.size(); ++i) {
      values[i] *= factor;
      if (!std::isfinite(values[i])) must_be_finite(scalar);
    }
  };
  if (entry.value->kind == Node::Kind::kScalar) {
    read(entry.value->scalar);
  } else if (entry.value->kind == Node::Kind::kList) {
    for (const auto& item : entry.value->items) {
      if (item->kind != Node::Kind::kScalar) fail(key, "'" + key + "' must be a list of numbers");
      read(item->scalar);
    }
  } else {
    fail(key, "'" + key + "' must be a number" + (unit.empty() ? "" : " in " + unit));
  }
  return values;
}

Eigen::Vector3d Config::vector3(const std::string& key, const std::string& unit) const {
  const std::vector<double> values = quantities(key, unit);
  if (values.size() != 3) fail(key, "'" + key + "' must be three numbers, not " + std::to_string(values.size()));
  return {values[0], values[1], values[2]};
}

void Config::finish() const { node_->finish(); }

std::string Config::where(const std::string& key) const {
  for (const auto& entry : node_->entries) {
    if (entry.key == key) return node_->at(entry.line);
  }
  return node_->at(node_->line);
}

void Config::fail(const std::string& key, const std::string& what) const {
  node_->refuse_misspelt();
  throw InputError(where(key) + ": " + what);
}

}  // namespace fathom
