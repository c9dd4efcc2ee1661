#include "common/recordings/ros/raw_definition.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>

#include "common/recordings/ros/definition.hpp"

namespace fathom::recordings::ros {
namespace {

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front())) != 0) text.remove_prefix(1);
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back())) != 0) text.remove_suffix(1);
  return text;
}

std::size_t whole_number(std::string_view text) {
  std::size_t value = 0;
  (void)std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

bool is_rule(std::string_view line) {  // the line between two definitions
  return line.size() >= 20 && std::ranges::all_of(line, [](char c) { return c == '='; });
}

/// "float64[36] covariance" and the like; nothing for a constant or what is no member.
bool member_of(std::string_view line, RawMember& member) {
  const std::size_t gap = line.find_first_of(" \t");
  if (gap == std::string_view::npos) return false;
  std::string_view type = line.substr(0, gap);
  const std::string_view rest = trimmed(line.substr(gap));
  const std::size_t end = std::min(rest.find_first_of(" \t="), rest.size());
  const std::string_view after = trimmed(rest.substr(end));
  if (end == 0 || after.starts_with('=')) return false;
  member.name = rest.substr(0, end);
  if (const std::size_t bracket = type.find('['); bracket != std::string_view::npos) {
    member.list = true;
    const std::string_view inside = type.substr(bracket + 1);
    member.count = inside.starts_with("<=") ? 0 : whole_number(inside);
    type = type.substr(0, bracket);
  }
  type = type.substr(0, type.find("<="));  // a bound on a text
  member.type = type;
  return true;
}

/// Words and signs of IDL, comments and annotations left out.
class Words {
 public:
  explicit Words(std::string_view text) : text_(text) {}

  std::string next() {
    for (;;) {
      while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
      if (at_ >= text_.size()) return {};
      const std::string_view rest = text_.substr(at_);
      if (rest.starts_with("//") || rest.starts_with('#')) {
        at_ += std::min(rest.find('\n'), rest.size());
      } else if (rest.starts_with("/*")) {
        const std::size_t end = rest.find("*/");
        at_ += end == std::string_view::npos ? rest.size() : end + 2;
      } else if (rest.starts_with('@')) {
        annotation();
      } else if (rest.starts_with('"')) {
        literal();
      } else {
        break;
      }
    }
    const std::size_t begin = at_;
    const auto in_word = [](unsigned char c) {
      return std::isalnum(c) != 0 || c == '_' || c == ':' || c == '.' || c == '-';
    };
    while (at_ < text_.size() && in_word(static_cast<unsigned char>(text_[at_]))) ++at_;
    if (at_ == begin) ++at_;
    return std::string{text_.substr(begin, at_ - begin)};
  }

  [[nodiscard]] bool rule() const { return text_.substr(std::min(at_, text_.size())).starts_with("===="); }

 private:
  void literal() {
    for (++at_; at_ < text_.size() && text_[at_] != '"'; ++at_) {
      if (text_[at_] == '\\') ++at_;
    }
    at_ = std::min(at_ + 1, text_.size());
  }
  void annotation() {
    ++at_;
    while (at_ < text_.size() &&
           (std::isalnum(static_cast<unsigned char>(text_[at_])) != 0 || text_[at_] == '_' || text_[at_] == ':'))
      ++at_;
    std::size_t look = at_;
    while (look < text_.size() && std::isspace(static_cast<unsigned char>(text_[look])) != 0) ++look;
    if (look >= text_.size() || text_[look] != '(') return;
    int depth = 0;
    at_ = look;
    while (at_ < text_.size()) {
      if (text_[at_] == '"') {
        literal();
        continue;
      }
      depth += text_[at_] == '(' ? 1 : text_[at_] == ')' ? -1 : 0;
      ++at_;
      if (depth == 0) return;
    }
  }

  std::string_view text_;
  std::size_t at_{};
};

/// Stands for a type that cannot be read, so that its message is refused and not misread.
constexpr const char* kListOfLists = "a list of lists";
constexpr const char* kUnknownLength = "a list whose length is no number";
constexpr std::size_t kMostElements = std::size_t{1} << 30U;  // of a fixed list: more is as much too many

/// Recursive descent through modules and structs.
class Idl {
 public:
  explicit Idl(std::string_view text) : words_(text) { step(); }

  RawDefinitions read() {
    while (!word_.empty()) {
      if (word_ == "module") {
        step();
        modules_.push_back(word_);
        step();
        if (word_ == "{") step();
      } else if (word_ == "struct") {
        structure();
      } else if (word_ == "typedef") {
        alias();
      } else if (word_ == "}") {
        if (!modules_.empty()) modules_.pop_back();
        step();
      } else if (word_ == "const" || word_ == "enum") {
        while (!word_.empty() && word_ != ";") step();
        step();
      } else {
        step();  // lines of '=', "IDL:", names, stray signs
      }
    }
    return std::move(out_);
  }

 private:
  void step() { word_ = words_.next(); }

  /// A type with what stands around it: long long, sequence<T, n>, string<n>, a::b::C, an alias.
  RawMember type() {
    RawMember member;
    if (word_ == "sequence") {
      step();  // <
      step();
      const bool nested = word_ == "sequence";
      if (!nested) member = type();
      if (nested || member.list) member.type = kListOfLists;
      member.list = true;
      member.count = 0;
      while (!word_.empty() && word_ != ">") step();
      step();
      return member;
    }
    member.type = word_;
    step();
    while ((member.type == "unsigned" || member.type == "long" || member.type == "unsigned long") &&
           (word_ == "long" || word_ == "short" || word_ == "double")) {
      member.type += " " + word_;
      step();
    }
    if (word_ == "<") {
      while (!word_.empty() && word_ != ">") step();
      step();
    }
    if (const auto alias = aliases_.find(member.type); alias != aliases_.end()) return alias->second;
    std::string plain;
    for (std::size_t i = 0; i < member.type.size(); ++i) {
      if (member.type[i] == ':') {
        if (plain.empty() || plain.back() != '/') plain += '/';
      } else {
        plain += member.type[i];
      }
    }
    member.type = short_name(plain);
    return member;
  }

  /// "[3]" and "[3][3]": elements stand one behind the other, however they are numbered.
  void dimension(RawMember& member) {
    std::size_t count = 1;
    bool any = false;
    for (; word_ == "["; any = true) {
      step();
      count = std::min(count * std::min(whole_number(word_), kMostElements), kMostElements);
      while (!word_.empty() && word_ != "]") step();
      step();
    }
    if (!any) return;
    if (member.list) member.type = kListOfLists;
    if (count == 0) member.type = kUnknownLength;
    member.list = true;
    member.count = count;
  }

  void alias() {
    step();
    RawMember member = type();
    const std::string name = word_;
    step();
    dimension(member);
    aliases_[name] = member;
    if (word_ == ";") step();
  }

  void structure() {
    step();
    std::string package = modules_.empty() ? "" : modules_.front() + "/";
    const std::string name = package + word_;
    step();
    std::vector<RawMember> members;
    if (word_ == "{") step();
    while (!word_.empty() && word_ != "}") {
      RawMember member = type();
      member.name = word_;
      step();
      dimension(member);
      if (member.name != "structure_needs_at_least_one_member") members.push_back(member);
      if (word_ != ";") {
        while (!word_.empty() && word_ != ";" && word_ != "}") step();
      }
      if (word_ == ";") step();
    }
    step();
    out_[name] = std::move(members);
  }

  Words words_;
  std::string word_;
  std::vector<std::string> modules_;
  std::map<std::string, RawMember> aliases_;
  RawDefinitions out_;
};

}  // namespace

RawDefinitions raw_from_msg(const std::string& name, std::string_view text) {
  RawDefinitions out;
  std::string current = name;
  out[current];
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = trimmed(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (is_rule(line)) continue;
    if (line.starts_with("MSG:")) {
      current = short_name(trimmed(line.substr(4)));
      out[current];
      continue;
    }
    line = trimmed(line.substr(0, line.find('#')));
    RawMember member;
    if (!line.empty() && member_of(line, member)) out[current].push_back(std::move(member));
  }
  return out;
}

RawDefinitions raw_from_idl(std::string_view text) { return Idl{text}.read(); }

}  // namespace fathom::recordings::ros
