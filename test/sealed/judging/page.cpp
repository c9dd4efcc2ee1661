#include "test/sealed/judging/page.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>

#include "test/sealed/judging/rate.hpp"

namespace fathom::sealed {
namespace {

using Filter = std::function<bool(const Score&)>;

std::string format(const char* pattern, double value) {
  if (!std::isfinite(value)) return "-";
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), pattern, value);
  return text.data();
}

std::string percent(long part, long whole) {
  if (whole == 0) return "-";
  const Rate rate = wilson(part, whole);
  return format("%.0f %%", 100.0 * rate.share) + " (" + std::to_string(part) + " of " + std::to_string(whole) +
         format("; %.0f", 100.0 * rate.low) + format(" to %.0f %%)", 100.0 * rate.high);
}

double quantile(std::vector<double> values, double share) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  if (values.empty()) return kUnknown;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(std::lround(share * static_cast<double>(values.size() - 1)))];
}

std::vector<double> collect(std::span<const Score> scores, const Filter& filter,
                            const std::function<double(const Score&)>& value) {
  std::vector<double> values;
  for (const Score& score : scores) {
    if (filter(score)) values.push_back(value(score));
  }
  return values;
}

std::string good_of(std::span<const Score> scores, const Filter& filter) {
  long part = 0, whole = 0;
  for (const Score& score : scores) {
    if (!filter(score)) continue;
    ++whole;
    part += score.good ? 1 : 0;
  }
  return percent(part, whole);
}

/// RMS of errors over bounds, of those sets.
std::string over_bound(std::span<const Score> scores, const Filter& filter) {
  double squares = 0.0, count = 0.0;
  for (const Score& s : scores) {
    if (!filter(s)) continue;
    for (const double x : s.over_bound) squares += x * x, count += 1.0;
  }
  return count > 0.0 ? format("%.2f", std::sqrt(squares / count)) : "-";
}

/// Median over sets.
std::string over_all(std::span<const Score> scores, const Filter& filter) {
  std::vector<double> sets;
  for (const Score& s : scores) {
    if (!filter(s) || s.over_all.empty()) continue;
    double squares = 0.0;
    for (const double x : s.over_all) squares += x * x;
    sets.push_back(std::sqrt(squares / static_cast<double>(s.over_all.size())));
  }
  return sets.empty() ? "-" : format("%.2f", quantile(sets, 0.5));
}

void add_row(std::string& text, const std::string& what, const std::string& target, const std::string& reached) {
  text += "| " + what + " | " + target + " | " + reached + " |\n";
}

void add_targets(std::span<const Score> scores, std::string& text) {
  text += "| what | target | reached |\n|---|---|---|\n";
  for (const auto& [class_name, target] : {std::pair{"strong", "98 %"}, {"medium", "95 %"}, {"weak", "85 %"}}) {
    const std::string size = class_name;
    add_row(text, "single effect, " + size + ": named first, or in an alias set of three", target,
            good_of(scores, [&](const Score& s) { return s.kind == "single" && s.size == size; }));
  }
  add_row(text, "single effect, fainter than weak (cannot be made larger)", "-",
          good_of(scores, [](const Score& s) { return s.kind == "single" && s.size == "faint"; }));
  add_row(text, "pair found whole, medium", "85 %",
          good_of(scores, [](const Score& s) { return s.kind == "pair" && s.size == "medium"; }));
  add_row(text, "pair found whole, other sizes", "-",
          good_of(scores, [](const Score& s) { return s.kind == "pair" && s.size != "medium"; }));
  const Filter mixed = [](const Score& s) { return s.kind == "mixed"; };
  add_row(text, "two listed effects beside one of no list: one or both named, and nothing else", "-",
          good_of(scores, mixed));
  add_row(text, "the same: both named", "-",
          percent(std::ranges::count_if(scores, [&](const Score& s) { return mixed(s) && s.outcome == "whole"; }),
                  std::ranges::count_if(scores, mixed)));
  add_row(text, "the same: a wrong name accepted", "-",
          percent(std::ranges::count_if(scores, [&](const Score& s) { return mixed(s) && s.outcome == "wrong"; }),
                  std::ranges::count_if(scores, mixed)));
  add_row(text, "five or six listed effects at once: all named, and nothing else", "-",
          good_of(scores, [](const Score& s) { return s.kind == "many"; }));
  long strangers = 0, sets = 0, alarms = 0, quiet = 0, failed = 0, foreign = 0, named = 0, refused = 0, worse = 0,
       compared = 0, adequate = 0, unexplained = 0;
  for (const Score& s : scores) {
    failed += s.outcome == "failed" ? 1 : 0;
    if (s.kind == "single" || s.kind == "pair") {
      ++sets;
      strangers += s.strangers > 0 ? 1 : 0;
    }
    if (s.kind == "clean" || s.kind == "noise") {
      ++quiet;
      alarms += s.outcome == "false alarm" ? 1 : 0;
      adequate += s.verdict == "adequate" ? 1 : 0;
    }
    if (s.kind == "foreign") {
      ++foreign;
      named += s.outcome == "wrong name" ? 1 : 0;
      unexplained += s.verdict == "unexplained" ? 1 : 0;
      refused += s.outcome == "refused" ? 1 : 0;
    }
    if (std::isfinite(s.after)) {
      ++compared;
      worse += s.after > 1.02 * s.before ? 1 : 0;
    }
  }
  add_row(text, "sets with an effect in which a wrong one is accepted too", "-", percent(strangers, sets));
  add_row(text, "false alarms: clean data, coloured noise alone", "at most 2 %", percent(alarms, quiet));
  add_row(text, "clean data, coloured noise alone: the verdict is adequate", "-", percent(adequate, quiet));
  add_row(text, "outside the catalogue: the verdict is unexplained", "-", percent(unexplained, foreign));
  add_row(text, "outside the catalogue: nothing accepted", "-", percent(refused, foreign));
  add_row(text, "outside the catalogue: nothing accepted, or no name above 90 % and the verdict unexplained", "80 %",
          good_of(scores, [](const Score& s) { return s.kind == "foreign"; }));
  add_row(text, "outside the catalogue: a wrong confident name", "at most 5 %", percent(named, foreign));
  const Filter effects = [](const Score& s) { return s.kind == "single" || s.kind == "pair"; };
  const auto after = collect(scores, effects, [](const Score& s) { return s.after / s.floor; });
  add_row(text, "5 s error after, over that of the true simulator: median (quartiles)", "1.10",
          format("%.2f", quantile(after, 0.5)) + " (" + format("%.2f", quantile(after, 0.25)) + ", " +
              format("%.2f", quantile(after, 0.75)) + ")");
  add_row(text, "the same before", "-",
          format("%.2f", quantile(collect(scores, effects, [](const Score& s) { return s.before / s.floor; }), 0.5)));
  add_row(text, "the same of the base model's best fit to true accelerations", "-",
          format("%.2f", quantile(collect(scores, effects, [](const Score& s) { return s.base / s.floor; }), 0.5)));
  add_row(text, "error after more than 2 % above before", "never", percent(worse, compared));
  long inside = 0, all = 0, named_right = 0, other_form = 0;
  for (const Score& s : scores) {
    named_right += s.outcome == "named" ? 1 : 0;
    other_form += s.outcome == "named" && s.wrong_form ? 1 : 0;
    for (const double x : s.deviations) inside += std::abs(x) < 1.96 ? 1 : 0, ++all;
  }
  const auto every = [](const Score&) { return true; };
  const Filter level = [](const Score&s) { return !s.tilts; }, tilts = [](const Score&s) { return s.tilts; };
  add_row(text,
          "clean data: error of base numbers over the Cramer-Rao bound (velocities and rates, windows of 10 s, poses "
          "known without error), RMS",
          "1.5", over_bound(scores, every));
  add_row(text, "the same of craft that do not roll or pitch", "1.5", over_bound(scores, level));
  add_row(text, "the same of craft that do, whose restoring moments feel each error of the tilt", "1.5",
          over_bound(scores, tilts));
  add_row(
      text,
      "over the bound of every signal, poses with their noise, median of sets (the bound of a craft that is unstable "
      "is nothing): all; level craft, whose bound takes roll and pitch for known; the others",
      "-", over_all(scores, every) + "; " + over_all(scores, level) + "; " + over_all(scores, tilts));
  add_row(text, "named, but another thruster, axis or law than the true one", "-", percent(other_form, named_right));
  add_row(text, "95 % intervals of effect parameters that hold the truth", "90 to 98 %", percent(inside, all));
  const auto took = [&](const Filter& filter, double Score::*clock) {
    const std::vector<double> seconds = collect(scores, filter, [&](const Score& s) { return s.*clock; });
    return format("%.1f s", quantile(seconds, 0.5)) + ", " + format("%.1f s", quantile(seconds, 1.0));
  };
  add_row(text, "time of one diagnosis, craft of up to four axes: median, longest", "20 s",
          took(level, &Score::seconds));
  add_row(text, "the same, craft that roll or pitch", "-", took(tilts, &Score::seconds));
  add_row(text, "processor time of two cores together, craft of up to four axes; craft that roll or pitch", "-",
          took(level, &Score::processor) + "; " + took(tilts, &Score::processor));
  add_row(text, "memory, most", "500 MB",
          format("%.0f MB", quantile(collect(scores, every, [](const Score& s) { return s.megabytes; }), 1.0)));
  add_row(text, "runs that failed", "none", std::to_string(failed));
}

void add_effects(std::span<const Score> scores, std::string& text) {
  std::map<std::string, std::map<std::string, std::pair<int, int>>> cells;
  std::map<std::string, std::map<std::string, int>> instead;
  std::map<std::string, int> by_sensors;
  for (const Score& s : scores) {
    if (s.kind != "single") continue;
    auto& [good, all] = cells[s.truth.front()][s.size];
    ++all;
    good += s.good ? 1 : 0;
    by_sensors[s.truth.front()] += s.in_sensor_check ? 1 : 0;
    if (!s.good)
      ++instead[s.truth.front()][s.found.empty() ? (s.outcome == "failed" ? "failed" : "nothing") : s.found.front()];
  }
  text += "\n## Single effects\n\nNamed of drawn, and what was named first instead.\n\n";
  text += "| effect | faint | weak | medium | strong | instead |\n|---|---|---|---|---|---|\n";
  for (const auto& [name, row] : cells) {
    text += "| `" + name + "` |";
    for (const char* size : {"faint", "weak", "medium", "strong"}) {
      const auto cell = row.find(size);
      text += cell == row.end()
                  ? " |"
                  : " " + std::to_string(cell->second.first) + "/" + std::to_string(cell->second.second) + " |";
    }
    std::string others;
    for (const auto& [other, times] : instead[name]) {
      others += (others.empty() ? " " : ", ") + other + (times > 1 ? " x" + std::to_string(times) : "");
    }
    if (by_sensors[name] > 0)
      others += (others.empty() ? " " : "; ") +
                ("comparison of sensors reports it " + std::to_string(by_sensors[name]) + " times");
    text += others + " |\n";
  }
}

void add_misses(std::span<const Score> scores, std::string& text) {
  text +=
      "\n## Every set that went wrong\n\n| set | truth | size | outcome | accepted | verdict "
      "|\n|---|---|---|---|---|---|\n";
  const auto joined = [](const std::vector<std::string>& names) {
    std::string all;
    for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
    return all.empty() ? std::string("-") : all;
  };
  for (const Score& s : scores) {
    if (s.good) continue;
    text += "| " + std::to_string(s.seed) + " | " + (s.truth.empty() ? s.kind : joined(s.truth)) + " | " + s.size +
            " | " + s.outcome + " | " + joined(s.found) + " | " + s.verdict + " |\n";
  }
}

/// Claims in bins of stated probability.
struct Bin {
  double low, high;
  double stated{};
  long right{}, all{};
};

std::vector<Bin> calibration(std::span<const Score> scores) {
  std::vector<Bin> bins{{0.0, 0.5}, {0.5, 0.8}, {0.8, 0.9}, {0.9, 0.95}, {0.95, 0.99}, {0.99, 0.999}, {0.999, 1.1}};
  for (const Score& s : scores) {
    for (const Claim& claim : s.claims) {
      for (Bin& bin : bins) {
        if (claim.probability < bin.low || claim.probability >= bin.high) continue;
        bin.stated += claim.probability;
        ++bin.all;
        bin.right += claim.right ? 1 : 0;
      }
    }
  }
  std::erase_if(bins, [](const Bin& bin) { return bin.all == 0; });
  return bins;
}

}  // namespace

std::string to_page(std::span<const Score> scores, const std::string& how, const std::string& picture) {
  std::string text =
      "# Benchmark\n\nWritten by `" + how + "`: " + std::to_string(scores.size()) +
      " sets of a generator that shares no physics with\nthe tool (`test/sealed`). Each draws a vehicle, a "
      "trial, an effect (or a pair, or none, or one that no list has) and\nnoise from its number; the tool "
      "sees the data and a vehicle file only.\n"
      "Sizes: weak, medium and strong effects add 5, 15 and 40 % of the applied wrench to the residual "
      "that the base model\n"
      "leaves after its own best fit (root mean square over the driven axes, each against its own "
      "applied wrench). Where\n"
      "physics ends before the class is reached, the set counts for the nearest class. Rates with their 95 % "
      "intervals\n(Wilson 1927).\n\n";
  add_targets(scores, text);
  add_effects(scores, text);
  const auto bins = calibration(scores);
  text += "\n## Stated odds\n\n| stated | claims | mean stated | right |\n|---|---|---|---|\n";
  for (const Bin& bin : bins) {
    text += "| " + format("%.3g", bin.low) + " to " + format("%.3g", std::min(bin.high, 1.0)) + " | " +
            std::to_string(bin.all) + " | " + format("%.4f", bin.stated / static_cast<double>(bin.all)) + " | " +
            percent(bin.right, bin.all) + " |\n";
  }
  if (!picture.empty())
    text +=
        "\n## Confusion and calibration\n\n![What was there, what was named first; stated odds and how often they were "
        "right](" +
        picture + ")\n";
  add_misses(scores, text);
  return text;
}

void draw_picture(std::span<const Score> scores, const std::string& path) {
  std::vector<std::string> rows, columns;
  std::map<std::pair<std::string, std::string>, int> cells;
  const auto place = [](std::vector<std::string>& list, const std::string& name) {
    if (std::find(list.begin(), list.end(), name) == list.end()) list.push_back(name);
  };
  for (const Score& s : scores) {
    if (s.kind == "pair") continue;
    const std::string truth = s.truth.empty() ? "(nothing)" : s.truth.front();
    const std::string found = s.outcome == "failed"  ? "(failed)"
                              : s.outcome == "alias" ? truth
                              : s.found.empty()      ? "(nothing)"
                                                     : s.found.front();
    place(rows, truth);
    place(columns, found);
    ++cells[{truth, found}];
  }
  std::sort(rows.begin(), rows.end());
  std::sort(columns.begin(), columns.end());
  FILE* plot = popen("gnuplot 2>/dev/null", "w");  // it warns of matrices of one row
  if (plot == nullptr) return;
  std::fprintf(plot, "set terminal svg size 1500,820 font 'sans,11' noenhanced background 'white'\nset output '%s'\n",
               path.c_str());
  std::fprintf(
      plot, "set multiplot\nset size 0.7,1\nset origin 0,0\nset title 'What was there (rows), what was named first'\n");
  std::fprintf(plot,
               "set palette defined (0 'white', 1 '#2b6cb0')\nunset colorbox\nunset key\nset xtics rotate by -60 left "
               "scale 0\nset ytics scale 0\n");
  std::fprintf(plot, "set xrange [-0.5:%zu-0.5]\nset yrange [%zu-0.5:-0.5]\nset cbrange [0:*]\n", columns.size(),
               rows.size());
  const auto tics = [&](char axis, const std::vector<std::string>& names) {
    std::fprintf(plot, "set %ctics (", axis);
    for (std::size_t i = 0; i < names.size(); ++i)
      std::fprintf(plot, "%s'%s' %zu", i > 0 ? "," : "", names[i].c_str(), i);
    std::fprintf(plot, ")\n");
  };
  tics('x', columns);
  tics('y', rows);
  std::fprintf(plot, "$matrix << EOD\n");
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (std::size_t c = 0; c < columns.size(); ++c) {
      std::fprintf(plot, "%zu %zu %d\n", c, r, cells[{rows[r], columns[c]}]);
    }
    std::fprintf(plot, "\n");
  }
  std::fprintf(
      plot,
      "EOD\nplot $matrix using 1:2:3 with image pixels, '' using 1:2:($3 > 0 ? sprintf('%%d', $3) : '') with labels\n");
  std::fprintf(plot, "set size 0.3,0.5\nset origin 0.7,0.5\nset title 'Stated and true share of right names'\n");
  std::fprintf(
      plot,
      "set xrange [0:1.03]\nset yrange [0:1.03]\nset xtics auto norotate\nset ytics auto\nset xlabel 'stated'\nset "
      "ylabel 'right'\n$bins << EOD\n");
  for (const Bin& bin : calibration(scores)) {
    const Rate rate = wilson(bin.right, bin.all);
    std::fprintf(plot, "%g %g %g %g\n", bin.stated / static_cast<double>(bin.all), rate.share, rate.low, rate.high);
  }
  std::fprintf(plot, "EOD\nplot x lc 'gray', $bins using 1:2:3:4 with yerrorbars pt 7 lc '#2b6cb0'\nunset multiplot\n");
  pclose(plot);
}

}  // namespace fathom::sealed
