// Stretches of runs over which it is known what drove the vehicle.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/samples/trial.hpp"

namespace fathom::verdict {

class Stretches {
 public:
  /// Stretches of at least `shortest` s. The runs are taken apart: what they held is not held twice. InputError where
  /// gaps leave none of `needed` s. `called`: how people call the runs.
  Stretches(std::vector<Trial> runs, std::span<const std::string> called, double shortest, double needed);
  [[nodiscard]] const std::vector<Trial>& trials() const { return trials_; }
  [[nodiscard]] std::vector<Trial> take() { return std::move(trials_); }
  [[nodiscard]] double whole() const { return whole_; }             ///< s
  [[nodiscard]] double left_out() const { return whole_ - kept_; }  ///< s

 private:
  std::vector<Trial> trials_;
  double whole_{}, kept_{};  // s
};

}  // namespace fathom::verdict
