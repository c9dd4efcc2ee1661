#include "test/sealed/comparison.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <functional>
#include <set>

namespace fathom::sealed {
namespace {

using Filter = std::function<bool(const Score&)>;

__attribute__((format(printf, 1, 2))) std::string text(const char* pattern, ...) {
  std::array<char, 200> buffer{};
  va_list list;
  va_start(list, pattern);
  std::vsnprintf(buffer.data(), buffer.size(), pattern, list);
  va_end(list);
  return buffer.data();
}

std::string cell(std::span<const Score> scores, const Filter& of, const Filter& counts) {
  const long whole = std::ranges::count_if(scores, of);
  const long part = std::ranges::count_if(scores, [&](const Score& s) { return of(s) && counts(s); });
  if (whole == 0) return "-";
  const Rate rate = wilson(part, whole);
  return text("%.0f %% (%ld of %ld; %.0f to %.0f %%)", 100.0 * rate.share, part, whole, 100.0 * rate.low,
              100.0 * rate.high);
}

std::string quartiles(std::span<const Score> scores, const Filter& of, const std::function<double(const Score&)>& value,
                      const char* unit) {
  std::vector<double> values;
  for (const Score& score : scores) {
    if (of(score) && std::isfinite(value(score))) values.push_back(value(score));
  }
  if (values.empty()) return "-";
  std::ranges::sort(values);
  const auto at = [&](double share) {
    return values[static_cast<std::size_t>(std::lround(share * static_cast<double>(values.size() - 1)))];
  };
  return text("%.2f%s (%.2f to %.2f; most %.2f)", at(0.5), unit, at(0.25), at(0.75), values.back());
}

std::vector<Score> only(std::span<const Score> scores, const std::set<std::uint64_t>& seeds) {
  std::vector<Score> kept;
  std::ranges::copy_if(scores, std::back_inserter(kept), [&](const Score& s) { return seeds.contains(s.seed); });
  return kept;
}

struct Row {
  std::string what;
  std::function<std::string(std::span<const Score>)> cell;
};

std::vector<Row> rows() {
  const auto of_kind = [](const char* kind, const char* size = "") {
    return [kind = std::string(kind), size = std::string(size)](const Score& s) {
      return s.kind == kind && (size.empty() || s.size == size);
    };
  };
  const Filter good = [](const Score& s) { return s.good; };
  const Filter effects = [](const Score& s) { return s.kind == "single" || s.kind == "pair"; };
  const Filter quiet = [](const Score& s) { return s.kind == "clean" || s.kind == "noise"; };
  const Filter level = [](const Score&s) { return !s.tilts; }, tilts = [](const Score&s) { return s.tilts; };
  const auto rate = [](Filter of, Filter counts) {
    return [of = std::move(of), counts = std::move(counts)](std::span<const Score> s) { return cell(s, of, counts); };
  };
  const auto spread = [](Filter of, std::function<double(const Score&)> value, const char* unit) {
    return [of = std::move(of), value = std::move(value), unit](std::span<const Score> s) {
      return quartiles(s, of, value, unit);
    };
  };
  return {
      {"single effect, strong: named first, or in an alias set of three", rate(of_kind("single", "strong"), good)},
      {"single effect, medium", rate(of_kind("single", "medium"), good)},
      {"single effect, weak", rate(of_kind("single", "weak"), good)},
      {"single effect, fainter than weak", rate(of_kind("single", "faint"), good)},
      {"single effect, all sizes", rate(of_kind("single"), good)},
      {"pair found whole", rate(of_kind("pair"), good)},
      {"sets with an effect in which a wrong name is accepted",
       rate(effects, [](const Score& s) { return s.strangers > 0; })},
      {"false alarms: clean data, coloured noise alone",
       rate(quiet, [](const Score& s) { return s.outcome == "false alarm"; })},
      {"clean data, coloured noise alone: the verdict is adequate",
       rate(quiet, [](const Score& s) { return s.verdict == "adequate"; })},
      {"outside the catalogue: the verdict is unexplained",
       rate(of_kind("foreign"), [](const Score& s) { return s.verdict == "unexplained"; })},
      {"outside the catalogue: a wrong confident name",
       rate(of_kind("foreign"), [](const Score& s) { return s.outcome == "wrong name"; })},
      {"right name, but another thruster, axis or law than the true one",
       rate([](const Score& s) { return s.outcome == "named"; }, [](const Score& s) { return s.wrong_form; })},
      {"95 % intervals of effect parameters that hold the truth",
       [](std::span<const Score> s) {
         long inside = 0, all = 0;
         for (const Score& score : s) {
           for (const double x : score.deviations) inside += std::abs(x) < 1.96 ? 1 : 0, ++all;
         }
         const Rate held = wilson(inside, all);
         if (all == 0) return std::string("-");
         return text("%.0f %% (%ld of %ld; %.0f to %.0f %%)", 100.0 * held.share, inside, all, 100.0 * held.low,
                     100.0 * held.high);
       }},
      {"5 s error over that of the true simulator, sets with an effect: median (quartiles; most)",
       spread(
           effects, [](const Score& s) { return s.after / s.floor; }, "")},
      {"processor time, craft of up to four axes: median (quartiles; most)",
       spread(
           level, [](const Score& s) { return s.processor; }, " s")},
      {"processor time, craft that roll or pitch", spread(
                                                       tilts, [](const Score& s) { return s.processor; }, " s")},
      {"runs that failed",
       rate([](const Score&) { return true; }, [](const Score& s) { return s.outcome == "failed"; })},
  };
}

void add_differences(std::span<const CoreScores> cores, std::string& page) {
  const auto joined = [](const std::vector<std::string>& names) {
    std::string all;
    for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
    return all.empty() ? std::string("-") : all;
  };
  page +=
      "\n## Sets that any of them got wrong\n\n| set | truth | size | core | outcome | accepted | verdict |\n"
      "|---|---|---|---|---|---|---|\n";
  for (std::size_t i = 0; !cores.empty() && i < cores.front().scores.size(); ++i) {
    if (std::ranges::all_of(cores, [&](const CoreScores& core) { return core.scores[i].good; })) continue;
    for (const CoreScores& core : cores) {
      const Score& s = core.scores[i];
      page += "| " + std::to_string(s.seed) + " | " + (s.truth.empty() ? s.kind : joined(s.truth)) + " | " + s.size +
              " | " + core.core + " | " + s.outcome + " | " + joined(s.found) + " | " + s.verdict + " |\n";
    }
  }
}

}  // namespace

Rate wilson(long part, long whole) {
  if (whole <= 0) return {};
  constexpr double z = 1.959964;  // of 95 %
  const double n = static_cast<double>(whole), p = static_cast<double>(part) / n;
  const double middle = (p + z * z / (2.0 * n)) / (1.0 + z * z / n);
  const double half = z / (1.0 + z * z / n) * std::sqrt(p * (1.0 - p) / n + z * z / (4.0 * n * n));
  return {p, std::max(0.0, middle - half), std::min(1.0, middle + half)};
}

std::string to_comparison(std::span<const CoreScores> cores, const std::string& how) {
  std::set<std::uint64_t> common;
  if (!cores.empty()) {
    for (const Score& score : cores.front().scores) {
      const auto answers = [&](const CoreScores& core) {
        return std::ranges::any_of(core.scores, [&](const Score& s) { return s.seed == score.seed; });
      };
      if (std::ranges::all_of(cores, answers)) common.insert(score.seed);
    }
  }
  std::vector<CoreScores> same;
  for (const CoreScores& core : cores) {
    same.push_back({core.core, only(core.scores, common)});
    std::ranges::sort(same.back().scores, {}, &Score::seed);
  }
  std::string page = "# Cores side by side\n\nWritten by `" + how + "`: " + std::to_string(common.size()) +
                     " sets, each by every core.\nShares with their 95 % intervals (Wilson 1927).\n\n| what |";
  for (const CoreScores& core : same) page += " " + core.core + " |";
  page += "\n|---|";
  for (std::size_t i = 0; i < same.size(); ++i) page += "---|";
  page += "\n";
  for (const Row& row : rows()) {
    page += "| " + row.what + " |";
    for (const CoreScores& core : same) page += " " + row.cell(core.scores) + " |";
    page += "\n";
  }
  add_differences(same, page);
  return page;
}

}  // namespace fathom::sealed
