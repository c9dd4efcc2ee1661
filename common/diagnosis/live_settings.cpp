// The diagnoser's section of a pipeline file.
#include "common/base/config.hpp"
#include "common/diagnosis/live_diagnoser.hpp"

namespace fathom::diagnosis {

LiveSettings LiveSettings::from(const Config& config) {
  LiveSettings s;
  const auto positive = [&](const char* key, const char* unit) {
    const double value = config.quantity(key, unit);
    if (!(value > 0.0)) config.fail(key, std::string("'") + key + "' must be positive");
    return value;
  };
  s.window = positive("window", "s");
  s.stride = positive("stride", "s");
  s.max_gap = positive("max_gap", "s");
  s.warm_up = positive("warm_up", "s");
  s.block = positive("block", "s");
  s.fewest_blocks = config.integer("fewest_blocks");
  s.most_blocks = config.integer("most_blocks");
  if (s.fewest_blocks < 3)
    config.fail("fewest_blocks", "'fewest_blocks' must be 3 at least: odds rest on their spread");
  if (s.most_blocks < 2 * s.fewest_blocks)
    config.fail("most_blocks", "'most_blocks' must be twice 'fewest_blocks' at least");
  s.accept_log_odds = config.quantity("accept_log_odds", "");
  s.smallest_reduction = config.quantity("smallest_reduction", "");
  s.alias_correlation = config.quantity("alias_correlation", "");
  s.alternative_log_odds = config.quantity("alternative_log_odds", "");
  const std::string input = config.text("input");
  if (input != "linear" && input != "hold") config.fail("input", "input is '" + input + "'; write linear or hold");
  s.interpolate_input = input == "linear";
  s.max_input_gap = positive("max_input_gap", "s");
  s.max_skew = config.quantity("max_skew", "s");
  if (s.max_skew < 0.0) config.fail("max_skew", "'max_skew' must not be negative");
  return s;
}

}  // namespace fathom::diagnosis
