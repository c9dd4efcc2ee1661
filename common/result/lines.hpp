// Titles and indented, wrapped lines for a terminal.
#pragma once

#include <string>
#include <string_view>

#include "common/report/table.hpp"
#include "common/report/text.hpp"

namespace fathom::result {

class Lines {
 public:
  void title(const std::string& words) {
    if (!text_.empty()) text_ += '\n';
    text_ += words + '\n';
  }
  /// Wrapped behind `head`, which takes `indent` columns.
  void line(const std::string& words, const std::string& head = "", std::size_t indent = 4) {
    std::string start = report::pad_right(head, indent);
    if (head.empty()) start = std::string(indent, ' ');
    for (const std::string& part : report::wrap(words, report::kTableColumns - indent)) {
      text_ += start + part + '\n';
      start = std::string(indent, ' ');
    }
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

}  // namespace fathom::result
