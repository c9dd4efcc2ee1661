// How a verdict names what was found: forms, look-alikes, what was taken back and what could not be asked.
#include <doctest/doctest.h>

#include <cmath>

#include "test/common/diagnosis/made_up_search.hpp"

using namespace fathom;
using namespace fathom::diagnosis;

TEST_CASE("verdict: what was not measured is said, with what could not be asked; only what was asked counts as tried") {
  MadeUp made;
  made.refuse("thruster_lag", 1.0, "log odds 1.0, 3.0 needed");
  CHECK_FALSE(says(made.concluded().paragraph, "not measured"));
  made.measured_attitude = false;
  const DiagnosisResult result = made.concluded();
  CHECK(says(result.paragraph, "none of the 1 effects"));
  CHECK(says(result.paragraph, "Attitude was not measured: current, "));
  CHECK(says(result.paragraph, " could not be asked, and what tilts the vehicle is not known."));
  REQUIRE(result.not_measured.size() == 1);
  CHECK(result.not_measured[0].group == "attitude");
}

TEST_CASE("verdict: an alternative that was accepted beside it is none any more") {
  MadeUp made;
  made.accept("current", {0.1, 0.1}).alternatives = {{"tether_tension"}, {"wall_effect", 1.0, "X_u", 0.2}};
  made.accept("tether_tension", {1.0, 1.0, 1.0, 1.0, 1.0});
  const DiagnosisResult result = made.concluded();
  REQUIRE(result.effects.size() == 2);
  REQUIRE(result.effects[0].alternatives.size() == 1);
  CHECK(result.effects[0].alternatives[0].name == "wall_effect");
  CHECK(says(result.paragraph, "current (or wall_effect)"));
}

TEST_CASE("verdict: a found effect comes with numbers, sentence and the motion that would sharpen the weakest number") {
  MadeUp made;
  made.accept("thruster_lag", {0.3});
  made.accept("current", {0.1, -0.05});
  made.refuse("tether_tension", -2.0, "log odds -2.0, 3.0 needed");
  made.known_to(0.01, {0.02, 0.0, 0.05, 0.25});  // the second is of vertical thrusters, if apart
  const DiagnosisResult result = made.concluded();
  CHECK(result.verdict == "effect");
  REQUIRE(result.effects.size() == 2);
  CHECK(result.effects[0].name == "thruster_lag");
  REQUIRE(result.effects[0].parameters.size() == 1);
  CHECK(result.effects[0].parameters[0].value == 0.3);
  CHECK(result.effects[0].parameters[0].std == doctest::Approx(0.006));
  REQUIRE(result.effects[1].parameters.size() == 2);
  CHECK(result.effects[1].parameters[1].value == -0.05);
  CHECK(says(result.paragraph, result.effects[0].sentence));
  CHECK(says(result.paragraph, "falls by 40 % (95 % interval 30 % to 50 %)"));
  CHECK(says(result.manoeuvre, "v_E is known to 25 %"));
  CHECK(says(result.manoeuvre, std::string{model::find_effect("current")->revealed_by()}));
  check_all_listed(result);
}

TEST_CASE("verdict: look-alikes that the odds cannot rule out are ambiguous, and the manoeuvre tells them apart") {
  MadeUp made;
  made.accept("thruster_lag", {0.3});
  Judged& open = made.accept("asymmetric_drag", {-8.0}, 0, "X_uu");
  open.aliased_with = {"thrust_asymmetry"};
  open.alternatives = {{"thrust_asymmetry", std::log(2.0), "X_u", -0.1}};
  open.log_odds = 30.0;
  open.corrupts = "X_u|u|";
  open.corruption = 0.25;
  const DiagnosisResult result = made.concluded();
  CHECK(result.verdict == "ambiguous");
  CHECK(says(result.paragraph, "asymmetric_drag (or thrust_asymmetry) cannot be told apart"));
  CHECK(says(result.paragraph,
             "The odds for asymmetric_drag are 2 to 1 against thrust_asymmetry; left out of a model, "
             "asymmetric_drag falsifies X_u|u| by +25 %, thrust_asymmetry X_u by -10 %."));
  CHECK(result.effects[1].log_odds == doctest::Approx(std::log(2.0)));  // no surer than the name is
  CHECK(says(result.manoeuvre, std::string{model::find_effect("asymmetric_drag")->revealed_by()}));
  CHECK(says(result.manoeuvre, std::string{model::find_effect("thrust_asymmetry")->revealed_by()}));
  CHECK_FALSE(says(result.manoeuvre, "thruster_lag"));
  check_all_listed(result);
}

TEST_CASE("verdict: what no list holds and looks the same leaves the name open at even odds") {
  MadeUp world;
  world.accept("bottom_effect", {5.0, 0.0, 0.3, 2.0}, 2, "exponential force");
  const DiagnosisResult result = world.concluded();
  CHECK(result.verdict == "ambiguous");
  REQUIRE(result.effects.size() == 1);
  CHECK(result.effects[0].log_odds == 0.0);
  CHECK(result.effects[0].unlisted == "a layer of denser water below");
  CHECK(says(result.paragraph, "bottom_effect (or a layer of denser water below) cannot be told apart"));
  CHECK(says(result.manoeuvre, "To tell bottom_effect from a layer of denser water below: going deeper"));
  MadeUp suction;
  suction.accept("bottom_effect", {-5.0, 0.0, 0.3, 2.0}, 2, "exponential force");
  CHECK(suction.concluded().verdict == "effect");
}

TEST_CASE("verdict: several forms of one effect are one entry whose numbers say which form they belong to") {
  MadeUp made;
  made.accept("thruster_gain", {-0.2}, 0, "port");
  made.accept("thruster_gain", {-0.3}, 2, "vertical");
  const DiagnosisResult result = made.concluded();
  REQUIRE(result.effects.size() == 1);
  CHECK(result.effects[0].variant == "port, vertical");
  REQUIRE(result.effects[0].parameters.size() == 2);
  CHECK(says(result.effects[0].parameters[0].name, "port."));
  CHECK(result.effects[0].parameters[0].value == -0.2);
  CHECK(says(result.effects[0].parameters[1].name, "vertical."));
  CHECK(result.effects[0].parameters[1].value == -0.3);
  CHECK(result.effects[0].error_reduction == doctest::Approx(1.0 - 0.7 * 0.7));
  check_all_listed(result);
}

TEST_CASE("verdict: what was taken back leaves something unexplained, and the refused say why") {
  MadeUp made;
  made.refuse("current", 30.0, "helps the runs that it was fitted to, and not the validation run");
  made.found.taken_back = 20.0;
  const DiagnosisResult result = made.concluded();
  CHECK(result.verdict == "unexplained");
  CHECK(result.effects.empty());
  CHECK(result.paragraph.find("did not help the validation run") != std::string::npos);
}

TEST_CASE("verdict: what was taken back at odds that noise reaches was chance, and is told") {
  MadeUp made;
  made.refuse("thrust_overshoot", 5.3, "helps the runs that it was fitted to, and not the validation run");
  made.found.taken_back = 5.3;
  const DiagnosisResult result = made.concluded();
  CHECK(result.verdict == "adequate");
  CHECK(says(result.paragraph, "One that seemed to help the training runs did not help the validation run."));
}

TEST_CASE("verdict: forms without a name of their own are told apart in words") {
  MadeUp made;
  made.accept("thruster_lag", {0.3}).other_forms = {"vertical apart"};
  const DiagnosisResult result = made.concluded();
  REQUIRE(result.effects.size() == 1);
  CHECK(result.effects[0].other_forms == std::vector<std::string>{"the plain form or vertical apart"});
}
