// The four verdicts, each from a made-up search: no fits here, only what is concluded from them.
#include "common/diagnosis/verdict.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "common/diagnosis/left_over.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::diagnosis;

namespace {

struct MadeUp {
  model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  SearchResult found;
  std::vector<Association> left;
  bool measured_attitude = true;

  MadeUp() {
    found.before.model = model::nominal_model(vehicle, false);
    found.after.model = found.before.model;
    found.after.window_cost.assign(50, 1.0);
  }
  Judged& accept(const std::string& name, std::vector<double> theta, int variant = 0,
                 const std::string& variant_name = "") {
    model::ActiveEffect effect = test::active(name, std::move(theta), variant);
    effect.variant_name = variant_name;
    found.after.model.add(effect);
    found.accepted.push_back({.effect = model::find_effect(name),
                              .variant = variant,
                              .variant_name = variant_name,
                              .log_odds = 20.0,
                              .error_reduction = 0.3});
    return found.accepted.back();
  }
  void refuse(const std::string& name, double log_odds, const std::string& reason, double saves = 0.004) {
    found.refused.push_back(
        {.effect = model::find_effect(name), .log_odds = log_odds, .error_reduction = saves, .reason = reason});
  }
  /// Standard deviations as shares of the numbers, in the order of the fit's parameters.
  void known_to(double base, const std::vector<double>& effects) {
    const std::vector<NamedValue> values = found.after.parameters();
    const auto n = static_cast<Eigen::Index>(values.size());
    const auto first = n - static_cast<Eigen::Index>(effects.size());
    found.after.covariance = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double share = i < first ? base : effects[static_cast<std::size_t>(i - first)];
      const double std = share * values[static_cast<std::size_t>(i)].value;
      found.after.covariance(i, i) = std * std;
    }
  }
  [[nodiscard]] model::Scene scene() const {
    model::Scene scene{.vehicle = &vehicle, .position = true, .attitude = measured_attitude, .velocity = true};
    scene.rates = true;
    return scene;
  }
  [[nodiscard]] DiagnosisResult concluded() const {
    DiagnosisResult result;
    result.improvement = {0.4, 0.3, 0.5};
    conclude(found, left, scene(), result);
    return result;
  }
};

bool says(const std::string& text, const std::string& what) { return text.find(what) != std::string::npos; }

/// Every effect of the registry exactly once.
void check_all_listed(const DiagnosisResult& result) {
  std::multiset<std::string> listed, registered;
  for (const CandidateTried& candidate : result.candidates) {
    listed.insert(candidate.name);
    CHECK_FALSE(candidate.reason.empty());
  }
  for (const model::Effect* effect : model::all_effects()) registered.insert(std::string{effect->name()});
  CHECK(listed == registered);
}

}  // namespace

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

TEST_CASE("verdict: a free curve that helps leaves something unexplained, and says over what") {
  MadeUp made;
  made.found.free_form = FreeForm{"Z", "depth", 0.3};
  const DiagnosisResult result = made.concluded();
  CHECK(result.verdict == "unexplained");
  CHECK(result.paragraph.find("force on Z that depends on depth") != std::string::npos);
  CHECK(result.paragraph.find("30 %") != std::string::npos);
}
