// The four verdicts, each from a made-up search: no fits here, only what is concluded from them.
#include <doctest/doctest.h>

#include <cmath>

#include "test/common/diagnosis/made_up_search.hpp"

using namespace fathom;
using namespace fathom::diagnosis;

TEST_CASE("verdict: what leaves much of the error that lasts is kept, and is no certain name") {
  MadeUp made;
  made.accept("current", {0.1, 0.0});
  made.found.explained = 0.98;
  CHECK(made.concluded().verdict == "effect");
  made.found.explained = 0.6;
  const DiagnosisResult result = made.concluded();
  CHECK(result.verdict == "unexplained");
  REQUIRE(result.effects.size() == 1);
  CHECK(result.effects[0].accepted);
  CHECK(result.effects[0].log_odds == doctest::Approx(2.0 * std::log((1.0 - kWholeCause) / 0.4)));
  CHECK(result.explained == 0.6);
  CHECK(says(result.paragraph, "only 60 %"));
}

TEST_CASE("verdict: where all that is left is a random force, a name that is evident beside one is likely") {
  MadeUp made;
  Judged& current = made.accept("current", {0.1, 0.0});
  current.beside_memory = 50.0;
  made.found.explained = 0.6;
  made.found.explained_of_structure = 0.99;
  const DiagnosisResult result = made.concluded();
  CHECK(result.verdict == "effect");
  CHECK(result.effects.at(0).log_odds == doctest::Approx(std::log(9.0)));
  CHECK(says(result.paragraph, "Most likely the base model lacks: current"));
  CHECK(says(result.paragraph, "What is left goes with nothing that was measured"));
  made.left = {{.axis = "X", .with = "thrust", .share = 0.2}};
  CHECK(made.concluded().verdict == "unexplained");
  made.left.clear();
  made.found.accepted.front().beside_memory = 3.0;  // such a force might imitate it
  CHECK(made.concluded().verdict == "unexplained");
  made.found.accepted.front().beside_memory = 50.0;
  made.found.explained_of_structure = 0.8;
  CHECK(made.concluded().verdict == "unexplained");
  made.found.explained_of_structure = 0.99;
  made.found.explained = 0.3;
  CHECK(made.concluded().verdict == "unexplained");
}

TEST_CASE("verdict: beside what foretells no motion at all no name is certain") {
  MadeUp made;
  made.accept("thruster_deadband", {70.0});
  made.found.after.sigma.setConstant(0.005);
  const auto concluded = [&](double r2_of_yaw, double motion = 0.006) {
    DiagnosisResult result;
    result.error_after.prediction = {
        {.horizon_s = 5.0, .r2 = {-0.1, -0.7, -0.02, std::nan(""), std::nan(""), r2_of_yaw}}};
    model::Scene scene = made.scene();
    scene.nu_rms.setConstant(motion);
    conclude(made.found, made.left, scene, result);
    return result;
  };
  CHECK(concluded(0.2).verdict == "effect");
  CHECK(concluded(0.2).effects.at(0).log_odds > 3.0);
  const DiagnosisResult idle = concluded(-0.04);
  CHECK(idle.verdict == "unexplained");
  CHECK(idle.effects.at(0).log_odds <= 0.0);
  CHECK(says(idle.paragraph, "foretells no motion along any axis: did the thrusters run"));
  // The runs that it was learnt from moved, and the model follows them: a validation run at rest says nothing.
  CHECK(concluded(-0.04, 0.2).verdict == "effect");
}

TEST_CASE("verdict: a refused effect that would save much leaves the verdict open, and says what to drive") {
  MadeUp made;
  made.refuse("current", -4.0, "log odds -4.0, 8.0 needed");
  made.refuse("wall_effect", 0.5, "log odds 0.5, 5.0 needed", 0.39);
  const DiagnosisResult result = made.concluded();
  CHECK(result.verdict == "unexplained");
  CHECK(says(result.paragraph, "wall_effect would remove 39 % of the error, and is not certain: log odds 0.5"));
  CHECK(says(result.manoeuvre, "confirm or rule out wall_effect"));
  MadeUp little;
  little.refuse("wall_effect", 0.5, "log odds 0.5, 5.0 needed", 0.05);
  CHECK(little.concluded().verdict == "adequate");
}

TEST_CASE(
    "verdict: on a few windows, or once the validation run has spoken, what a refused effect would save is chance") {
  MadeUp made;
  made.refuse("wall_effect", 0.5, "log odds 0.5, 5.0 needed", 0.21);
  CHECK(made.concluded().verdict == "unexplained");
  made.found.after.window_cost.assign(10, 1.0);
  CHECK(made.concluded().verdict == "adequate");
  made.found.after.window_cost.assign(50, 1.0);
  made.found.taken_back = 20.0;
  const DiagnosisResult result = made.concluded();
  CHECK_FALSE(says(result.paragraph, "would remove"));
  CHECK(says(result.paragraph, "did not help the validation run"));
}

TEST_CASE("verdict: nothing found and nothing left is adequate, and there is nothing to drive") {
  MadeUp made;
  made.refuse("current", 1.0, "log odds 1.0, 3.0 needed");
  const DiagnosisResult result = made.concluded();
  CHECK(result.verdict == "adequate");
  CHECK(result.effects.empty());
  CHECK(result.manoeuvre.empty());
  CHECK(result.candidates.front().name == "current");
  CHECK(says(result.candidates.back().reason, "not applicable"));
  check_all_listed(result);
}

TEST_CASE("verdict: nothing found where nothing could be judged is not adequate") {
  MadeUp made;
  DiagnosisResult result;
  conclude(made.found, made.left, made.scene(), result, "Too short. ");
  CHECK(result.verdict == "unjudged");
  CHECK(says(result.paragraph, "Too short."));
  CHECK_FALSE(says(result.paragraph, "explains these runs"));
  made.accept("current", {0.1, 0.0});
  result = {};
  conclude(made.found, made.left, made.scene(), result, "Too short. ");
  CHECK(result.verdict == "effect");
  CHECK(says(result.paragraph, "Too short."));
  CHECK_FALSE(says(result.paragraph, "prediction error"));
}

TEST_CASE("verdict: what is left may have a memory: adequate all the same, and said") {
  MadeUp made;
  DiagnosisResult result;
  result.residual_after = {{"X", 0.3, 0.3, 0.9}, {"N", 1e-6, 2.0, 0.9}};
  conclude(made.found, made.left, made.scene(), result);
  CHECK(result.verdict == "adequate");
  CHECK(says(result.paragraph, "In N it remembers itself, for up to 2 s"));
  result = {};
  result.residual_after = {{"X", 0.3, 0.3, 0.9}};
  conclude(made.found, made.left, made.scene(), result);
  CHECK_FALSE(says(result.paragraph, "remembers itself"));
}

TEST_CASE(
    "verdict: a model that foretells worse than the average explains nothing, one that foretells little says so") {
  const MadeUp made;
  const auto concluded = [&](double r2, double p_value, double p_half = 1e-6, double p_average = 1.0) {
    DiagnosisResult result;
    result.error_after.prediction = {{.horizon_s = 5.0, .r2 = {0.9, r2, 0.9, 0.9, 0.9, 0.9}}};
    result.error_after.prediction[0].p_half[1] = p_half;
    result.error_after.prediction[0].p_average[1] = p_average;
    result.residual_after = {{"X", 0.3, 0.3, 0.9}, {"Y", p_value, 2.0, 0.9}};
    conclude(made.found, made.left, made.scene(), result);
    return result;
  };
  CHECK(concluded(-0.5, 1e-6, 1e-6, 1e-6).verdict == "unexplained");
  CHECK(says(concluded(-0.5, 1e-6, 1e-6, 1e-6).paragraph, "foretells nothing of the motion along Y"));
  CHECK(concluded(0.3, 1e-6).verdict == "adequate");
  CHECK(says(concluded(0.3, 1e-6).paragraph, "foretells 30 % of the motion along Y"));
  CHECK(concluded(-0.5, 0.4, 1e-6, 1e-6).verdict == "adequate");  // noise is all that there is
  CHECK(concluded(-0.5, 1e-6, 0.1, 0.2).verdict == "adequate");   // a few windows tell nothing
  CHECK_FALSE(says(concluded(-0.5, 1e-6, 0.1, 0.2).paragraph, "5 s ahead"));
  CHECK_FALSE(says(concluded(0.9, 1e-6, 1.0).paragraph, "5 s ahead"));
  MadeUp found;
  found.accept("current", {0.1, 0.1});
  DiagnosisResult result;
  result.improvement = {0.4, 0.3, 0.5};
  result.error_after.prediction = {{.horizon_s = 5.0, .r2 = {0.9, 0.3, 0.9, 0.9, 0.9, 0.9}}};
  result.error_after.prediction[0].p_half[1] = 1e-6;
  result.residual_after = {{"Y", 1e-6, 2.0, 0.9}};
  conclude(found.found, found.left, found.scene(), result);
  CHECK(says(result.paragraph, "foretells 30 % of the motion along Y"));  // beside what was found, too
}

TEST_CASE("verdict: a model that does not follow its thrust is not adequate, and the file is in doubt") {
  const MadeUp made;
  const auto concluded = [&](double explained, double p_half, double p_value = 1e-6, double applied = 5.0) {
    DiagnosisResult result;
    result.error_after.prediction = {{.horizon_s = 5.0, .r2 = {0.9, 0.3, 0.9, 0.9, 0.9, 0.9}}};
    result.error_after.prediction[0].p_half[1] = p_half;
    result.residual_after = {{"X", 0.3, 0.3, 0.9, 5.0}, {"Y", p_value, 2.0, explained, applied}};
    conclude(made.found, made.left, made.scene(), result);
    return result;
  };
  const DiagnosisResult astray = concluded(0.3, 1e-6);
  CHECK(astray.verdict == "unexplained");
  CHECK(says(astray.paragraph, "Along Y less than half of the applied force is accounted for"));
  CHECK(says(astray.paragraph, "vehicle's file"));
  CHECK(concluded(0.3, 0.2).verdict == "adequate");               // few windows tell nothing of a half
  CHECK(concluded(-3.0, 0.2).verdict == "unexplained");           // but more is left than was there
  CHECK(concluded(0.7, 1e-6).verdict == "adequate");              // a strong random force
  CHECK(concluded(-3.0, 1e-6, 0.4).verdict == "adequate");        // the sensors' noise
  CHECK(concluded(-3.0, 1e-6, 1e-6, 1.0).verdict == "adequate");  // an axis that hardly anything drives
}

TEST_CASE("verdict: without velocities, moments of speeds are suspected before the vehicle's file") {
  const MadeUp made;
  const auto concluded = [&](const char* axis, bool velocity) {
    DiagnosisResult result;
    result.error_after.prediction = {{.horizon_s = 5.0, .r2 = {0.3, 0.3, 0.3, 0.3, 0.3, 0.3}}};
    result.error_after.prediction[0].p_half.fill(1e-6);
    result.residual_after = {{axis, 1e-6, 2.0, 0.3, 5.0}};
    model::Scene scene = made.scene();
    scene.velocity = velocity;
    conclude(made.found, made.left, scene, result);
    return result.paragraph;
  };
  CHECK(says(concluded("N", false), "without velocities the moments"));
  CHECK_FALSE(says(concluded("N", false), "vehicle's file"));
  CHECK(says(concluded("N", true), "vehicle's file"));
  CHECK(says(concluded("X", false), "vehicle's file"));
}

TEST_CASE("verdict: thrusters that are not the file's come before all else") {
  const MadeUp made;
  DiagnosisResult result;
  result.wiring = WiringFault{{"T1 and T2 exchanged", "T3 reversed"}, 0.97};
  conclude(made.found, made.left, made.scene(), result);
  CHECK(result.verdict == "unexplained");
  CHECK(says(result.paragraph, "T1 and T2 exchanged, or with T3 reversed"));
  CHECK(says(result.paragraph, "97 % less error"));
  CHECK(says(result.manoeuvre, "each thruster alone"));
}

TEST_CASE("verdict: nothing found but structure left is unexplained, says where, and asks for the nearest candidate") {
  MadeUp made;
  made.refuse("tether_tension", 2.5, "log odds 2.5, 3.0 needed");
  made.refuse("current", 1.0, "log odds 1.0, 3.0 needed");
  made.left = {{"X", "position", 0.42}};
  const DiagnosisResult result = made.concluded();
  CHECK(result.verdict == "unexplained");
  REQUIRE(result.goes_with.size() == 1);
  CHECK(result.goes_with[0].with == "position");
  CHECK(says(result.paragraph, "no known effect explains"));
  CHECK(says(result.paragraph, "X with position (42 %"));
  CHECK(says(result.manoeuvre, "tether_tension"));
  CHECK(says(result.manoeuvre, std::string{model::find_effect("tether_tension")->revealed_by()}));
  check_all_listed(result);
}

TEST_CASE("verdict: a free curve that helps leaves something unexplained, and says over what") {
  MadeUp made;
  made.found.free_form = FreeForm{"Z", "depth", 0.3};
  const DiagnosisResult result = made.concluded();
  CHECK(result.verdict == "unexplained");
  CHECK(result.paragraph.find("force on Z that depends on depth") != std::string::npos);
  CHECK(result.paragraph.find("30 %") != std::string::npos);
}
