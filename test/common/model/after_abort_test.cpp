// after_abort of a vehicle file: what it may say, and what is refused with file and line.
#include "common/model/after_abort.hpp"

#include <doctest/doctest.h>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/model/vehicle.hpp"
#include "test/support/scratch.hpp"

using namespace fathom;
using model::AfterAbort;

namespace {

AfterAbort parse(const std::string& lines) {
  const test::Scratch scratch;
  test::write_bytes(scratch.path("v.yaml"), lines);
  return AfterAbort::load(scratch.path("v.yaml"));
}

std::string complaint(const std::string& lines) {
  return test::complaint_of<InputError>([&] { (void)parse("after_abort:\n" + lines); });
}

}  // namespace

TEST_CASE("after_abort: units and limits, and zero thrust where the file says nothing") {
  CHECK(parse("name: x\n").action == AfterAbort::Action::kZero);
  const AfterAbort after =
      parse("after_abort: {action: surface, speed: 20 cm/s, largest: 25 N, duration: 2 min, blind: 5 N}\n");
  CHECK(after.action == AfterAbort::Action::kSurface);
  CHECK(after.speed == doctest::Approx(0.2));
  CHECK(after.largest == 25.0);
  CHECK(after.duration == 120.0);
  CHECK(after.blind == 5.0);
  CHECK(complaint("  action: dive\n").find("zero, hold_depth, surface") != std::string::npos);
  CHECK(complaint("  action: hold_depth\n  duration: 60 s\n").find("largest") != std::string::npos);
  CHECK(complaint("  action: hold_depth\n  largest: 5 m\n  duration: 60 s\n").find("largest") != std::string::npos);
  CHECK(complaint("  action: hold_depth\n  largest: 5 N\n  duration: 2 h\n").find("3600") != std::string::npos);
  CHECK(complaint("  action: surface\n  largest: 5 N\n  duration: 60 s\n  speed: 3 m/s\n").find("1 m/s") !=
        std::string::npos);
  CHECK(complaint("  action: surface\n  largest: 5 N\n  duration: 60 s\n  speed: 0.2 m/s\n  blind: 9 N\n")
            .find("'blind'") != std::string::npos);
}

TEST_CASE("after_abort: a vehicle file with it is read as ever; a vehicle that cannot heave is refused") {
  const std::string known = test::read_bytes(std::string{FATHOM_SOURCE_DIR} + "/config/vehicles/bluerov2.yaml");
  const test::Scratch scratch;
  test::write_bytes(scratch.path("v.yaml"),
                    known + "after_abort: {action: hold_depth, largest: 20 N, duration: 60 s}\n");
  CHECK(model::Vehicle::load(scratch.path("v.yaml")).name == "BlueROV2");
  test::write_bytes(scratch.path("v.yaml"),
                    known + "after_abort: {action: hold_depth, largest: 20 N, duration: 60 s, depth: 3 m}\n");
  CHECK_THROWS_AS((void)model::Vehicle::load(scratch.path("v.yaml")), InputError);  // a key that nobody reads
  const std::string flat =
      "name: Box\nwater_density: 1000 kg/m^3\nmass: 8 kg\ndof: [surge]\n"
      "thrusters:\n  - {name: stern, position: 0 0 0 m, axis: 1 0 0}\n"
      "after_abort: {action: hold_depth, largest: 20 N, duration: 60 s}\n";
  test::write_bytes(scratch.path("v.yaml"), flat);
  CHECK(test::complaint_of<InputError>([&] { (void)model::Vehicle::load(scratch.path("v.yaml")); }).find("heave") !=
        std::string::npos);
}
