// The first screen of the report says what it comes to; all else is folded, and does not contradict itself.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <sstream>

#include "common/report/page.hpp"
#include "common/report/page_parts.hpp"
#include "common/report/table.hpp"
#include "common/report/text.hpp"
#include "test/support/diagnosis_fixture.hpp"

using fathom::EffectFound;
using fathom::report::cause_line;
using fathom::report::to_html;

namespace {

constexpr int kMostWords = 300;  // that are seen before anything is unfolded, labels of the picture included

bool has(const std::string& page, const std::string& words) { return page.find(words) != std::string::npos; }

/// What a reader sees of the page: without tags, style, and what is folded.
std::string seen(const std::string& page) {
  std::string text;
  int folded = 0;
  bool tag = false, summary = false;
  for (std::size_t i = page.find("<main>"); i < page.size(); ++i) {
    if (page.compare(i, 8, "<details") == 0) ++folded;
    if (page.compare(i, 10, "</details>") == 0) --folded;
    if (page.compare(i, 8, "<summary") == 0) summary = true;
    if (page.compare(i, 10, "</summary>") == 0) summary = false;
    if (page[i] == '<') tag = true;
    if (!tag && (folded == 0 || (summary && folded == 1))) text += page[i];
    if (page[i] == '>') {
      tag = false;
      text += ' ';
    }
  }
  return text;
}

int words_in(const std::string& text) {
  std::istringstream stream{text};
  int count = 0;
  for (std::string word; stream >> word;) ++count;
  return count;
}

}  // namespace

TEST_CASE("The first screen names the axes along which the model does not follow its thrust") {
  auto report = fathom::test::made_up_report({.samples = 600});
  auto& result = report.result;
  result.verdict = "no_model";
  result.wiring.reset();
  result.parameters_after.clear();
  constexpr std::array kInertias{"m_X", "m_Y", "m_Z", "I_X", "I_Y", "I_Z"};
  std::string withheld;  // one of the axes that are predicted; the others are told
  for (std::size_t axis = 0; axis < kInertias.size(); ++axis) {
    if (!std::isfinite(result.error_after.prediction.front().rmse[axis])) continue;
    if (withheld.empty()) {
      withheld = fathom::report::kAxes[axis].name;
    } else {
      result.parameters_after.push_back({kInertias[axis], 10.0, 1.0, "kg"});
    }
  }
  REQUIRE_FALSE(result.parameters_after.empty());
  CHECK(has(seen(to_html(report)), "does not follow its thrust along " + withheld + ": those numbers are withheld"));
  result.parameters_after.clear();
  CHECK(has(seen(to_html(report)), "does not follow its thrust: numbers of such axes are withheld"));
}

TEST_CASE("Where an axis is withheld, the first screen shows that axis, and one error where nothing was added") {
  auto report = fathom::test::made_up_report({.samples = 600});
  auto& result = report.result;
  result.verdict = "no_model";
  result.effects.clear();
  result.parameters_after.clear();
  constexpr std::array kInertias{"m_X", "m_Y", "m_Z", "I_X", "I_Y", "I_Z"};
  std::size_t last = 0;
  for (std::size_t axis = 0; axis < kInertias.size(); ++axis) {
    if (!std::isfinite(result.error_after.prediction.front().rmse[axis])) continue;
    result.parameters_after.push_back({kInertias[axis], 10.0, 1.0, "kg"});
    last = axis;
  }
  result.parameters_after.pop_back();
  const std::string text = seen(to_html(report));
  CHECK(has(text, std::string{"error of "} + fathom::report::kAxes[last].name + " 5 s ahead"));
  CHECK_FALSE(has(text, "before → after"));
}

TEST_CASE("Stand-ins that were not taken share a line; one that is in the model has its own") {
  auto report = fathom::test::made_up_report({.samples = 600});
  report.result.verdict = "unexplained";
  report.result.effects.clear();
  report.result.stand_ins = {{.name = "current", .in_model = true, .size = 0.2},
                             {.name = "thruster_lag", .in_model = false, .size = 0.5},
                             {.name = "wave", .in_model = false, .size = 0.4}};
  const std::string text = seen(to_html(report));
  CHECK(has(text, "A stand-in, no cause: current"));
  CHECK(has(text, "not taken, since the error does not fall: thruster lag, wave"));
}

TEST_CASE("The first screen has a line for every cause, with number and interval") {
  const auto report = fathom::test::made_up_report({.samples = 600});
  const std::string text = seen(to_html(report));
  CHECK(has(text, "Something was missing, and it was found"));
  CHECK(has(text, "Thrust follows its command with a time constant of 0.352 (0.328 to 0.376) s"));
  CHECK(has(text, "it is this cause: 92 %"));
  CHECK(has(text, "it is this cause: 75 %; or else tether tension"));
  CHECK(has(text, "error of surge 5 s ahead, before → after"));
  CHECK(has(text, "Next."));
  CHECK(words_in(text) < kMostWords);
  CHECK_FALSE(has(text, report.result.paragraph.substr(0, 40)));  // folded
}

TEST_CASE("The first screen calls what is kept but hardly the cause a stand-in") {
  auto report = fathom::test::made_up_report({.samples = 600});
  CHECK_FALSE(has(seen(to_html(report)), "A stand-in"));
  report.result.effects.front().probability = 0.002;
  CHECK(has(seen(to_html(report)), "A stand-in, hardly the cause: "));
}

TEST_CASE("Of several causes the first screen says how many are sure; of one alone, why it is not") {
  auto report = fathom::test::made_up_report({.samples = 600});
  auto& effects = report.result.effects;
  report.result.verdict = "ambiguous";
  effects = {{.name = "current", .probability = 0.98}, {.name = "wave", .probability = 0.7}};
  CHECK(has(seen(to_html(report)), "Something was missing: 1 cause is found, and of 1 more this data is not sure"));
  effects.push_back({.name = "cubic_drag", .probability = 0.95});
  CHECK(has(seen(to_html(report)), "2 causes are found, and of 1 more this data is not sure"));
  effects = {{.name = "wave", .probability = 0.7}};
  CHECK(has(seen(to_html(report)), "Something is missing, and the evidence for its cause is weak"));
  effects.front().alternatives = {{.name = "current"}};
  CHECK(has(seen(to_html(report)), "Something is missing, but this data fits several causes"));
}

TEST_CASE("What sensors do wrong is no cause of the motion, and nothing was added to the model for it") {
  auto report = fathom::test::made_up_report({.samples = 600});
  report.result.effects = {
      {.name = "sensor_latency", .variant = "dvl", .parameters = {{"dvl.delay", 0.2, 0.01, "s"}}, .log_odds = 20.0}};
  const std::string text = seen(to_html(report));
  CHECK(has(text, "In the sensors, and corrected: "));
  CHECK(has(text, "nothing was added to the model"));
}

TEST_CASE("What a craft's flow does by nature shares a line behind the causes; alone, it is nothing that was missing") {
  auto report = fathom::test::made_up_report({.samples = 600});
  const EffectFound lift{.name = "body_lift", .variant = "hull, sideways"}, cross{.name = "cross_flow"};
  report.result.effects.insert(report.result.effects.begin(), {lift, cross});
  const std::string beside = seen(to_html(report));
  CHECK(has(beside, "Something was missing, and it was found"));
  const std::string line = "What the craft's own flow does, by its nature: body lift (hull, sideways), cross flow";
  CHECK(has(beside, line));
  CHECK(beside.find("Thrust follows its command") < beside.find(line));
  report.result.effects = {lift, cross};
  const std::string alone = seen(to_html(report));
  CHECK(has(alone, "Nothing is missing but what the flow past this craft does, and that was found"));
  CHECK_FALSE(has(alone, "Something was missing"));
}

TEST_CASE("A cause says which thruster, how much, and in which direction") {
  EffectFound gain{.name = "thruster_gain", .variant = "FL", .parameters = {{"gain_change", -0.29, 0.0075, ""}}};
  CHECK(has(cause_line(gain), "Thruster FL gives 29.0 (27.5 to 30.5) % less than the file says"));
  gain.parameters[0].value = 0.1;
  gain.variant = "thruster 3";
  CHECK(has(cause_line(gain), "Thruster 3 gives 10.0 (8.53 to 11.5) % more than the file says"));
  gain.variant = "T6, T4";
  gain.parameters = {{"T6.gain_change", 0.686, 0.0, ""}, {"T4.gain_change", -0.206, 0.0, ""}};
  CHECK(has(cause_line(gain),
            "Thruster T6 gives 68.6 % more than the file says, thruster T4 gives 20.6 % less than the file says"));
  EffectFound late{.name = "sensor_latency",
                   .variant = "gyro, dvl",
                   .parameters = {{"gyro.delay", 0.07, 0.0, "s"}, {"dvl.delay", 0.2, 0.0, "s"}}};
  CHECK(has(cause_line(late), "<b>gyro comes late by 0.0700 s, dvl comes late by 0.200 s</b>"));
  late.parameters[0].value = -0.07;
  CHECK(has(cause_line(late), "gyro comes early by 0.0700 s"));
  const EffectFound off{.name = "sensor_scale", .variant = "dvl.u", .parameters = {{"dvl.u.error", -0.02, 0.0, ""}}};
  CHECK(has(cause_line(off), "<b>dvl.u shows 2.00 % less than there is</b>"));
  const EffectFound failure{.name = "thruster_failure",
                            .variant = "T5",
                            .parameters = {{"share_lost", 0.5, 0.0, ""}, {"onset", 40.0, 0.0, "s"}}};
  CHECK(has(cause_line(failure), "Thruster T5 lost 50.0 % of its thrust at 40.0 s"));
  const EffectFound fades{.name = "thrust_overshoot",
                          .variant = "all",
                          .parameters = {{"share_lost", 0.2, 0.0, ""}, {"time_constant", 0.5, 0.0, "s"}}};
  CHECK(has(cause_line(fades),
            "Thrust peaks after each change of command and loses 20.0 % of it, with a time constant "
            "of 0.500 s"));
  const EffectFound jet{.name = "jet_on_hull", .variant = "T3 ahead", .parameters = {{"share_lost", 0.5, 0.0, ""}}};
  CHECK(has(cause_line(jet), "Thruster T3 ahead loses 50.0 % of its push that way"));
  const EffectFound current{.name = "current", .variant = "", .parameters = {{"v_N", 0.1, 0.0, "m/s"}}};
  CHECK(has(cause_line(current), "<b>Current: v_N 0.100 m/s</b>"));
  const EffectFound odd{.name = "<odd>", .variant = "", .parameters = {}};
  CHECK(has(cause_line(odd), "&lt;odd&gt;"));
}

TEST_CASE("How likely a cause is stands beside what was kept alone, which comes first") {
  auto report = fathom::test::made_up_report({.samples = 0});
  report.result.effects[1].log_odds = -6.3;
  report.result.candidates[3].log_odds = 7.89;  // against nothing, and refused
  const std::string section = fathom::report::candidate_section(report.result);
  CHECK(has(section, "it is this cause"));
  CHECK_FALSE(has(section, "7.89"));
  CHECK_FALSE(has(section, "-6.3"));
  CHECK(section.find("accepted</span>") < section.find("refused</span>"));
  CHECK(section.rfind("accepted</span>") < section.find("refused</span>"));
  CHECK(section.find("not asked") > section.find("refused</span>"));
}
