// Puts the sections of the report page together: the first screen, then all else, folded.
#include "common/report/page.hpp"

#include <string_view>

#include "common/report/correction.hpp"
#include "common/report/live_plot.hpp"
#include "common/report/page_parts.hpp"
#include "common/report/pictures.hpp"
#include "common/report/style.hpp"
#include "common/report/text.hpp"

namespace fathom::report {
namespace {

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

std::string to_html(const DiagnosisReport& report, const std::string& gnuplot) {
  const DiagnosisResult& result = report.result;
  Album album;
  std::string page = "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">" + live_policy() +
                     "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><title>Fathom: " +
                     escape(result.vehicle) + "</title><style>" + kStyle + "</style>" + live_style() + live_script() +
                     "</head>\n<body><main>\n";
  page += front_section(report, album);
  page += kKey;
  page += folded(correction_section(result, &album));
  page += folded(error_section(result, album));
  page += folded(motion_section(report, album));
  page += folded(candidate_section(result));
  page += folded(sensor_section(report));
  page += folded(parameter_section(result));
  page += folded(leftover_section(report, album));
  page += folded(memory_section(report, album));
  page += folded(certainty_section(result));
  page += folded(kWords);
  page += version_line() + "</main></body></html>\n";
  return album.fill(page, gnuplot);
}

}  // namespace fathom::report
