#include "test/sealed/judging/learning.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <functional>
#include <vector>

#include "test/sealed/judging/rate.hpp"

namespace fathom::sealed {
namespace {

__attribute__((format(printf, 1, 2))) std::string text(const char* pattern, ...) {
  std::array<char, 300> buffer{};
  va_list list;
  va_start(list, pattern);
  std::vsnprintf(buffer.data(), buffer.size(), pattern, list);
  va_end(list);
  return buffer.data();
}

/// One set: what was hidden, with which answer of the tool, and the same told.
struct Row {
  const Score* learned{};
  const Score* told{};  ///< only where a listed effect was taken out
  [[nodiscard]] double over_base() const { return learned->after_far / learned->before_far; }
  [[nodiscard]] double over_told() const { return told == nullptr ? kUnknown : learned->after_far / told->after_far; }
};

std::string spread(std::vector<double> values) {
  std::erase_if(values, [](double x) { return !std::isfinite(x); });
  if (values.empty()) return "-";
  std::ranges::sort(values);
  const auto at = [&](double share) {
    return values[static_cast<std::size_t>(std::lround(share * static_cast<double>(values.size() - 1)))];
  };
  return text("%.2f (%.2f to %.2f; most %.2f)", at(0.5), at(0.25), at(0.75), values.back());
}

std::string share(std::span<const Row> rows, const std::function<bool(const Row&)>& counts) {
  const auto whole = static_cast<long>(rows.size());
  const long part = std::ranges::count_if(rows, counts);
  if (whole == 0) return "-";
  const Rate rate = wilson(part, whole);
  return text("%.0f %% (%ld of %ld; %.0f to %.0f %%)", 100.0 * rate.share, part, whole, 100.0 * rate.low,
              100.0 * rate.high);
}

void add_line(std::string& page, const std::string& what, const std::string& target, const std::string& reached) {
  page += "| " + what + " | " + target + " | " + reached + " |\n";
}

void add_block(std::string& page, const std::string& what, std::span<const Row> rows) {
  std::vector<double> over_base;
  for (const Row& row : rows) over_base.push_back(row.over_base());
  add_line(page, what + ": a correction is adopted", "-", share(rows, [](const Row& r) { return r.learned->learned; }));
  add_line(page, what + ": and told of the new recording", "-",
           share(rows, [](const Row& r) { return r.learned->learned && r.learned->carried; }));
  add_line(page, what + ": error over base, median (quartiles; most)", "-", spread(over_base));
}

void add_set(std::string& page, const Row& row) {
  const Score& s = *row.learned;
  const auto joined = [](const std::vector<std::string>& names) {
    std::string all;
    for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
    return all.empty() ? std::string("-") : all;
  };
  const auto ratio = [](double x) { return std::isfinite(x) ? text("%.3f", x) : std::string("-"); };
  std::string correction = s.correction;
  std::ranges::replace(correction, '|', '!');  // a column's border in Markdown
  page += "| " + std::to_string(s.seed) + " | " + (s.truth.empty() ? s.kind : joined(s.truth)) + " | " + s.size +
          " | " + s.verdict + " | " + joined(s.found) + " | " + (s.learned ? s.carried ? "carried" : "adopted" : "no") +
          " | " + ratio(row.over_base()) + " | " + ratio(row.over_told()) + " | " +
          (correction.empty() ? "-" : correction) + text(" | %.0f s |\n", s.processor);
}

}  // namespace

std::string to_learning_page(std::span<const Score> told, std::span<const Score> left_out, const std::string& how) {
  std::vector<Row> listed, unlisted, empty;
  for (const Score& score : left_out) {
    const auto same = std::ranges::find_if(told, [&](const Score& s) { return s.seed == score.seed; });
    if (same != told.end()) listed.push_back({&score, &*same});
  }
  for (const Score& score : told) {
    if (score.kind == "foreign") unlisted.push_back({&score, nullptr});
    if (score.kind == "clean") empty.push_back({&score, nullptr});
  }
  std::string page = "Written by `" + how +
                     "`. Errors: 10 s open loop on a recording that no fit has seen, each axis over its motion, mean "
                     "over the axes. \"Over told\": of the same set with the true effect in the list.\n\n"
                     "| what | target | reached |\n|---|---|---|\n";
  if (!listed.empty()) {
    std::vector<double> over_told;
    for (const Row& row : listed) over_told.push_back(row.over_told());
    add_block(page, "a listed effect taken out", listed);
    add_line(page, "a listed effect taken out: error over told, median (quartiles; most)", "1.05", spread(over_told));
    add_line(page, "a listed effect taken out: at most 1.3 of told", "90 %",
             share(listed, [](const Row& r) { return r.over_told() <= 1.3; }));
    add_line(page, "a listed effect taken out: above 1.02 of base", "never",
             share(listed, [](const Row& r) { return r.over_base() > 1.02; }));
  }
  if (!unlisted.empty()) {
    add_block(page, "a mechanism that nothing lists", unlisted);
    add_line(page, "a mechanism that nothing lists: at most .25 of base", "median",
             share(unlisted, [](const Row& r) { return r.over_base() <= 0.25; }));
    add_line(page, "a mechanism that nothing lists: above 1.02 of base", "never",
             share(unlisted, [](const Row& r) { return r.over_base() > 1.02; }));
    add_line(page, "a mechanism that nothing lists: a listed name is told", "never",
             share(unlisted, [](const Row& r) { return !r.learned->found.empty(); }));
  }
  if (!empty.empty()) {
    add_block(page, "nothing hidden", empty);
    add_line(page, "nothing hidden: error within 1 % of base", "all",
             share(empty, [](const Row& r) { return std::abs(r.over_base() - 1.0) <= 0.01; }));
  }
  page +=
      "\n| set | truth | size | verdict | names | correction | over base | over told | with, or why not | processor "
      "|\n|---|---|---|---|---|---|---|---|---|---|\n";
  for (const auto* rows : {&listed, &unlisted, &empty}) {
    for (const Row& row : *rows) add_set(page, row);
  }
  return page;
}

}  // namespace fathom::sealed
