// A whole diagnosis of a dive: the report is complete, the same twice, and too little data is one clear line.
#include "common/diagnosis/diagnoser.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "common/base/error.hpp"
#include "common/diagnosis/moved.hpp"
#include "common/estimation/split.hpp"
#include "common/residual/prediction.hpp"
#include "test/support/cut_trial.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::diagnosis;

namespace {

constexpr double kSurelyBetter = 0.1;  // of the 5 s error: a lag of 0.3 s costs far more

struct Laggard {
  model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  std::vector<Trial> train, validate;

  Laggard() {
    const test::VirtualDive dive =
        test::make_dive(vehicle, {.duration = 125.0, .seed = 41, .effects = {test::active("thruster_lag", {0.3})}});
    train = {test::cut_trial(dive.trial, 0, 600)};
    validate = {test::cut_trial(dive.trial, 600, dive.trial.size())};
    train[0].name = "first part";
    validate[0].name = "second part";
  }
  [[nodiscard]] DiagnosisReport report(const Progress& progress = [](const std::string&, double) {}) const {
    // However many threads help, sums are made in one order.
    Settings settings;
    settings.fit.threads = 2;
    return diagnose(vehicle, train, validate, settings, progress);
  }
};

void check_same(const std::vector<NamedValue>& a, const std::vector<NamedValue>& b) {
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    CAPTURE(a[i].name);
    CHECK(a[i].name == b[i].name);
    CHECK(a[i].value == b[i].value);
    CHECK(a[i].std == b[i].std);
  }
}

}  // namespace

TEST_CASE("diagnoser: the report is complete, and a second run gives the same numbers to the last bit") {
  const Laggard laggard;
  double done = 0.0;
  const DiagnosisReport report = laggard.report([&](const std::string& what, double share) {
    CHECK_FALSE(what.empty());
    CHECK(share >= done);
    CHECK(share <= 1.0);
    done = share;
  });
  const DiagnosisResult& result = report.result;
  CHECK(result.vehicle == laggard.vehicle.name);
  CHECK(result.train == std::vector<std::string>{"first part"});
  CHECK(result.validate == std::vector<std::string>{"second part"});
  REQUIRE_FALSE(result.effects.empty());
  CHECK(result.effects[0].name == "thruster_lag");
  CHECK((result.verdict == "effect" || result.verdict == "ambiguous"));
  CHECK_FALSE(result.paragraph.empty());
  CHECK_FALSE(result.manoeuvre.empty());
  CHECK(result.candidates.size() == model::all_effects().size());
  CHECK(result.improvement.value > kSurelyBetter);
  CHECK(result.improvement.low <= result.improvement.value);
  CHECK(result.improvement.high >= result.improvement.value);
  CHECK(result.parameters_before.size() == laggard.vehicle.parameters.size());
  CHECK(result.parameters_after.size() > result.parameters_before.size());
  for (const NamedValue& value : result.parameters_after) CHECK(value.std > 0.0);
  CHECK(result.error_after.force_rmse.size() == 5);  // X Y Z K N
  REQUIRE(result.error_after.prediction.size() == kHorizons.size());
  CHECK(std::isfinite(result.error_after.prediction[1].rmse[0]));
  CHECK(std::isnan(result.error_after.prediction[1].rmse[4]));  // pitch is not simulated
  CHECK(result.residual_after.size() == 5);

  // Traces are as long as the run, and restart at the measured velocity where they say so.
  {
    REQUIRE(report.traces.size() == 1);
    const PredictionTrace& trace = report.traces[0];
    const std::size_t size = laggard.validate[0].size();
    CHECK(trace.run == "second part");
    CHECK(trace.t.size() == size);
    CHECK(trace.measured.size() == size);
    CHECK(trace.before.size() == size);
    CHECK(trace.after.size() == size);
    CHECK(trace.residual_before.size() == size);
    CHECK(trace.residual_after.size() == size);
    CHECK(trace.position.size() == size);
    CHECK(trace.heading.size() == size);
    CHECK(trace.tau.size() == size);
    CHECK(trace.voltage.size() == size);
    REQUIRE(trace.restarts.size() == 7);  // 65 s, every 10 s
    CHECK(trace.restarts.front() == 0);
    for (std::size_t r = 0; r < trace.restarts.size(); ++r) {
      const std::size_t k = trace.restarts[r];
      if (r > 0) CHECK(k > trace.restarts[r - 1]);
      REQUIRE(k < size);
      for (const std::size_t axis : {0U, 1U, 2U, 3U, 5U}) {
        CHECK(trace.before[k][axis] == trace.measured[k][axis]);
        CHECK(trace.after[k][axis] == trace.measured[k][axis]);
      }
      CHECK(std::isnan(trace.after[k][4]));  // pitch is not simulated
    }
  }
  {
    const DiagnosisReport again = laggard.report();
    check_same(result.parameters_before, again.result.parameters_before);
    check_same(result.parameters_after, again.result.parameters_after);
    CHECK(result.improvement.value == again.result.improvement.value);
    CHECK(result.improvement.low == again.result.improvement.low);
    CHECK(result.paragraph == again.result.paragraph);
    CHECK(result.manoeuvre == again.result.manoeuvre);
    REQUIRE(result.candidates.size() == again.result.candidates.size());
    for (std::size_t i = 0; i < result.candidates.size(); ++i) {
      CHECK(result.candidates[i].name == again.result.candidates[i].name);
      CHECK(result.candidates[i].log_odds == again.result.candidates[i].log_odds);
    }
  }
}

TEST_CASE("diagnoser: too little data is one line that says what to do") {
  Laggard laggard;
  laggard.train[0] = test::cut_trial(laggard.train[0], 0, 40);
  try {
    (void)laggard.report();
    FAIL("4 s of data were taken for a run");
  } catch (const InputError& error) {
    const std::string line = error.what();
    CHECK(line.find('\n') == std::string::npos);
    CHECK(line.find("record longer") != std::string::npos);
  }
}

TEST_CASE("diagnoser: a run in which nothing moves is one line") {
  Laggard laggard;
  for (Vector6d& nu : laggard.train[0].nu) nu.setConstant(0.3);
  CHECK_THROWS_WITH_AS((void)laggard.report(), doctest::Contains("first part: nothing moves"), InputError);
}

TEST_CASE("diagnoser: a validation run of a few seconds judges nothing, and stops nothing") {
  Laggard laggard;
  laggard.validate = {test::cut_trial(laggard.validate[0], 0, 60)};  // 6 s: not one window
  const DiagnosisReport report = laggard.report();
  CHECK(report.result.paragraph.find("that needs 10 s on end without a gap, and its longest run has 6 s") !=
        std::string::npos);
  CHECK(report.result.verdict != "adequate");
  CHECK_FALSE(report.result.effects.empty());
  CHECK(report.result.explained == 1.0);
}

TEST_CASE("diagnoser: what the validation run contradicts is taken back, and called unexplained") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const auto dive = [&](unsigned seed, double change) {
    return test::make_dive(vehicle,
                           {.duration = 90.0, .seed = seed, .effects = {test::active("thrust_asymmetry", {change})}})
        .trial;
  };
  std::vector<Trial> train{dive(51, -0.3)}, validate{dive(52, 0.3)};  // other propellers, put on in between
  train[0].name = "before";
  validate[0].name = "after";
  const DiagnosisResult result = diagnose(vehicle, train, validate, {}, [](const std::string&, double) {}).result;
  CHECK(result.verdict == "unexplained");
  CHECK(result.effects.empty());
  CHECK(result.improvement.value == 0.0);
  const auto asymmetry = std::find_if(result.candidates.begin(), result.candidates.end(),
                                      [](const CandidateTried& c) { return c.name == "thrust_asymmetry"; });
  REQUIRE(asymmetry != result.candidates.end());
  CHECK(asymmetry->reason.find("not the validation run") != std::string::npos);
  CHECK(result.paragraph.find("thrust_asymmetry helped the training runs") != std::string::npos);
}

TEST_CASE("diagnoser: a validation run that hardly feels what was found takes nothing back") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const auto dive = [&](unsigned seed, double noise) {
    return test::make_dive(vehicle, {.duration = 90.0,
                                     .seed = seed,
                                     .velocity_noise = noise,
                                     .rate_noise = noise,
                                     .effects = {test::active("thruster_lag", {0.15})}})
        .trial;
  };
  // Instruments that are coarse beside what the lag changes: a fall of a few per cent of their noise at most.
  const std::vector<Trial> train{dive(61, 0.002)}, validate{dive(62, 0.06)};
  const DiagnosisResult result = diagnose(vehicle, train, validate, {}, [](const std::string&, double) {}).result;
  CAPTURE(result.paragraph);
  REQUIRE_FALSE(result.effects.empty());
  CHECK(result.effects[0].name == "thruster_lag");
  CHECK(result.improvement.value < 0.15);  // of what training gained, far less
}

TEST_CASE("diagnoser: a sound vehicle is not accused of the time for which its commands are held") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  for (const double hold : {-0.5, 0.5}) {
    const Trial trial = test::make_dive(vehicle, {.duration = 150.0, .seed = 7, .input_hold = hold}).trial;
    const std::vector<Trial> train{test::cut_trial(trial, 0, 1000)};
    const std::vector<Trial> validate{test::cut_trial(trial, 1000, trial.size())};
    const auto result = diagnose(vehicle, train, validate, {}, [](const std::string&, double) {}).result;
    CAPTURE(hold);
    CHECK_MESSAGE(result.verdict == "adequate", result.paragraph);
    CHECK(result.effects.empty());
  }
}

TEST_CASE("diagnoser: stretches of a run are one run to the reader, and what drove the gap between them is no matter") {
  Laggard laggard;
  for (auto* runs : {&laggard.train, &laggard.validate}) {
    Trial run = std::move(runs->front());
    run.input_valid.assign(run.size(), 1);
    for (std::size_t k = 250; k < 280; ++k) {
      run.input_valid[k] = 0;
      run.input[k] *= -5.0;
    }
    *runs = estimation::known_stretches(run, 2.0);
    REQUIRE(runs->size() == 2);
  }
  const DiagnosisReport report = laggard.report();
  CHECK(report.result.train == std::vector<std::string>{"first part"});
  CHECK(report.result.validate == std::vector<std::string>{"second part"});
  REQUIRE_FALSE(report.result.effects.empty());
  CHECK(report.result.effects[0].name == "thruster_lag");
  REQUIRE(report.traces.size() == 1);
  const PredictionTrace& trace = report.traces[0];
  const std::size_t size = trace.t.size();
  for (const auto* rows :
       {&trace.measured, &trace.before, &trace.after, &trace.residual_before, &trace.residual_after, &trace.tau})
    CHECK(rows->size() == size);
  CHECK(std::ranges::is_sorted(trace.t));
  CHECK(std::ranges::is_sorted(trace.restarts));
  const auto gap = std::ranges::find_if(trace.tau, [](const auto& tau) { return std::isnan(tau[0]); });
  REQUIRE(gap != trace.tau.end());
  const auto after = static_cast<std::size_t>(gap - trace.tau.begin()) + 1;
  CHECK(trace.t[after] - trace.t[after - 2] == doctest::Approx(3.1));
  CHECK(std::ranges::find(trace.restarts, after) != trace.restarts.end());
}
