#include "common/devices/text_ranges.hpp"

#include <algorithm>

#include "common/devices/text.hpp"

namespace fathom::devices {
namespace {

constexpr std::string_view kBetween = " ,\t";

}  // namespace

TextRanges::TextRanges(const Settings& settings) : names_{settings.transponders} {
  if (names_.empty()) names_ = {"r1", "r2", "r3", "r4", "r5", "r6", "r7", "r8"};
  names_.resize(std::min(names_.size(), kMost));
  sample_.range.resize(names_.size());
  sample_.valid.resize(names_.size());
}

bool TextRanges::read(std::string_view line, Values& values) const {
  values = {};
  std::uint32_t seen = 0;
  for (std::string_view word = next_word(line, kBetween); !word.empty(); word = next_word(line, kBetween)) {
    const std::size_t equals = word.find('=');
    if (equals == std::string_view::npos) return false;
    const auto name = std::find(names_.begin(), names_.end(), word.substr(0, equals));
    if (name == names_.end()) {
      complain("a range to a transponder that 'transponders' does not name");
      return false;
    }
    const auto index = static_cast<std::size_t>(name - names_.begin());
    if ((seen >> index & 1U) != 0) return false;
    seen |= 1U << index;
    const std::string_view text = word.substr(equals + 1);
    if (text.empty()) continue;
    values[index] = number(text);
    if (!values[index]) return false;
  }
  return seen != 0;
}

bool TextRanges::accepts(std::string_view line) const { return read(line, values_); }

void TextRanges::line(std::string_view line, Frame& frame) {
  line_ = line;
  for (std::size_t i = 0; i < names_.size(); ++i) {
    const bool valid = values_[i] && *values_[i] > 0.0;
    sample_.valid[i] = valid;
    sample_.range[i] = valid ? *values_[i] : 0.0;
  }
  frame.sample = &sample_;
}

void TextRanges::describe(Fields& fields) const {
  fields.add("line", line_);
  for (std::size_t i = 0; i < names_.size(); ++i) fields.add(names_[i], values_[i]);
}

}  // namespace fathom::devices
