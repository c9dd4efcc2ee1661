// Teledyne PD6 and PD13: ensembles of text lines (":BS,..." and the like), without checksum. The vehicle's sign.
#pragma once

#include <array>
#include <string_view>

#include "common/devices/parser.hpp"
#include "common/devices/settings.hpp"
#include "common/devices/text.hpp"
#include "common/devices/velocity/janus.hpp"

namespace fathom::devices {

/// Every line is a frame; an ensemble gives its sample at ":BD", or at the next ":SA" where that line was damaged.
/// There is no checksum, so the grammar is strict: the right number of fields, each a number.
class Pd6 final : public Parser {
 public:
  explicit Pd6(const Settings& settings);
  void describe(Fields& fields) const override;

 private:
  static constexpr std::size_t kMostFields = 7;
  struct Line {
    std::array<char, 2> tag{};
    std::array<std::string_view, kMostFields> field{};
    std::size_t count{};
    [[nodiscard]] std::string_view name() const { return {tag.data(), tag.size()}; }
  };

  Look look(Bytes bytes) const override;
  void take(Frame& frame) override;
  [[nodiscard]] static std::optional<Line> read(std::string_view text);
  void begin_ensemble();
  void end_ensemble(Frame& frame, double altitude);
  [[nodiscard]] std::optional<Eigen::Vector3d> velocity() const;
  [[nodiscard]] std::optional<Eigen::Vector3d> bottom(std::size_t status) const;

  Settings settings_;
  std::string_view text_;
  Line line_;
  DvlPose pose_;
  std::optional<double> time_;
  std::optional<Eigen::Vector3d> instrument_, ship_, earth_;
  bool open_{false};  ///< bottom track has been read that no sample tells yet
  Dvl sample_;
};

}  // namespace fathom::devices
