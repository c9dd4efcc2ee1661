#include "common/exports/lcm_language.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include "common/base/error.hpp"

namespace fathom::exports {
namespace {

constexpr std::array<std::string_view, 9> kPrimitives{"int8_t", "int16_t", "int32_t", "int64_t", "byte",
                                                      "float",  "double",  "string",  "boolean"};

struct Token {
  enum class Kind : std::uint8_t { kWord, kSign, kComment, kEnd };
  Kind kind{Kind::kEnd};
  std::string text;
  std::size_t line{1};
};

class Lexer {
 public:
  explicit Lexer(std::string_view text) : text_{text} {}

  Token next() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) step();
    Token token{.line = line_};
    if (at_ == text_.size()) return token;
    const std::string_view rest = text_.substr(at_);
    const bool line = rest.starts_with("//");
    if (line || rest.starts_with("/*")) {
      const std::size_t end = std::min(line ? rest.find('\n') : rest.find("*/", 2), rest.size());
      token.kind = Token::Kind::kComment;
      token.text = words(rest.substr(2, end - std::min<std::size_t>(end, 2)));
      const std::size_t length = line ? end : std::min(end + 2, rest.size());
      for (std::size_t i = 0; i < length; ++i) step();
      return token;
    }
    const auto letter = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.'; };
    token.kind = letter(rest.front()) ? Token::Kind::kWord : Token::Kind::kSign;
    do {
      token.text += text_[at_];
      step();
    } while (token.kind == Token::Kind::kWord && at_ < text_.size() && letter(text_[at_]));
    return token;
  }

 private:
  void step() { line_ += text_[at_++] == '\n' ? 1 : 0; }

  /// A comment without the stars and line ends of its frame.
  static std::string words(std::string_view text) {
    std::string plain;
    bool begins = true;  // a line
    for (const char c : text) {
      const bool space = std::isspace(static_cast<unsigned char>(c)) != 0;
      const bool blank = space || (c == '*' && begins);
      begins = c == '\n' || (begins && blank);
      if (!blank) plain += c;
      if (blank && !plain.empty() && plain.back() != ' ') plain += ' ';
    }
    while (!plain.empty() && plain.back() == ' ') plain.pop_back();
    return plain;
  }

  std::string_view text_;
  std::size_t at_{}, line_{1};
};

void append_words(std::string& to, const std::string& words) { to += (to.empty() ? "" : " ") + words; }

class Parser {
 public:
  Parser(std::string_view text, const std::string& path) : lexer_{text}, path_{path} { advance(); }

  std::vector<Type> file() {
    std::vector<Type> types;
    while (token_.kind != Token::Kind::kEnd) {
      const std::string word = take_word("'package' or 'struct'");
      if (word == "package") {
        package_ = take_word("the package's name");
        expect(";");
      } else if (word == "struct") {
        types.push_back(structure());
      } else {
        fail("'" + word + "' is not read; 'package' and 'struct' are");
      }
    }
    return types;
  }

 private:
  Type structure() {
    type_ = Type{.package = package_, .name = take_word("the struct's name"), .comment = std::move(comment_)};
    comment_.clear();
    inside_ = true;
    expect("{");
    while (!is("}")) {
      const std::string word = take_word("a field's type, or '}'");
      if (word == "const") {
        while (!is(";") && token_.kind != Token::Kind::kEnd) advance();
      } else {
        do {
          field(word);
        } while (take(","));
      }
      expect(";");
    }
    inside_ = false;
    Type done = std::move(type_);
    type_ = {};
    advance();
    static_cast<void>(take(";"));
    return done;
  }

  void field(const std::string& type) {
    Field field{.type = type, .name = take_word("a field's name"), .sizes = {}, .comment = {}};
    while (take("[")) {
      field.sizes.push_back(take_word("an array's length"));
      check_length(field.sizes.back());
      expect("]");
    }
    type_.fields.push_back(std::move(field));
  }

  /// A number, or an earlier field that holds a whole one.
  void check_length(const std::string& size) const {
    constexpr std::size_t kMostDigits = 9;
    const bool digits = std::ranges::all_of(size, [](char c) { return c >= '0' && c <= '9'; });
    const auto counts = [&](const Field& field) {
      return field.name == size && field.sizes.empty() && (field.type.starts_with("int") || field.type == "byte") &&
             field.primitive();
    };
    if (digits ? size.size() > kMostDigits : std::ranges::none_of(type_.fields, counts))
      fail("'" + size + "' is no length: a number, or an earlier field that holds a whole one");
  }

  /// To the next token that is no comment; comments go where they belong.
  void advance() {
    while ((token_ = lexer_.next()).kind == Token::Kind::kComment) {
      append_words(!inside_               ? comment_
                   : type_.fields.empty() ? type_.comment
                                          : type_.fields.back().comment,
                   token_.text);
    }
  }
  [[nodiscard]] bool is(const char* sign) const { return token_.kind == Token::Kind::kSign && token_.text == sign; }
  bool take(const char* sign) {
    if (!is(sign)) return false;
    advance();
    return true;
  }
  void expect(const char* sign) {
    if (!take(sign)) fail("'" + std::string{sign} + "' is missing before '" + token_.text + "'");
  }
  std::string take_word(const char* what) {
    if (token_.kind != Token::Kind::kWord) fail(std::string{what} + " is missing before '" + token_.text + "'");
    std::string word = std::move(token_.text);
    advance();
    return word;
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(path_ + ":" + std::to_string(token_.line) + ": " + what);
  }

  Lexer lexer_;
  const std::string& path_;
  Token token_;
  std::string package_, comment_;
  Type type_;
  bool inside_{};
};

}  // namespace

bool Field::primitive() const { return std::ranges::find(kPrimitives, type) != kPrimitives.end(); }

std::vector<Type> types_in(std::string_view text, const std::string& path) { return Parser{text, path}.file(); }

}  // namespace fathom::exports
