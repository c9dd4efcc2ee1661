#include "common/likelihood/filter_pass.hpp"
#include "common/likelihood/filter_run.hpp"

namespace fathom::likelihood {

PassResult run_of_six(const Problem& problem, const Hypothesis& hypothesis, const std::vector<Number>& numbers,
                      const Noise& noise, std::size_t run, const PassOptions& options, RunReference* reference) {
  return RunPass<6>{problem, hypothesis, numbers, noise, run, options, reference}.run();
}

}  // namespace fathom::likelihood
