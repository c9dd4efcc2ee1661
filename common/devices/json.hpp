// A strict cursor over one JSON text, without allocation: for instruments that send a hundred lines a second.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace fathom::devices {

/// Every function leaves the cursor behind what it read; once something was wrong, good() stays false.
class JsonCursor {
 public:
  explicit JsonCursor(std::string_view text) : text_{text} {}
  [[nodiscard]] bool good() const { return good_; }
  /// True when nothing but blanks is left and all was well.
  [[nodiscard]] bool finished();

  /// Calls member(key) for each member of the object at the cursor; it must read or skip the value.
  template <class Member>
  void object(Member&& member) {
    if (!expect('{')) return;
    if (accept('}')) return;
    do {
      const std::string_view key = string();
      if (!expect(':')) return;
      member(key);
      if (!good_) return;
    } while (accept(','));
    expect('}');
  }
  /// Calls element(index) for each element of the array at the cursor.
  template <class Element>
  void array(Element&& element) {
    if (!expect('[')) return;
    if (accept(']')) return;
    std::size_t index = 0;
    do {
      element(index++);
      if (!good_) return;
    } while (accept(','));
    expect(']');
  }
  /// Escapes stay as they are.
  std::string_view string();
  std::string_view number_text();
  /// A number; nothing for null or what is no number, which is then skipped.
  std::optional<double> number();
  std::optional<bool> boolean();
  void skip();

 private:
  static constexpr int kDeepest = 8;
  void blanks();
  bool accept(char c);
  bool expect(char c);
  bool word(std::string_view literal);
  void skip(int depth);
  [[nodiscard]] char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }

  std::string_view text_;
  std::size_t at_{};
  bool good_{true};
};

}  // namespace fathom::devices
