// What a complementary filter lets through of a measured sine (Karras et al., Figures 1.4 and 1.5), for its gains as
// they are, sample by sample; the rest comes from what the filter integrates.
#pragma once

#include <complex>

#include "common/estimation/online/complementary_filter.hpp"

namespace fathom::estimation {

/// Estimate over measurement, both sampled every `dt` [s], behind the correction. One minus it is the share of the
/// integrated rate (first order; `gains.rate` zero) or acceleration (second order). Frequency in Hz, below 1/(2 dt).
[[nodiscard]] std::complex<double> frequency_response(const Gains& gains, double dt, double frequency);

}  // namespace fathom::estimation
