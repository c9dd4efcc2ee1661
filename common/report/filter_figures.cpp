#include "common/report/filter_figures.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "common/base/statistics.hpp"
#include "common/estimation/frequency_response.hpp"
#include "common/report/pictures.hpp"
#include "common/report/text.hpp"

namespace fathom::report {
namespace {

constexpr int kPoints = 240;
constexpr double kLowest = 0.003;  // of the highest frequency, which is half the sample rate
constexpr double kFloor = -60.0;   // dB

double median_interval(const estimation::Seen& seen) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < seen.t.size(); ++i) {
    if (seen.t[i] > seen.t[i - 1]) intervals.push_back(seen.t[i] - seen.t[i - 1]);
  }
  if (intervals.size() < 2) return 0.0;
  return median(std::move(intervals));
}

double shown(std::complex<double> response, BodePart part) {
  if (part == BodePart::kPhase) return std::arg(response) * 180.0 / std::numbers::pi;
  return std::max(kFloor, 20.0 * std::log10(std::max(std::abs(response), 1e-9)));
}

}  // namespace

std::vector<DrawnFilter> filters_of(const estimation::NavigatorSettings& settings, const estimation::AidsSeen& seen) {
  std::vector<DrawnFilter> filters;
  const auto add = [&](const estimation::AidSettings& aid, const estimation::Seen& of, Source source,
                       const char* words) {
    const double dt = aid.used ? median_interval(of) : 0.0;
    if (!(dt > 0.0)) return;
    const bool second = source == Source::kOpticalFlow || source == Source::kDvl;
    const estimation::AxisGains paper = estimation::published_gains(source);
    const estimation::Gains published{.value = paper.value.x(), .rate = paper.rate.x()};
    const estimation::Gains computed = second ? estimation::second_order_gains(aid.cutoff, aid.damping, dt)
                                              : estimation::first_order_gains(aid.cutoff, dt);
    filters.push_back({words, settings.published_gains ? published : computed, dt, second, settings.published_gains});
    if (!settings.published_gains && published.value > 0.0)
      filters.push_back({std::string{words} + ", published", published, dt, second, true});
  };
  add(settings.tags, seen.tags, Source::kTagPose, "markers");
  add(settings.usbl, seen.usbl, Source::kUsbl, "acoustic fixes");
  add(settings.flow, seen.flow, Source::kOpticalFlow, "optical flow");
  add(settings.dvl, seen.dvl, Source::kDvl, "velocity log");
  return filters;
}

Figure draw_bode(std::span<const DrawnFilter> filters, BodePart part) {
  const bool magnitude = part == BodePart::kMagnitude;
  const std::string words = magnitude ? "magnitude [dB]" : "phase [deg]";
  Figure figure{.alt = "Frequency response, " + words, .width = 560, .height = 260};
  std::string plot;
  for (std::size_t i = 0; i < filters.size(); ++i) {
    const DrawnFilter& filter = filters[i];
    const double highest = 0.5 / filter.interval;
    const std::string name = "$f" + std::to_string(i);
    figure.script += name + " << EOD\n";
    for (int k = 0; k <= kPoints; ++k) {
      const double f = highest * std::pow(kLowest, 1.0 - static_cast<double>(k) / kPoints);
      const std::complex<double> H = estimation::frequency_response(filter.gains, filter.interval, f);
      figure.script += number(f, 6) + " " + number(shown(H, part), 6) + " " + number(shown(1.0 - H, part), 6) + "\n";
    }
    figure.script += "EOD\n";
    const std::string colour = std::string{" lc rgb '"} + (filter.published ? kBeforeColour : kAfterColour) + "'";
    plot += (plot.empty() ? "" : ", ") + name + " using 1:2 with lines lw 1.8" + colour + ", " + name +
            " using 1:3 with lines lw 1.4 dt 2" + colour;
  }
  figure.script += "set label 100 " + quoted(words) +
                   " at graph 0, graph 1 left offset -5, 0.8 textcolor rgb '#22262b'\n" +
                   "set xlabel 'frequency [Hz]' offset 0, 0.6 textcolor rgb '#444b55'\nset logscale x\nset autoscale " +
                   "xfix\n" + (magnitude ? "set yrange [-60:10]\n" : "set yrange [-180:180]\nset ytics 90\n");
  figure.script += filters.empty() ? "" : "plot " + plot + "\n";
  return figure;
}

}  // namespace fathom::report
