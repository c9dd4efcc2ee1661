// Load cells that send text: all readings in one line, or one named reading per line.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "common/devices/settings.hpp"
#include "common/devices/text_lines.hpp"

namespace fathom::devices {

/// "+00032.100", "12.1 N, 13.0 N" (as many readings as cells, blanks, commas or semicolons between), or
/// "umbilical=12.1 N" (a sample when every cell has said something new). A unit word must be the configured one.
class LoadText final : public TextLines {
 public:
  explicit LoadText(const Settings& settings);
  void describe(Fields& fields) const override;

 private:
  static constexpr std::size_t kMost = 16;
  struct Readings {
    std::array<double, kMost> value{};
    std::array<bool, kMost> there{};
    std::size_t count{};
  };
  [[nodiscard]] bool accepts(std::string_view line) const override;
  void line(std::string_view line, Frame& frame) override;
  [[nodiscard]] bool read(std::string_view line, Readings& readings) const;
  [[nodiscard]] bool read_named(std::string_view line, std::size_t equals, Readings& readings) const;

  std::vector<LoadCell> cells_;
  std::string_view line_;
  mutable Readings readings_;  ///< of the line that was accepted last
  std::array<bool, kMost> fresh_{};
  Loads sample_;
};

}  // namespace fathom::devices
