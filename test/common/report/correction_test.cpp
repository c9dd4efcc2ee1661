#include "common/report/correction.hpp"

#include <doctest/doctest.h>

#include <string>

#include "common/base/error.hpp"
#include "common/model/learned/learned_file.hpp"
#include "common/report/json.hpp"
#include "common/report/table.hpp"
#include "test/support/scratch.hpp"

using namespace fathom;

namespace {

DiagnosisResult diagnosed() {
  DiagnosisResult result;
  result.vehicle = "BlueROV2";
  result.verdict = "unexplained";
  result.parameters_after = {{"m_X", 21.5, 0.1, "kg"}, {"command offset", 0.01, 0.001, "s"}};
  CorrectionGiven given{.asked = true, .adopted = true, .carried = true, .words = "A correction, not a cause."};
  given.terms.push_back(
      {"velocity", 1, {{"velocity", 0, 0, 0.0, 1.0, 1.0}, {"speed", 0, 0, 0.0, 1.0, 1.0}}, 2.5, -0.125, 0.01, true});
  given.terms.push_back({"place, toward north", 6, {{"plan_bump", 0, 0, 1.0, -2.0, 0.75}}, 1.5, 0.5, 0.01});
  given.terms.push_back({"time", 0, {{"after", 0, 0, 12.0, 0.3, 1.0}}, 1.0, 2.0, 0.1});
  // A swing that has no wave number is no width of nothing.
  given.terms.push_back({"a swing", 29, {{"travel_cosine", 0, 0, 1.2, 0.0, 0.0}}, 1.0, 0.1, 0.1, true});
  given.covariance.assign(4, std::vector<double>(4, 0.0));
  for (std::size_t k = 0; k < 4; ++k) given.covariance[k][k] = k < 2 ? 1e-4 : 1e-2;
  given.visited_nu.fill(0.8);
  given.visited_tau.fill(30.0);
  given.visited_force.assign(6, 20.0);
  result.correction = given;
  return result;
}

/// A file of its own for every case: they run side by side.
struct Written {
  explicit Written(const std::string& text) { test::write_bytes(path, text); }
  test::Scratch folder;
  std::string path{folder.path("correction.json")};
};

}  // namespace

TEST_CASE("correction: what result.json holds is read back as the same force, without what depends on time") {
  const model::Vehicle vehicle =
      model::Vehicle::load(std::string(FATHOM_SOURCE_DIR) + "/config/vehicles/bluerov2.yaml");
  const Written file{report::to_json(diagnosed())};
  const model::LearnedModel read = model::read_learned(file.path, vehicle);
  REQUIRE(read.parameters.size() == 1);
  CHECK(read.parameters[0] == std::pair<std::string, double>{"m_X", 21.5});
  REQUIRE(read.force != nullptr);
  REQUIRE(read.force->force().features.size() == 2);
  CHECK(read.force->force().groups[0].closed);
  CHECK_FALSE(read.force->force().groups[1].closed);
  model::Motion motion{
      .p_WB = {1.0, -2.0, 3.0}, .nu = Vector6d::Unit(0) * 0.4, .force = model::ActuatorForces::Zero(6)};
  model::Load load;
  load.clear();
  load.drag = Vector6d::Constant(-100.0);
  read.force->load(motion, {}, 0, load);
  CHECK(load.wrench[1] == doctest::Approx(-0.125 * 2.5 * 0.16));
  CHECK(load.wrench[0] == doctest::Approx(0.5 * 1.5));
}

TEST_CASE("correction: a pull is read back with its point, zeros and all, and its length; with one missing it is not") {
  const model::Vehicle vehicle =
      model::Vehicle::load(std::string(FATHOM_SOURCE_DIR) + "/config/vehicles/bluerov2.yaml");
  DiagnosisResult result = diagnosed();
  result.correction->terms = {
      {"a pull toward a point", model::kPull, {{"stretch", 0, 0, 0.0, 0.0, 3.0, 1.25}}, 2.0, 0.5, 0.01, true}};
  result.correction->covariance = {{1e-4}};
  std::string text = report::to_json(result);
  {
    const Written file{text};
    const model::LearnedModel read = model::read_learned(file.path, vehicle);
    REQUIRE(read.force != nullptr);
    REQUIRE(read.force->force().features.size() == 1);
    CHECK(read.force->force().features[0].pulls());
    CHECK(read.force->force().features[0].factors[0] ==
          model::Factor{.quantity = model::Quantity::kStretch, .a = 0.0, .b = 0.0, .c = 3.0, .d = 1.25});
  }
  const std::size_t at = text.find("\"c\":", text.find("\"stretch\""));
  REQUIRE(at != std::string::npos);
  const Written damaged{text.replace(at, 4, "\"z\":")};
  CHECK_THROWS_WITH_AS((void)model::read_learned(damaged.path, vehicle), doctest::Contains("'c'"), InputError);
}

TEST_CASE("correction: a file of another vehicle, or no result at all, is refused with its line") {
  const model::Vehicle vehicle =
      model::Vehicle::load(std::string(FATHOM_SOURCE_DIR) + "/config/vehicles/bluerov2.yaml");
  DiagnosisResult other = diagnosed();
  other.vehicle = "Hydrone";
  const Written foreign{report::to_json(other)};
  CHECK_THROWS_WITH_AS((void)model::read_learned(foreign.path, vehicle),
                       doctest::Contains("this is a model of Hydrone"), InputError);
  DiagnosisResult short_of_thrusters = diagnosed();
  short_of_thrusters.correction->visited_force.pop_back();
  const Written five{report::to_json(short_of_thrusters)};
  CHECK_THROWS_WITH_AS((void)model::read_learned(five.path, vehicle), doctest::Contains("learned with 5 thrusters"),
                       InputError);
}

TEST_CASE("correction: it stands apart from causes, and a refused one says why") {
  DiagnosisResult result = diagnosed();
  CHECK(report::correction_section(result).find("A correction, not a cause") != std::string::npos);
  CHECK(report::to_table(result).find("Correction: no cause") != std::string::npos);
  result.correction->adopted = result.correction->carried = false;
  result.correction->refused = "log odds 8, at least 20 needed";
  CHECK(report::correction_section(result).find("at least 20 needed") != std::string::npos);
  result.correction.reset();
  CHECK(report::correction_section(result).empty());
}

TEST_CASE("correction: the first screen has a line of it; the whole sentence folds out") {
  CorrectionGiven given = *diagnosed().correction;
  given.size = 0.123;
  given.held_out = 0.75;
  const std::string line = report::correction_line(given);
  const std::string seen = line.substr(0, line.find("<details>"));
  CHECK(seen.find("12 %") != std::string::npos);
  CHECK(seen.find("velocity and 3 more") != std::string::npos);
  CHECK(seen.find("25 % lower") != std::string::npos);
  CHECK(seen.find(given.words) == std::string::npos);
  CHECK(line.find(given.words) != std::string::npos);
  // An equation, where it can be read at a glance.
  given.formula = FormulaGiven{.equation = "tau_Z = c w w"};
  CHECK(report::correction_line(given).find("tau_Z = c w w") != std::string::npos);
  given.formula->equation = std::string(200, 'x');
  CHECK(report::correction_line(given).find("velocity and 3 more") != std::string::npos);
  // What has a place is looked for there.
  given.terms.insert(
      given.terms.begin(),
      {"a pull toward a point", model::kPull, {{"stretch", 0, 0, 1.5, -2.0, 3.0, 1.25}}, 2.0, 0.5, 0.01, true});
  CHECK(
      report::correction_line(given).find("a pull toward a point: point at N 1.5 m, E -2 m, D 3 m, acting from 1.25 m "
                                          "away, and 4 more") != std::string::npos);
  CHECK(report::correction_line(given).find("Look for") == std::string::npos);
  given.look_for = "a tether that is made fast there";
  CHECK(report::correction_line(given).find("Look for a tether that is made fast there") != std::string::npos);
}
