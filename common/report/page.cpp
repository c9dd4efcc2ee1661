// Puts the sections of the report page together, verdict first.
#include "common/report/page.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "common/report/correction.hpp"
#include "common/report/page_parts.hpp"
#include "common/report/pictures.hpp"
#include "common/report/style.hpp"
#include "common/report/text.hpp"

namespace fathom::report {
namespace {

struct Meaning {
  std::string css;
  std::string words;
};

Meaning meaning(const std::string& verdict, bool partly, bool wiring) {
  if (wiring) return {"unexplained", "The vehicle's file seems to have other thrusters than the vehicle"};
  if (verdict == "adequate") return {"adequate", "The model is adequate: nothing is missing that this data can show"};
  if (verdict == "effect") return {"effect", "Something was missing, and it was found"};
  if (verdict == "ambiguous") return {"ambiguous", "Something is missing, but this data fits several causes"};
  if (verdict == "unexplained" && partly)
    return {"unexplained", "Something is missing, and the known causes explain only a part of it"};
  if (verdict == "unexplained") return {"unexplained", "Something is missing, and none of the known causes fits"};
  if (verdict == "no_model") return {"unexplained", "The model does not follow its thrust: its numbers are withheld"};
  if (verdict == "unjudged" || verdict == "not_judged") return {"ambiguous", "These runs show too little to judge by"};
  return {"other", verdict.empty() ? "No verdict" : "Verdict: " + verdict};
}

/// Both parts of a divided run are one.
std::string recordings(const DiagnosisResult& result) {
  std::set<std::string> runs;
  for (const auto* names : {&result.train, &result.validate}) {
    for (const std::string& name : *names) runs.insert(name.substr(0, name.find(" (")));
  }
  return std::to_string(runs.size()) + (runs.size() == 1 ? " recorded run" : " recorded runs");
}

std::string tile(const std::string& big, const std::string& small) {
  return "<div class=\"tile\"><b>" + escape(big) + "</b>" + escape(small) + "</div>";
}

std::string lines(const std::string& text) {
  std::string html;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    if (end > begin) html += "<p class=\"lead\">" + escape(text.substr(begin, end - begin)) + "</p>\n";
    begin = end + 1;
  }
  return html;
}

const char* kKey =
    "<div class=\"key\"><span><i style=\"border-color:#22262b\"></i>measured</span>"
    "<span><i style=\"border-color:#e07b00\"></i>before: base model</span>"
    "<span><i style=\"border-color:#0a5ea8\"></i>after: with the accepted effects</span>"
    "<span class=\"soft\">u v w: forward, right, down; p q r: roll, pitch, yaw rate</span></div>\n";

const char* kWords =
    "<section><h2>Words used here</h2><dl>"
    "<div><dt>rms error</dt><dd>Root mean square: the typical size of the error, large ones counting more.</dd></div>"
    "<div><dt>log odds</dt><dd>Weight of evidence on a logarithmic scale: 0 says nothing, 3 is 20 to 1 for the effect, "
    "5 is 150 to 1, "
    "negative numbers speak against it.</dd></div>"
    "<div><dt>validation run</dt><dd>A recording that was kept from the fit, so that the errors shown are those on "
    "unseen motion.</dd></div>"
    "<div><dt>95 % interval</dt><dd>The range that holds the true value 19 times out of 20.</dd></div>"
    "<div><dt>base model</dt><dd>Mass with the water that moves along, drag, weight and buoyancy, and the coupling of "
    "turning and moving; no effects.</dd></div>"
    "<div><dt>X Y Z, K M N</dt><dd>Forces forward, right and down; moments in roll, pitch and yaw.</dd></div>"
    "</dl></section>\n";

}  // namespace

std::string verdict_section(const DiagnosisReport& report) {
  const DiagnosisResult& result = report.result;
  const Meaning said =
      meaning(result.verdict, !result.effects.empty() && result.explained < 1.0, result.wiring.has_value());
  std::string html = "<header><h1>Why does " + escape(result.vehicle) +
                     " move as it does?</h1>\n<p class=\"soft\">Diagnosis of " + recordings(result) +
                     "</p>\n<div class=\"badge " + said.css + "\">" + escape(said.words) + "</div>\n" +
                     lines(result.paragraph) + "<div class=\"tiles\">";
  if (std::isfinite(result.improvement.value) && std::ranges::none_of(result.effects, &EffectFound::accepted) &&
      !(result.correction && result.correction->adopted)) {
    html += tile("0 %", "change of the prediction error: nothing was added to the model");
  } else if (std::isfinite(result.improvement.value)) {
    html += tile(percent(-result.improvement.value),
                 "change of the prediction error 5 s ahead (95 %: " + percent(-result.improvement.high) + " to " +
                     percent(-result.improvement.low) + ")");
  }
  std::vector<std::string> found;
  for (const auto& effect : result.effects) {
    if (effect.accepted) found.push_back(effect_title(effect.name, effect.variant));
  }
  const std::size_t doubts = group_findings(result.consistency).size();
  html += tile(std::to_string(found.size()), (found.size() == 1 ? "effect " : "effects ") +
                                                 std::string(result.verdict == "unexplained" ? "kept" : "accepted") +
                                                 (found.empty() ? "" : ": ") + join(found, ", "));
  html += tile(std::to_string(doubts), doubts == 1 ? "doubt about a sensor" : "doubts about sensors");
  const bool judged = !result.error_after.prediction.empty();
  html += tile(join(result.validate, ", "), judged ? "judged on, not used in the fit" : "too short to judge on");
  return html + "</div></header>\n";
}

std::string to_html(const DiagnosisReport& report, const std::string& gnuplot) {
  const DiagnosisResult& result = report.result;
  Album album;
  std::string page =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width, initial-scale=1\"><title>Fathom: " +
      escape(result.vehicle) + "</title><style>" + kStyle + "</style></head>\n<body><main>\n";
  page += verdict_section(report);
  page += kKey;
  page += correction_section(result);
  page += error_section(result, album);
  page += motion_section(report, album);
  page += sensor_section(report);
  page += leftover_section(report, album);
  page += memory_section(report, album);
  page += candidate_section(result);
  page += parameter_section(result);
  page += certainty_section(result);
  page += kWords;
  page += version_line() + "</main></body></html>\n";
  return album.fill(page, gnuplot);
}

}  // namespace fathom::report
