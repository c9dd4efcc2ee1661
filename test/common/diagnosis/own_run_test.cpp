// A validation run with another phase, moment or current than the runs that were fitted: its first half sets what is
// its own, its second half judges, and what acts in neither is not helped by it.
#include "common/diagnosis/own_run.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "common/diagnosis/diagnoser.hpp"
#include "common/model/onset.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::diagnosis;

namespace {

const model::Vehicle& vehicle() {
  static const model::Vehicle kVehicle = test::vehicle_from_repository("seabotix_lbv150");
  return kVehicle;
}

Trial dive(const model::ActiveEffect& effect, unsigned seed, double duration = 200.0) {
  return test::make_dive(vehicle(), {.duration = duration, .seed = seed, .spread = 0.0, .effects = {effect}}).trial;
}

/// The truth of one run, as if it had been learnt.
identification::FitResult learnt(const model::ActiveEffect& effect, unsigned seed) {
  identification::FitResult fit;
  fit.model = test::make_dive(vehicle(), {.duration = 1.0, .seed = seed, .spread = 0.0, .effects = {effect}}).truth;
  fit.sigma.setConstant(0.005);
  return fit;
}

std::vector<double> own_theta(const model::ActiveEffect& there, const model::ActiveEffect& here, unsigned seed) {
  const Trial unseen =
      test::make_dive(vehicle(), {.duration = 200.0, .seed = seed, .spread = 0.0, .effects = {here}}).trial;
  const auto own = with_own_numbers(learnt(there, seed), vehicle(), {&unseen, 1}, {});
  REQUIRE(own);
  CHECK(own->effects == std::vector<std::string>{std::string(there.effect->name())});
  return own->model.effects.front().theta;
}

}  // namespace

TEST_CASE("own numbers of a run: the first half finds another phase, current and moment; the rest stays") {
  const std::vector<double> wave =
      own_theta(test::active("wave", {2.0, 0.0, 0.5, 1.1}), test::active("wave", {-1.0, 1.7, 0.5, 1.1}), 3);
  CHECK(std::hypot(wave[0] + 1.0, wave[1] - 1.7) < 0.15);
  CHECK(wave[2] == 0.5);
  CHECK(wave[3] == 1.1);
  const std::vector<double> flow =
      own_theta(test::active("current", {0.08, 0.0}), test::active("current", {-0.05, 0.06}), 4);
  CHECK(std::hypot(flow[0] + 0.05, flow[1] - 0.06) < 0.01);
  for (const double moment : {40.0, -20.0}) {  // in the first half; before the run
    CAPTURE(moment);
    const std::vector<double> payload = own_theta(test::active("payload_change", {2.0, -3.0, 120.0}),
                                                  test::active("payload_change", {2.0, -3.0, moment}), 5);
    CHECK(payload[0] == 2.0);
    CHECK((moment < 0.0 ? payload[2] < 0.0 : std::abs(payload[2] - moment) < 1.0));
  }
}

TEST_CASE("own numbers of a run: effects without such numbers, and several runs, have none") {
  const Trial one = dive(test::active("thruster_lag", {0.2}), 6), other = dive(test::active("thruster_lag", {0.2}), 7);
  CHECK_FALSE(with_own_numbers(learnt(test::active("thruster_lag", {0.2}), 6), vehicle(), {&one, 1}, {}));
  std::vector<Trial> both{one, other};
  both[1].name = "another";
  CHECK_FALSE(with_own_numbers(learnt(test::active("current", {0.1, 0.0}), 6), vehicle(), both, {}));
}

TEST_CASE(
    "own numbers of a run: a current that is another in the validation run is named, and judged by its second half") {
  std::mt19937 random{20261124};
  std::uniform_real_distribution<double> any{0.05, 0.09};
  const Trial train = dive(test::active("current", {any(random), -any(random)}), 8, 240.0);
  Trial unseen = dive(test::active("current", {-any(random), any(random)}), 9, 240.0);
  unseen.name = "another day";
  const DiagnosisResult result =
      diagnose(vehicle(), {&train, 1}, {&unseen, 1}, {}, [](const std::string&, double) {}).result;
  REQUIRE(result.effects.size() == 1);
  CHECK(result.effects[0].name == "current");
  CHECK(result.verdict == "effect");
  CHECK(result.own_in_validation == std::vector<std::string>{"current"});
  CHECK(result.improvement.low > 0.3);
  CHECK(result.paragraph.find("The validation run has numbers of its own for current") != std::string::npos);
  CHECK(result.effects[0].parameters[0].value > 0.0);  // as it was learnt
}
