#include "common/launch/tokens.hpp"

#include <cctype>

#include "common/base/error.hpp"

namespace fathom::launch {
namespace {

bool begins_name(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }
bool blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\f' || c == '\v'; }

class Scanner {
 public:
  Scanner(const std::string& text, const std::string& path) : text_{text}, path_{path} {}

  Token next() {
    skip();
    if (at_ == text_.size()) return {Token::Kind::kEnd, "", line_};
    const char c = text_[at_];
    if (c == '{' || c == '}' || c == '=' || c == ';') {
      ++at_;
      return {Token::Kind::kSign, std::string{c}, line_};
    }
    if (c == '"') return string();
    if (digit(c)) return run(Token::Kind::kInteger, digit);
    if (begins_name(c)) return run(Token::Kind::kName, [](char d) { return begins_name(d) || digit(d) || d == '-'; });
    if (c == '\'') fail("single quotes have no meaning here; write strings in double quotes");
    if (c == '/') fail("'/' has no meaning here; a comment begins with #");
    fail(std::string{"'"} + c + "' has no meaning here");
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(path_ + ":" + std::to_string(line_) + ": " + what);
  }

  void skip() {
    for (; at_ < text_.size(); ++at_) {
      if (text_[at_] == '#') {
        at_ = std::min(text_.find('\n', at_), text_.size());
        if (at_ == text_.size()) return;
      }
      if (!blank(text_[at_])) return;
      if (text_[at_] == '\n') ++line_;
    }
  }

  template <class Belongs>
  Token run(Token::Kind kind, Belongs belongs) {
    const std::size_t begin = at_;
    while (at_ < text_.size() && belongs(text_[at_])) ++at_;
    return {kind, text_.substr(begin, at_ - begin), line_};
  }

  Token string() {
    Token token{Token::Kind::kString, "", line_};
    for (++at_; at_ < text_.size(); ++at_) {
      char c = text_[at_];
      if (c == '"') {
        ++at_;
        return token;
      }
      if (c == '\n')
        fail("the string is not closed on its line; close it with \" or put a backslash before the line end");
      if (c == '\\') {
        if (++at_ == text_.size()) break;
        c = text_[at_];
        if (c == '\n') ++line_;
        if (c == 'n') c = '\n';
        if (c == 'r') c = '\r';
        if (c == 't') c = '\t';
      }
      token.text += c;
    }
    fail("the string is not closed; close it with \"");
  }

  const std::string& text_;
  const std::string& path_;
  std::size_t at_{};
  int line_{1};
};

}  // namespace

std::vector<Token> tokenize(const std::string& text, const std::string& path) {
  Scanner scanner{text, path};
  std::vector<Token> tokens;
  do {
    tokens.push_back(scanner.next());
  } while (tokens.back().kind != Token::Kind::kEnd);
  return tokens;
}

std::string describe(const Token& token) {
  if (token.kind == Token::Kind::kEnd) return "the end of the file";
  if (token.kind == Token::Kind::kString) return "\"" + token.text + "\"";
  return "'" + token.text + "'";
}

}  // namespace fathom::launch
