#include "common/model/candidates/candidate.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include "common/base/error.hpp"

namespace fathom::model {
namespace {

constexpr int kMostPower = 4;
constexpr std::array kOfModel{"u", "v", "w", "p", "q", "r", "U", "tau_X", "tau_Y", "tau_Z", "tau_K", "tau_M", "tau_N"};

bool of_model(const std::string& name) { return std::ranges::find(kOfModel, name) != kOfModel.end(); }

/// Recursive descent over: product = power {"*" power} ["@" name]; power = (name | "|" name "|") ["^" digit].
class Parser {
 public:
  explicit Parser(std::string_view text) : text_{text} {}

  Candidate parse() {
    Candidate candidate;
    candidate.text = std::string{trimmed()};
    power(candidate);
    while (take('*')) {
      if (peek() == '*') fail("a power is written as ^: wind_speed^2");
      power(candidate);
    }
    if (take('@')) candidate.bearing = name().text;
    skip();
    if (at_ < text_.size()) stop_here();
    if (candidate.columns.empty())
      fail("names no measured column: what goes with the model's own motion and thrust alone is asked anyway");
    return candidate;
  }

 private:
  struct Name {
    std::string text;
    bool quoted{};
  };

  void power(Candidate& candidate) {
    Candidate::Power one;
    one.size = take('|');
    const Name called = name();
    one.name = called.text;
    if (one.size && !take('|')) fail("a | is not closed");
    if (take('^')) one.power = exponent();
    (!called.quoted && of_model(one.name) ? candidate.model : candidate.columns).push_back(std::move(one));
  }

  Name name() {
    skip();
    Name found;
    if (take('"')) {
      const std::size_t end = text_.find('"', at_);
      if (end == std::string_view::npos) fail("a \" is not closed");
      found = {std::string{text_.substr(at_, end - at_)}, true};
      at_ = end + 1;
    } else {
      const std::size_t from = at_;
      while (at_ < text_.size() && in_name(text_[at_])) ++at_;
      found.text = std::string{text_.substr(from, at_ - from)};
      if (!found.text.empty() && std::isdigit(static_cast<unsigned char>(found.text.front())) != 0)
        fail("a number has no place in it: its coefficient is what is sought");
    }
    if (found.text.empty()) fail("a name is missing " + place());
    return found;
  }

  int exponent() {
    skip();
    const char digit = peek();
    if (digit < '1' || digit > '0' + kMostPower || (at_ + 1 < text_.size() && in_name(text_[at_ + 1])))
      fail("a power is a whole number from 1 to " + std::to_string(kMostPower));
    ++at_;
    return digit - '0';
  }

  [[noreturn]] void stop_here() {
    if (peek() == '+' || peek() == '-') fail("a sum is several candidates: give each by itself");
    if (peek() == '/') fail("nothing is divided: products and powers only");
    if (peek() == '^') fail("a power is a whole number from 1 to " + std::to_string(kMostPower));
    fail("cannot be read " + place() + R"(; a name with blanks or signs stands in "...")");
  }

  static bool in_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.'; }
  [[nodiscard]] char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  void skip() {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
  }
  bool take(char c) {
    skip();
    if (peek() != c) return false;
    ++at_;
    return true;
  }
  [[nodiscard]] std::string_view trimmed() const {
    const std::size_t from = std::min(text_.find_first_not_of(' '), text_.size());
    const std::size_t last = text_.find_last_not_of(' ');
    return last == std::string_view::npos ? std::string_view{} : text_.substr(from, last + 1 - from);
  }
  [[nodiscard]] std::string place() const {
    return at_ >= text_.size() ? "at its end" : "at '" + std::string{text_.substr(at_)} + "'";
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError("candidate '" + std::string{text_} + "': " + what);
  }

  std::string_view text_;
  std::size_t at_{};
};

}  // namespace

Candidate parse_candidate(std::string_view text) { return Parser{text}.parse(); }

void add_candidate(std::string_view text, std::vector<Candidate>& candidates) {
  Candidate candidate = parse_candidate(text);
  if (std::ranges::find(candidates, candidate.text, &Candidate::text) != candidates.end())
    throw InputError("candidate '" + candidate.text + "': given twice");
  candidates.push_back(std::move(candidate));
}

std::string effect_name(const Candidate& candidate) { return "column " + candidate.text; }

std::string power_of_unit(const std::string& unit, int power) {
  if (unit.empty() || power == 1) return unit;
  const bool plain = unit.find_first_of(" /^") == std::string::npos;
  return (plain ? unit : "(" + unit + ")") + "^" + std::to_string(power);
}

std::string times_unit(const std::string& one, const std::string& other) {
  return one + (one.empty() || other.empty() ? "" : " ") + other;
}

}  // namespace fathom::model
