// Album, cells and whiskers of the report page.
#include "common/report/page_parts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "common/base/version.hpp"
#include "common/report/style.hpp"
#include "common/report/text.hpp"

namespace fathom::report {
namespace {

// Control characters cannot come from escaped text, so no text can pose as a mark.
constexpr char kOpen = '\x02';
constexpr char kClose = '\x03';

std::string coordinate(double value) {
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.1f", value);
  return buffer.data();
}

}  // namespace

std::string Album::place(Figure figure) {
  figures_.push_back(std::move(figure));
  return kOpen + std::to_string(figures_.size() - 1) + kClose;
}

std::string Album::fill(const std::string& page, const std::string& gnuplot) const {
  const auto pictures = render(figures_, gnuplot);
  std::string filled;
  std::size_t done = 0;
  for (std::size_t at = page.find(kOpen); at != std::string::npos; at = page.find(kOpen, done)) {
    const std::size_t end = page.find(kClose, at);
    filled += page.substr(done, at - done);
    filled += pictures.at(std::stoul(page.substr(at + 1, end - at - 1)));
    done = end + 1;
  }
  return filled + page.substr(done);
}

std::string page_head(const std::string& title) {
  return "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
         "content=\"width=device-width, initial-scale=1\"><title>Fathom: " +
         escape(title) + "</title><style>" + kStyle + "</style></head>\n<body><main>\n";
}

std::string version_line() {
  return "<p class=\"soft\">Written by Fathom " + escape(std::string{version()}) + ".</p>\n";
}

std::string cell(const std::string& html, const std::string& css) {
  return (css.empty() ? "<td>" : "<td class=\"" + css + "\">") + html + "</td>";
}

std::string heading_cells(const std::vector<std::string>& titles, const std::vector<std::size_t>& right) {
  std::string row = "<tr>";
  for (std::size_t i = 0; i < titles.size(); ++i) {
    row += (std::ranges::find(right, i) != right.end() ? "<th class=\"n\">" : "<th>") + escape(titles[i]) + "</th>";
  }
  return row + "</tr>\n";
}

std::string figure(const std::string& picture, const std::string& caption) {
  return "<figure>" + picture + (caption.empty() ? "" : "<figcaption>" + caption + "</figcaption>") + "</figure>\n";
}

std::string whiskers(const std::vector<Whisker>& rows, double low, double high, double zero) {
  constexpr double kWidth = 220.0;
  constexpr double kMargin = 6.0;
  constexpr double kPitch = 9.0;
  const double span = high > low ? high - low : 1.0;
  const auto x = [&](double v) {
    return coordinate(kMargin + (kWidth - 2.0 * kMargin) * std::clamp((v - low) / span, 0.0, 1.0));
  };
  const double height = kPitch * static_cast<double>(rows.size()) + 4.0;
  std::string svg = "<svg viewBox=\"0 0 " + coordinate(kWidth) + " " + coordinate(height) + "\" aria-hidden=\"true\">";
  if (std::isfinite(zero)) {
    svg += "<path d=\"M" + x(zero) + ",0V" + coordinate(height) + "\" stroke=\"#b8bec7\" stroke-width=\"1\"/>";
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Whisker& w = rows[i];
    if (!std::isfinite(w.value)) continue;
    const std::string y = coordinate(kPitch * (static_cast<double>(i) + 0.5) + 2.0);
    if (std::isfinite(w.low) && std::isfinite(w.high)) {
      svg +=
          "<path d=\"M" + x(w.low) + "," + y + "H" + x(w.high) + "\" stroke=\"" + w.colour + "\" stroke-width=\"2\"/>";
    }
    svg += "<circle cx=\"" + x(w.value) + "\" cy=\"" + y + "\" r=\"3.2\" fill=\"" + w.colour + "\"/>";
  }
  return svg + "</svg>";
}

std::string folded(std::string section) {
  constexpr std::string_view kBegin = "<section><h2>", kHeading = "</h2>", kEnd = "</section>\n";
  if (!section.starts_with(kBegin) || !section.ends_with(kEnd)) return section;
  section.replace(section.size() - kEnd.size(), kEnd.size(), "</details>\n");
  section.insert(section.find(kHeading) + kHeading.size(), "</summary>");
  return section.replace(0, kBegin.size(), "<details class=\"section\"><summary><h2>");
}

std::string tile(const std::string& big, const std::string& small) {
  return "<div class=\"tile\"><b>" + escape(big) + "</b>" + escape(small) + "</div>";
}

}  // namespace fathom::report
