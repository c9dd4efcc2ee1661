// Whether what is left comes in bursts: something that acts now and then makes a residual large for a while and leaves
// it alone for a while, whatever its sign. Noise has one size, with or without a memory, and single outliers have no
// company.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace fathom::diagnosis {

/// What of a residual its own past does not foretell, run by run; NaN beside gaps. The memory is that of ordinary
/// samples: what is large is left out, so that bursts are not taken for memory.
[[nodiscard]] std::vector<std::vector<double>> unforetold(std::span<const Eigen::VectorXd> residuals);

struct Bursts {
  double share{};         ///< of the variance, beyond what the size of ordinary samples makes of it
  double log_odds{-1.0};  ///< natural, that the sizes of neighbours are not independent
};

/// `runs`: what unforetold() gives, or other independent noise; gaps are NaN.
[[nodiscard]] Bursts bursts(std::span<const std::vector<double>> runs);

/// Log odds that the residual's size goes with `quantity`, sample by sample: three groups of equal number, from small
/// to large, differ in variance (Bartlett 1937), heavy tails and neighbours alike being allowed for.
[[nodiscard]] double size_goes_with(std::span<const std::vector<double>> runs,
                                    std::span<const std::vector<double>> quantity);

}  // namespace fathom::diagnosis
