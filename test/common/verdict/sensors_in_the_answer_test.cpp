// What the comparison of sensors has found stands before what forces show, in the verdict and its causes as well.
#include <doctest/doctest.h>

#include "common/verdict/of_recordings.hpp"

using namespace fathom;

namespace {

verdict::Answer with_a_late_sensor(inference::Verdict given) {
  verdict::Answer answer;
  answer.verdict = given;
  answer.report.result.verdict = word(given);
  answer.report.result.paragraph = "Nothing else.";
  answer.report.result.candidates.push_back({.name = "sensor_latency", .reason = "score"});
  answer.report.result.consistency = {{.run = "all",
                                       .signal = "dvl",
                                       .reference = "pose_capture",
                                       .finding = "delay",
                                       .size = 0.2,
                                       .action = "corrected: as said",
                                       .std = 0.002}};
  return answer;
}

}  // namespace

TEST_CASE("sensors in the answer: a fault is an effect, a cause, and the verdict where there was none") {
  verdict::Answer answer = with_a_late_sensor(inference::Verdict::adequate);
  answer.report.result.effects.push_back({.name = "current"});
  verdict::adopt_sensor_faults(answer);
  const DiagnosisResult& result = answer.report.result;
  REQUIRE(result.effects.size() == 2);
  CHECK(result.effects[0].name == "sensor_latency");
  CHECK(result.effects[1].name == "current");
  CHECK(result.candidates.size() == 1);
  CHECK(answer.verdict == inference::Verdict::effect);
  CHECK(result.verdict == "effect");
  REQUIRE(answer.given.causes.size() == 1);
  CHECK(answer.given.causes[0].cause == "sensors_disagree");
  CHECK(answer.given.causes[0].of == "sensor_latency");
  CHECK(answer.given.causes[0].value > answer.given.causes[0].threshold);
  CHECK(result.paragraph.ends_with("Nothing else."));
}

TEST_CASE("sensors in the answer: what forces left unexplained stays so, and nothing changes without a fault") {
  verdict::Answer answer = with_a_late_sensor(inference::Verdict::unexplained);
  verdict::adopt_sensor_faults(answer);
  CHECK(answer.report.result.verdict == "unexplained");
  verdict::Answer sound = with_a_late_sensor(inference::Verdict::adequate);
  sound.report.result.consistency.clear();
  verdict::adopt_sensor_faults(sound);
  CHECK(sound.report.result.verdict == "adequate");
  CHECK(sound.report.result.effects.empty());
  CHECK(sound.given.causes.empty());
}

TEST_CASE("sensors in the answer: a model that was not judged is no effect of the sensors; they are told beside it") {
  verdict::Answer answer = with_a_late_sensor(inference::Verdict::not_judged);
  verdict::adopt_sensor_faults(answer);
  CHECK(answer.verdict == inference::Verdict::not_judged);
  CHECK(answer.report.result.verdict == "not_judged");
  REQUIRE(answer.report.result.effects.size() == 1);
  CHECK(answer.report.result.paragraph.starts_with("The sensors contradict each other (sensor_latency)"));
}
