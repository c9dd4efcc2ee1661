// From increment fits to named faults: which axes, which sign, what scale, turn, bias, lever arm and delay; what of it
// is significant, large enough to matter, and shared by all recordings. Known to the pair_*.cpp files only; the rest of
// the room calls compare().
#pragma once

#include <utility>

#include "common/consistency/increments/increment_estimate.hpp"
#include "common/consistency/pairs/pair.hpp"

namespace fathom::consistency {

constexpr double kLeastExplained = 0.3;  ///< robust R^2 below which a pair says nothing about delay or scale

class Comparison {
 public:
  Comparison(const PairNames& names, std::span<const std::string> runs, std::vector<IncrementFit> fits)
      : names_(names), runs_(runs) {
    result_.fits = std::move(fits);
    result_.faults.resize(runs.size());
  }
  [[nodiscard]] PairResult run();

 private:
  [[nodiscard]] const IncrementFit& fit(std::size_t run) const { return result_.fits[run]; }
  void see_columns();
  void find_axes();
  void find_scales();
  void find_turns();
  void find_offsets();
  void find_delay();
  /// One statement, and findings where it says "disagree". `practical`: the size of a fault that must not be missed.
  void report(const SharedValue& decision, const std::string& signal, const std::string& finding,
              const std::string& unit, double neutral, double practical, const std::string& action,
              const std::string& more = "");
  [[nodiscard]] std::string axis(int k) const { return names_.signal + "." + names_.axes[static_cast<std::size_t>(k)]; }
  [[nodiscard]] std::string describe(const Eigen::Matrix3d& P, int body) const;

  const PairNames& names_;
  std::span<const std::string> runs_;
  PairResult result_;
  std::vector<std::array<bool, 3>> seen_;  ///< per recording, logged axis
  std::vector<Eigen::Matrix3d> turned_;    ///< per recording: permutation and large turn
};

}  // namespace fathom::consistency
