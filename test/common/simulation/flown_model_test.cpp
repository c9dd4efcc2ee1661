// A model that was diagnosed is flown: its numbers and its learned force are the truth.
#include <doctest/doctest.h>

#include <fstream>

#include "common/model/parameters.hpp"
#include "test/support/dive_site.hpp"

using namespace fathom;

namespace {

constexpr const char* kResult = R"({"schema": 1, "fathom_version": "0", "vehicle": "BlueROV2", "effects": [],
"parameters": {"after": {"m_X": {"value": 25.0, "std": 0.1, "unit": "kg"}, "command offset": {"value": 0.01}}},
"correction": {"adopted": true, "carried_to_other_runs": true, "input_is_wrench": false,
 "terms": [{"group": "a steady force toward north", "axis": 6, "factors": [], "scale": 2.0, "weight": 1.5}],
 "visited": {"nu": [1, 1, 1, 1, 1, 1], "tau": [9, 9, 9, 9, 9, 9], "force": [9, 9, 9, 9, 9, 9],
             "p_low": [0, 0, 0], "p_high": [1, 1, 1]}}})";

}  // namespace

TEST_CASE("simulator: with --model, numbers and learned force of a diagnosis are the truth") {
  const test::Scratch scratch;
  const std::string path = scratch.path("result.json");
  std::ofstream{path} << kResult;
  const auto plain = test::make_simulator("bluerov2", "tank", {.seed = 3});
  const auto flown = test::make_simulator("bluerov2", "tank", {.seed = 3, .model = path});
  CHECK(flown->secrets().theta[model::index(model::BaseParameter::m_X)] == 25.0);
  const simulation::Moment with = flown->moment(), without = plain->moment();
  const Eigen::Vector3d force_B = with.R_WB.transpose() * Eigen::Vector3d{3.0, 0.0, 0.0};  // N
  // At rest, and on the axis whose mass the result does not state.
  const double m_Y = plain->secrets().theta[model::index(model::BaseParameter::m_Y)];
  CHECK(with.nu_dot[1] - without.nu_dot[1] == doctest::Approx(force_B.y() / m_Y));
  CHECK(with.nu_dot[0] == doctest::Approx(force_B.x() / 25.0 + without.nu_dot[0] * plain->secrets().theta[0] / 25.0));
}
