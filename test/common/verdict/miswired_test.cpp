// Thrusters that are not the file's: no effect is named, no numbers are given, and what to mend is said.
#include <doctest/doctest.h>

#include <algorithm>

#include "common/verdict/by_likelihood.hpp"
#include "test/common/likelihood/noisy_dive.hpp"

using namespace fathom;

TEST_CASE("miswired: a diagnosis of thrusters that are exchanged has no model, and says which they are") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const auto miswired = [&](unsigned seed) {
    Trial trial = test::fly(vehicle, {.duration = 90.0, .seed = seed, .force = 0.02}).trial;
    for (auto* inputs : {&trial.input, &trial.held, &trial.told}) {
      for (Eigen::VectorXd& input : *inputs) std::swap(input[0], input[1]);
    }
    return trial;
  };
  const Trial train = miswired(9), unseen = miswired(10);
  const verdict::Answer answer =
      verdict::diagnose(vehicle, {&train, 1}, {&unseen, 1}, {.without = {}}, {}, {.learn = false});
  const DiagnosisResult& result = answer.report.result;
  CHECK(result.verdict == "no_model");
  CHECK(result.effects.empty());
  CHECK(result.parameters_after.empty());
  REQUIRE(result.wiring);
  CHECK(result.wiring->readings.front() ==
        vehicle.thrusters[0].name + " and " + vehicle.thrusters[1].name + " exchanged");
  CHECK(result.manoeuvre.find("each thruster alone") != std::string::npos);
  CHECK(std::ranges::any_of(answer.given.causes, [](const CauseGiven& cause) { return cause.cause == "wiring"; }));
}
