// Candidate columns: how they are written, what is wrong with them, and the force of their effect.
#include "common/model/candidates/candidate.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "common/base/error.hpp"
#include "common/model/candidates/column_effect.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::model;

namespace {

std::string complaint(const std::string& text) {
  try {
    static_cast<void>(parse_candidate(text));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

bool says(const std::string& text, const std::string& words) {
  const std::string said = complaint(text);
  CAPTURE(said);
  return said.starts_with("candidate '" + text + "': ") && said.find(words) != std::string::npos;
}

/// A trial of 2 n samples whose columns are low, then high.
Trial with_columns(const Vehicle& vehicle, double low, double high, const std::string& unit, std::size_t n = 10) {
  Trial trial{.name = "run", .dt = 0.1, .observed = {.attitude = true, .velocity = true}};
  for (std::size_t k = 0; k < 2 * n; ++k) {
    trial.t.push_back(0.1 * static_cast<double>(k));
    trial.nu.push_back(Vector6d::Constant(0.5));
    trial.input.push_back(Eigen::VectorXd::Constant(vehicle.allocation.cols(), 4.0));
    Eigen::VectorXd columns(2 * vehicle.candidates.size());
    for (Eigen::Index i = 0; i < columns.size(); i += 2) columns.segment(i, 2) << (k < n ? low : high), 0.0;
    trial.columns.push_back(columns);
  }
  trial.column_units.assign(vehicle.candidates.size(), unit);
  return trial;
}

Vehicle asking(const std::string& text) {
  Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  add_candidate(text, vehicle.candidates);
  return vehicle;
}

int form_of(const Effect& effect, const std::string& name) {
  const auto names = effect.variants({});
  const auto found = std::ranges::find(names, name);
  CAPTURE(name);
  REQUIRE(found != names.end());
  return static_cast<int>(found - names.begin());
}

}  // namespace

TEST_CASE("candidate: a product of columns, powers and the model's own motion, along a bearing") {
  const Candidate plain = parse_candidate(" wind_speed ");
  CHECK(plain.text == "wind_speed");
  REQUIRE(plain.columns.size() == 1);
  CHECK(plain.columns[0].power == 1);
  CHECK(plain.model.empty());
  const Candidate whole = parse_candidate("|tension|^2 * \"winch length\"*tau_X*u^3 @ wind_direction");
  REQUIRE(whole.columns.size() == 2);
  CHECK(whole.columns[0].name == "tension");
  CHECK(whole.columns[0].size);
  CHECK(whole.columns[0].power == 2);
  CHECK(whole.columns[1].name == "winch length");
  REQUIRE(whole.model.size() == 2);
  CHECK(whole.model[0].name == "tau_X");
  CHECK(whole.model[1].power == 3);
  CHECK(whole.bearing == "wind_direction");
  // What is quoted is a column, whatever the model calls so.
  CHECK(parse_candidate("\"r\"").columns[0].name == "r");
  CHECK(effect_name(plain) == "column wind_speed");
}

TEST_CASE("candidate: what cannot be one is told in a line") {
  CHECK(says("", "a name is missing at its end"));
  CHECK(says("wind*", "a name is missing at its end"));
  CHECK(says("wind**2", "wind_speed^2"));
  CHECK(says("wind^5", "from 1 to 4"));
  CHECK(says("wind^0.5", "from 1 to 4"));
  CHECK(says("wind^12", "from 1 to 4"));
  CHECK(says("2*wind", "its coefficient is what is sought"));
  CHECK(says("wind + rain", "give each by itself"));
  CHECK(says("wind/rain", "products and powers only"));
  CHECK(says("u*tau_X", "names no measured column"));
  CHECK(says("|wind", "a | is not closed"));
  CHECK(says("\"wind", "a \" is not closed"));
  CHECK(says("wind speed", "stands in \"...\""));
  CHECK(says("wind @", "a name is missing at its end"));
  std::vector<Candidate> all;
  add_candidate("wind", all);
  CHECK_THROWS_WITH_AS(add_candidate(" wind", all), "candidate 'wind': given twice", InputError);
}

TEST_CASE("candidate: units multiply") {
  CHECK(power_of_unit("m/s", 2) == "(m/s)^2");
  CHECK(power_of_unit("V", 2) == "V^2");
  CHECK(power_of_unit("m/s", 1) == "m/s");
  CHECK(power_of_unit("", 2).empty());
  CHECK(times_unit("V", "m/s") == "V m/s");
  CHECK(times_unit("", "m/s") == "m/s");
}

TEST_CASE("column effect: its force is coefficient times column, along an axis, in the world, or along a bearing") {
  const Vehicle vehicle = asking("wind_speed^2*u");
  const Trial trial = with_columns(vehicle, 0.0, 8.0, "(m/s)^2");
  const Candidates candidates = candidates_of(vehicle, {&trial, 1});
  REQUIRE(candidates.effects.size() == 1);
  const Effect& effect = *candidates.effects.front();
  CHECK(effect.name() == "column wind_speed^2*u");
  const std::vector columns{6.0, std::numbers::pi / 2.0};
  Motion motion;
  motion.nu << 0.5, 0.0, 0.0, 0.0, 0.0, 0.0;
  motion.R_WB = Eigen::AngleAxisd{std::numbers::pi / 2.0, Eigen::Vector3d::UnitZ()}.toRotationMatrix();  // bow east
  motion.columns = columns;
  const auto wrench = [&](const Effect& of, const std::string& form, std::size_t number, double c) {
    std::vector<double> theta(of.parameters().size(), 0.0);
    theta[number] = c;
    Load load;
    of.load(motion, theta, form_of(of, form), load);
    return load.wrench;
  };
  CHECK((wrench(effect, "Y", 1, 2.0) - Vector6d::Unit(1) * 6.0).norm() < 1e-12);                   // 2 * 6 * 0.5
  CHECK((wrench(effect, "Y, about 4 (m/s)^2", 1, 2.0) - Vector6d::Unit(1) * 2.0).norm() < 1e-12);  // 2 * (6 - 4) * 0.5
  CHECK((wrench(effect, "all axes", 5, 2.0) - Vector6d::Unit(5) * 6.0).norm() < 1e-12);
  // East is ahead of a craft that points there.
  CHECK((wrench(effect, "north and east", 7, 2.0) - Vector6d::Unit(0) * 6.0).norm() < 1e-12);
  const int form = form_of(effect, "Y");
  CHECK(effect.unit(form, 1) == "N/((m/s)^2 m/s)");
  CHECK(effect.unit(form, 5) == "N m/((m/s)^2 m/s)");
  CHECK(effect.takes_part(form, 1));
  CHECK_FALSE(effect.takes_part(form, 0));

  const Vehicle by_bearing = asking("wind_speed @ wind_direction");
  const Trial blown = with_columns(by_bearing, 0.0, 8.0, "m/s");
  const Candidates along = candidates_of(by_bearing, {&blown, 1});
  REQUIRE(along.effects.size() == 1);
  CHECK((wrench(*along.effects.front(), "along wind_direction", 8, 2.0) - Vector6d::Unit(0) * 12.0).norm() < 1e-12);

  // Where nothing is measured, as in a simulator, nothing acts.
  motion.columns = {};
  CHECK(wrench(effect, "Y", 1, 2.0).isZero(0.0));
}

TEST_CASE("column effect: what hardly changes is asked about its mean alone, what never does not at all") {
  const Vehicle vehicle = asking("voltage");
  const Trial trial = with_columns(vehicle, 14.0, 16.0, "V");
  const Candidates hardly = candidates_of(vehicle, {&trial, 1});
  REQUIRE(hardly.effects.size() == 1);
  for (const std::string& form : hardly.effects.front()->variants({})) {
    CAPTURE(form);
    CHECK(form.ends_with(", about 15 V"));
  }
  const Trial constant = with_columns(vehicle, 15.0, 15.0, "V");
  const Candidates never = candidates_of(vehicle, {&constant, 1});
  CHECK(never.effects.empty());
  REQUIRE(never.idle.size() == 1);
  CHECK(never.idle.front().name == "column voltage");
  CHECK(never.idle.front().reason == "it is 15 V throughout all that is fitted: nothing can go with it");
  // One unit in all recordings.
  const std::vector both{trial, with_columns(vehicle, 14.0, 16.0, "mV")};
  CHECK_THROWS_WITH_AS(static_cast<void>(candidates_of(vehicle, both)),
                       "candidate 'voltage': run has it in 'mV', run in 'V'; give the unit in the map", InputError);
}
