// The filter over one run, compiled once for four axes and once for six.
#pragma once

#include "common/likelihood/filter.hpp"

namespace fathom::likelihood {

[[nodiscard]] PassResult run_of_four(const Problem& problem, const Hypothesis& hypothesis,
                                     const std::vector<Number>& numbers, const Noise& noise, std::size_t run,
                                     const PassOptions& options, RunReference* reference);
[[nodiscard]] PassResult run_of_six(const Problem& problem, const Hypothesis& hypothesis,
                                    const std::vector<Number>& numbers, const Noise& noise, std::size_t run,
                                    const PassOptions& options, RunReference* reference);

}  // namespace fathom::likelihood
