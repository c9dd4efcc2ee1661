// Building blocks of the report page: figures that are drawn last, all in one go, and small helpers for tables.
#pragma once

#include <string>
#include <vector>

#include "common/report/plot.hpp"
#include "common/samples/diagnosis_result.hpp"

namespace fathom::report {

/// Collects figures while the page is written; their places are filled when all have been drawn.
class Album {
 public:
  /// Keeps the figure and returns the mark that stands for it in the page.
  [[nodiscard]] std::string place(Figure figure);
  /// The page with every mark replaced by its picture.
  [[nodiscard]] std::string fill(const std::string& page, const std::string& gnuplot) const;

 private:
  std::vector<Figure> figures_;
};

/// The sections, in the order of the page. Each is complete HTML; empty when there is nothing to say.
/// The first screen: verdict, a line per cause, error before and after, the picture that shows it, what to do next.
[[nodiscard]] std::string front_section(const DiagnosisReport& report, Album& album);
/// One line per effect: what it is, with number, interval and place. HTML.
[[nodiscard]] std::string cause_line(const EffectFound& effect);
/// 0.93 becomes "93 %"; what is nearly certain "> 99.9 %".
[[nodiscard]] std::string sure(double probability);
[[nodiscard]] std::string error_section(const DiagnosisResult& result, Album& album);
[[nodiscard]] std::string motion_section(const DiagnosisReport& report, Album& album);
[[nodiscard]] std::string sensor_section(const DiagnosisReport& report);
[[nodiscard]] std::string leftover_section(const DiagnosisReport& report, Album& album);
[[nodiscard]] std::string memory_section(const DiagnosisReport& report, Album& album);
[[nodiscard]] std::string candidate_section(const DiagnosisResult& result);
[[nodiscard]] std::string parameter_section(const DiagnosisResult& result);
[[nodiscard]] std::string certainty_section(const DiagnosisResult& result);
/// A section whose heading unfolds it. What is folded does not print.
[[nodiscard]] std::string folded(std::string section);
/// A number that is read at a glance, on the first screen.
[[nodiscard]] std::string tile(const std::string& big, const std::string& small);
/// A page up to its first section: title, style, and room for small screens.
[[nodiscard]] std::string page_head(const std::string& title);
/// Which build wrote the page: the last line of every page.
[[nodiscard]] std::string version_line();

/// "<td class=c>text</td>"; the text is HTML already.
[[nodiscard]] std::string cell(const std::string& html, const std::string& css = "");
[[nodiscard]] std::string heading_cells(const std::vector<std::string>& titles, const std::vector<std::size_t>& right);
[[nodiscard]] std::string figure(const std::string& picture, const std::string& caption);
/// A line with a dot and its interval, in the range [low, high]; drawn small enough for a table cell.
struct Whisker {
  double low{};
  double value{};
  double high{};
  const char* colour{};
};
[[nodiscard]] std::string whiskers(const std::vector<Whisker>& rows, double low, double high, double zero);

}  // namespace fathom::report
