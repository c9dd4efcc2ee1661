// The diagnoser's section of a pipeline file.
#include "common/base/config.hpp"
#include "common/diagnosis/live_diagnoser.hpp"

namespace fathom::diagnosis {

LiveSettings LiveSettings::from(const Config& config) {
  LiveSettings s;
  s.window = config.positive("window", "s");
  s.stride = config.positive("stride", "s");
  s.max_gap = config.positive("max_gap", "s");
  s.warm_up = config.positive("warm_up", "s");
  s.block = config.positive("block", "s");
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
  s.interpolate_input = config.either("input", "linear", "hold");
  s.max_input_gap = config.positive("max_input_gap", "s");
  s.max_skew = config.not_negative("max_skew", "s");
  if (config.has("mounting")) s.mounting = config.not_negative("mounting", "rad");
  if (config.has("largest_ratio")) s.largest_ratio = config.positive("largest_ratio", "");
  return s;
}

}  // namespace fathom::diagnosis
