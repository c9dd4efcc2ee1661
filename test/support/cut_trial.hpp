// A stretch of a trial as a trial of its own, for training and validation runs out of one dive.
#pragma once

#include <cstddef>

#include "common/samples/trial.hpp"

namespace fathom::test {

/// Samples [begin, end) of `trial`; its time goes on.
inline Trial cut_trial(const Trial& trial, std::size_t begin, std::size_t end) {
  Trial part = trial;
  const auto keep = [&](auto& values) {
    if (values.empty()) return;
    values.erase(values.begin() + static_cast<std::ptrdiff_t>(end), values.end());
    values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(begin));
  };
  keep(part.t);
  keep(part.p_WB);
  keep(part.q_WB);
  keep(part.nu);
  keep(part.pose_valid);
  keep(part.velocity_valid);
  keep(part.rates_valid);
  keep(part.input);
  keep(part.input_valid);
  keep(part.voltage);
  keep(part.columns);
  return part;
}

}  // namespace fathom::test
