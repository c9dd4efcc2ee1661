#include "common/model/after_abort.hpp"

#include "common/base/config.hpp"
#include "common/model/priors/bounded.hpp"

namespace fathom::model {

AfterAbort AfterAbort::from(const Config& section) {
  constexpr double kFastest = 1.0;     // m/s: no vehicle that is identified with holds its depth at more
  constexpr double kLongest = 3600.0;  // s: then the battery of a small one is empty
  AfterAbort after;
  const std::string action = section.text("action");
  if (action == "zero") {
    after.action = Action::kZero;
  } else if (action == "hold_depth") {
    after.action = Action::kHoldDepth;
  } else if (action == "surface") {
    after.action = Action::kSurface;
  } else {
    section.fail("action", "no action '" + action + "'; known: zero, hold_depth, surface");
  }
  if (after.action == Action::kZero) return after;
  after.largest = bounded::positive(section, "largest", "N");
  after.duration = bounded::positive(section, "duration", "s");
  if (after.duration > kLongest) section.fail("duration", "'duration' must not be longer than 3600 s");
  if (after.action == Action::kSurface) {
    after.speed = bounded::positive(section, "speed", "m/s");
    if (after.speed > kFastest) section.fail("speed", "'speed' must not be above 1 m/s");
    if (section.has("blind")) after.blind = bounded::not_negative(section, "blind", "N");
    if (after.blind > after.largest) section.fail("blind", "'blind' must not be above 'largest'");
  }
  return after;
}

AfterAbort AfterAbort::load(const std::string& path) {
  const Config file = Config::load(path);
  return file.has("after_abort") ? from(file.section("after_abort")) : AfterAbort{};
}

const char* name(AfterAbort::Action action) {
  switch (action) {
    case AfterAbort::Action::kHoldDepth:
      return "holds its depth";
    case AfterAbort::Action::kSurface:
      return "goes to the surface";
    default:
      return "zero thrust";
  }
}

}  // namespace fathom::model
