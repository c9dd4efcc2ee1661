// A velocity log that reads 30 % short: kinematics sees that position and velocity differ by a factor, and the motion
// tells which of them is wrong, for couplings do not scale.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "common/tables/writer.hpp"
#include "test/support/scratch.hpp"
#include "test/support/shell.hpp"
#include "test/support/virtual_dive.hpp"

namespace fathom {
namespace {

using test::program;
using test::Ran;
using test::Scratch;
using test::shell;

nlohmann::json diagnosed(const Scratch& scratch, const std::string& dof) {
  test::write_bytes(scratch.path("v.yaml"),
                    "name: Sled\ndof: [" + dof +
                        "]\nwater_density: 1000 kg/m^3\nmass: 20 kg\ninertia: 0.5 0.8 1 kg m^2\n"
                        "priors:\n  m_X: {mean: 25 kg, sigma: 25 kg}\n" +
                        (dof.find("sway") == std::string::npos ? "" : "  m_Y: {mean: 40 kg, sigma: 40 kg}\n"));
  const model::Vehicle vehicle = model::Vehicle::load(scratch.path("v.yaml"));
  std::mt19937 random{7};
  std::normal_distribution<double> normal;
  for (const char* name : {"one", "two"}) {
    auto dive = test::make_dive(vehicle, {.duration = 100.0, .seed = 7, .spread = 0.0, .wrench = true});
    for (std::size_t k = 0; k < dive.trial.size(); ++k) {
      for (double& along : dive.trial.p_WB[k].reshaped()) along += 2e-3 * normal(random);
      dive.trial.nu[k].head<3>() *= 0.7;
    }
    tables::write_file(scratch.path(std::string{name} + ".csv"), tables::to_csv(dive.trial));
  }
  const Ran ran =
      shell(program("fathom") + " diagnose --no-learning --vehicle " + scratch.path("v.yaml") + " --train " +
            scratch.path("one.csv") + " --validate " + scratch.path("two.csv") + " --out " + scratch.path("out"));
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  return nlohmann::json::parse(test::read_bytes(scratch.path("out/result.json")));
}

}  // namespace

TEST_CASE("either scale: a craft that turns as it moves shows that the velocity log is wrong, and by how much") {
  const Scratch scratch;
  const auto result = diagnosed(scratch, "surge, sway, yaw");
  CAPTURE(result.at("paragraph"));
  REQUIRE(result.at("effects").size() == 1);
  CHECK(result.at("effects").at(0).at("name") == "sensor_scale");
  const double error = result.at("effects").at(0).at("parameters").at("dvl.error").at("value");
  CHECK(error == doctest::Approx(-0.3).epsilon(0.02));
  CHECK(result.at("verdict") == "effect");
}

}  // namespace fathom
