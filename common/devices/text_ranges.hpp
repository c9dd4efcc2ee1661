// Acoustic ranges as plain text: "north=12.34 east=8.90 south= west=11.02 deep=20.5", metres.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "common/devices/settings.hpp"
#include "common/devices/text_lines.hpp"

namespace fathom::devices {

/// Any of the configured names in any order; one that is missing or empty was not measured. A name that is not
/// configured, or that stands twice, refuses the line. Blanks or commas between.
class TextRanges final : public TextLines {
 public:
  explicit TextRanges(const Settings& settings);
  void describe(Fields& fields) const override;

 private:
  static constexpr std::size_t kMost = 32;
  using Values = std::array<std::optional<double>, kMost>;
  [[nodiscard]] bool accepts(std::string_view line) const override;
  void line(std::string_view line, Frame& frame) override;
  [[nodiscard]] bool read(std::string_view line, Values& values) const;

  std::vector<std::string> names_;
  std::string_view line_;
  mutable Values values_;  ///< of the line that was accepted last
  Ranges sample_;
};

}  // namespace fathom::devices
