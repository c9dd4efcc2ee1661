// The words of procman's configuration files, each with its line.
#pragma once

#include <string>
#include <vector>

namespace fathom::launch {

struct Token {
  enum class Kind { kSign, kName, kInteger, kString, kEnd };
  Kind kind{Kind::kEnd};
  std::string text;  ///< of a sign: one of { } = ;   of a string: without quotes, escapes resolved
  int line{};
};

/// The last token is kEnd. InputError "path:line: ..." for a character that has no meaning there.
[[nodiscard]] std::vector<Token> tokenize(const std::string& text, const std::string& path);

/// For an operator: what stands there.
[[nodiscard]] std::string describe(const Token& token);

}  // namespace fathom::launch
