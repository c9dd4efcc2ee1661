// The Python module, asked as a user asks it (python_module.py), and its examples.
#include <doctest/doctest.h>

#include <filesystem>

#include "common/tables/writer.hpp"
#include "test/support/schema.hpp"
#include "test/support/scratch.hpp"
#include "test/support/shell.hpp"
#include "test/support/virtual_dive.hpp"

namespace fathom {

TEST_CASE("python: recordings, models, check and diagnosis from the module, and its examples") {
  const std::string package = std::string{FATHOM_BINARY_DIR} + "/python";
  if (!std::filesystem::exists(package + "/fathom")) {
    MESSAGE("skipped: the module was not built (scripts/packages-python.txt)");
    return;
  }
  if (!test::python_has("numpy")) return;
  const test::Scratch scratch;
  test::write_bytes(
      scratch.path("V.yaml"),
      "name: Sled\ndof: [surge, sway, heave, roll, pitch, yaw]\nmass: 12 kg\nwater_density: 1000 kg/m^3\n");
  const model::Vehicle vehicle = model::Vehicle::load(scratch.path("V.yaml"));
  const auto dive = test::make_dive(vehicle, {.duration = 40.0, .seed = 1, .wrench = true});
  tables::write_file(scratch.path("DIVE.csv"), tables::to_csv(dive.trial));
  REQUIRE(
      test::shell("cd '" + scratch.path("") + "' && " + test::program("fathom") + " import DIVE.csv --out RUN.lcmlog")
          .code == 0);
  const test::Ran ran =
      test::shell("PYTHONDONTWRITEBYTECODE=1 PYTHONPATH='" + package + "' " + test::kDebianPython + " " +
                  test::file("test/processes/offline/python_module.py") + " '" + scratch.path("") + "'");
  CHECK_MESSAGE(ran.code == 0, ran.text);
  CHECK(ran.says("Ran 12 tests"));
}

}  // namespace fathom
