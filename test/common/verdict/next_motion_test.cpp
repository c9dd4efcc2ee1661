// What to drive next: each thruster alone, what tells rivals apart, what separates the arguments of what has no name,
// what sharpens a number; nothing where nothing is open.
#include "common/verdict/next_motion.hpp"

#include <doctest/doctest.h>

#include "common/model/effect.hpp"

using namespace fathom;
using verdict::next_motion;

namespace {

bool says(const std::string& text, std::string_view words) { return text.find(words) != std::string::npos; }

std::string revealed_by(const char* name) { return std::string{model::find_effect(name)->revealed_by()}; }

}  // namespace

TEST_CASE("next motion: rivals are told apart by the motions of both, before any number is sharpened") {
  DiagnosisResult result;
  result.effects = {{.name = "current", .variant = "", .parameters = {{"v_N", 0.1, 0.02, "m/s"}}},
                    {.name = "asymmetric_drag", .variant = "X_|u|"}};
  result.effects[1].alternatives = {{.name = "thrust_asymmetry", .log_odds = 1.0}};
  const std::string text = next_motion(result);
  CHECK(says(text, "To tell asymmetric_drag from thrust_asymmetry: "));
  CHECK(says(text, revealed_by("asymmetric_drag")));
  CHECK(says(text, revealed_by("thrust_asymmetry")));
  CHECK_FALSE(says(text, "current"));
}

TEST_CASE("next motion: the number that is known worst, where it is known badly") {
  DiagnosisResult result;
  result.effects = {
      {.name = "current", .variant = "", .parameters = {{"v_N", 0.1, 0.015, "m/s"}, {"v_E", -0.1, 0.025, "m/s"}}}};
  CHECK(next_motion(result) == "To know current better (its v_E is known to 25 %): " + revealed_by("current") + ".");
  for (NamedValue& number : result.effects[0].parameters) number.std = 0.005;
  CHECK(next_motion(result).empty());
  CHECK(next_motion({}).empty());
}

TEST_CASE("next motion: where something acts that has no name, what separates its arguments; rivals first") {
  DiagnosisResult result;
  result.effects = {{.name = "current", .variant = "", .parameters = {{"v_N", 0.1, 0.05, "m/s"}}}};
  result.verdict = "unexplained";
  CHECK(says(next_motion(result), "at another place and in another order"));
  CHECK_FALSE(says(next_motion(result), "To know current"));
  result.effects[0].alternatives = {{.name = "steady_force", .log_odds = 1.0}};
  CHECK(next_motion(result).starts_with("To tell current from steady_force"));
  CHECK(says(next_motion(result), "at another place and in another order"));
  result.effects.clear();
  result.verdict = "no_model";
  CHECK(says(next_motion(result), "one axis at a time"));
  result.verdict = "adequate";
  CHECK(next_motion(result).empty());
}

TEST_CASE("next motion: thrusters that seem to be others are tried one by one first") {
  DiagnosisResult result;
  result.wiring = WiringFault{{"T1 and T2 exchanged"}, 0.9};
  result.effects = {{.name = "current", .variant = "", .parameters = {{"v_N", 0.1, 0.05, "m/s"}}}};
  CHECK(says(next_motion(result), "each thruster alone"));
}

TEST_CASE("next motion: a measured column is told from others where it alone changes") {
  DiagnosisResult result;
  result.effects = {{.name = "column wind_speed", .variant = "X"}};
  result.effects[0].alternatives = {{.name = "column gusts", .log_odds = 1.0}};
  CHECK(next_motion(result) ==
        "To tell column wind_speed from column gusts: a recording in which the column changes while all else is as it "
        "was.");
}
