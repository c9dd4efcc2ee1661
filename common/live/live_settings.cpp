// The diagnoser's section of a pipeline file.
#include "common/live/live_settings.hpp"

#include "common/base/config.hpp"

namespace fathom::live {

LiveSettings LiveSettings::from(const Config& config) {
  LiveSettings s;
  s.first_look = config.positive("first_look", "s");
  s.interval = config.positive("interval", "s");
  s.max_skew = config.not_negative("max_skew", "s");
  s.keep = config.positive("keep", "s");
  if (config.has("threads")) s.threads = config.integer("threads");
  if (s.threads < 1) config.fail("threads", "'threads' must be 1 at least");
  return s;
}

}  // namespace fathom::live
