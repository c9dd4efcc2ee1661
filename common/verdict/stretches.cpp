#include "common/verdict/stretches.hpp"

#include <algorithm>
#include <utility>

#include "common/base/error.hpp"
#include "common/estimation/split.hpp"
#include "common/estimation/wording.hpp"

namespace fathom::verdict {
namespace {

double duration(const Trial& trial) { return static_cast<double>(trial.size()) * trial.dt; }

}  // namespace

Stretches::Stretches(std::vector<Trial> runs, std::span<const std::string> called, double shortest, double needed) {
  double longest = 0.0, lost = 0.0;
  std::size_t gaps = 0;
  const bool several = runs.size() > 1;
  for (Trial& run : runs) {
    whole_ += duration(run);
    const estimation::InputGaps missing = estimation::input_gaps(run);
    gaps += missing.count;
    lost += missing.total;
    for (Trial& stretch : estimation::known_stretches(std::exchange(run, {}), shortest)) {
      longest = std::max(longest, duration(stretch));
      kept_ += duration(stretch);
      trials_.push_back(std::move(stretch));
    }
  }
  if (gaps == 0 || longest > needed) return;
  throw InputError(
      called.front() + (several ? " and its fellows" : "") +
      estimation::text(": what drove the vehicle is missing for %.3g s of %.4g s", lost, whole_) +
      estimation::text(", and no stretch of %.3g s is left between the %.0f gaps", needed, static_cast<double>(gaps)) +
      "; record motion and thrusters together without pauses, or log at a steady rate");
}

}  // namespace fathom::verdict
