// docs/learned.md and its picture: five forces that nothing lists, as they are learned from a simulated recording, with
// the truth beside them. FATHOM_GALLERY_RENEW=yes writes both files anew.
#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>

#include "common/report/correction_figures.hpp"
#include "common/report/text.hpp"
#include "test/common/learning/learned_case.hpp"
#include "test/support/scratch.hpp"

namespace fathom {
namespace {

constexpr double kDuration = 100.0, kForce = 0.01;  // s, m/s^2
constexpr int kColumns = 3;
const std::string kPage = std::string{FATHOM_SOURCE_DIR} + "/docs/learned.md";
const std::string kPicture = std::string{FATHOM_SOURCE_DIR} + "/docs/learned.svg";

struct Hidden {
  const char* what;     ///< in words
  const char* law;      ///< as it was simulated
  const char* learned;  ///< what must be said of it
  test::NoisyDive dive;
  std::string argument;  ///< of the curve that is drawn
  /// N, N m, of that argument; others as in the curve: at half of what was visited. `inertia`: of its axis.
  std::function<double(double x, double inertia, const CorrectionGiven&)> truth;
  int axis{};
};

test::NoisyDive dive_with(unsigned seed, std::function<Vector6d(double, const Vector6d&)> outside) {
  return {.duration = kDuration, .seed = seed, .force = kForce, .outside = std::move(outside)};
}

Vector6d along(int axis, double a) { return a * Vector6d::Unit(axis); }

std::vector<Hidden> hidden() {
  const auto half = [](const CorrectionGiven& given, std::size_t axis) { return 0.5 * given.visited_nu[axis]; };
  std::vector<Hidden> all;
  all.push_back({"Motion ahead pushes aside", "0.4 /m u |u| of acceleration in sway", "velocity in Y",
                 dive_with(3, [](double, const Vector6d& nu) { return along(1, 0.4 * nu[0] * std::abs(nu[0])); }), "u",
                 [](double u, double m, const CorrectionGiven&) { return m * 0.4 * u * std::abs(u); }, 1});
  all.push_back(
      {"Drag that grows with time, as by weed", "0.012 /(m s) t u |u| against the motion ahead",
       "drag, growing with time in X",
       dive_with(5, [](double t, const Vector6d& nu) { return along(0, -0.012 * t * nu[0] * std::abs(nu[0])); }), "t",
       [half](double t, double m, const CorrectionGiven& given) {
         const double u = half(given, 0);
         return -m * 0.012 * (t - 0.5 * kDuration) * u * std::abs(u);  // the mean is the model's own
       },
       0});
  all.push_back(
      {"Something is caught at a moment", "1.2 /m u |u| against the motion ahead, from 60 s on",
       "drag, from a moment on in X",
       dive_with(
           6, [](double t, const Vector6d& nu) { return along(0, t > 60.0 ? -1.2 * nu[0] * std::abs(nu[0]) : 0.0); }),
       "u", [](double u, double m, const CorrectionGiven&) { return -m * 1.2 * u * std::abs(u); }, 0});
  all.push_back({"Drifting while going ahead presses the hull down", "1.5 /m u v of acceleration downwards",
                 "velocity in Z",
                 dive_with(7, [](double, const Vector6d& nu) { return along(2, 1.5 * nu[0] * nu[1]); }), "v",
                 [half](double v, double m, const CorrectionGiven& given) { return m * 1.5 * half(given, 0) * v; }, 2});
  all.push_back({"Speed ahead lifts the hull", "0.5 /m u^2 of acceleration upwards", "velocity in Z",
                 dive_with(8, [](double, const Vector6d& nu) { return along(2, -0.5 * nu[0] * nu[0]); }), "u",
                 [](double u, double m, const CorrectionGiven&) { return -m * 0.5 * u * u; }, 2});
  return all;
}

std::string sheet(const std::vector<report::Figure>& figures) {
  const int w = figures.front().width, h = figures.front().height;
  const int rows = (static_cast<int>(figures.size()) + kColumns - 1) / kColumns;
  const std::string width = std::to_string(kColumns * w), height = std::to_string(rows * h);
  std::string all = "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" width=\"" +
                    width + "\" height=\"" + height + "\" viewBox=\"0 0 " + width + " " + height +
                    "\"><rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
  const std::vector<std::string> pictures = report::render(figures);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const int at = static_cast<int>(i);
    std::string one = pictures[i];
    one.insert(4, " x=\"" + std::to_string(at % kColumns * w) + "\" y=\"" + std::to_string(at / kColumns * h) +
                      "\" width=\"" + std::to_string(w) + "\" height=\"" + std::to_string(h) + "\"");
    all += one + "\n";
  }
  return all + "</svg>\n";
}

/// Of a Markdown table.
std::string cell(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.insert(at, "\\");
  return text;
}

}  // namespace

TEST_CASE("learned gallery: five forces that nothing lists are learned, said and drawn as they are") {
  const bool renew = std::getenv("FATHOM_GALLERY_RENEW") != nullptr;
  const std::string kept = renew ? "" : test::read_bytes(kPage), picture = renew ? "" : test::read_bytes(kPicture);
  std::string rows;
  std::vector<report::Figure> figures;
  for (const Hidden& one : hidden()) {
    CAPTURE(one.what);
    const test::LearnedCase recorded{one.dive};
    const learning::Learned learned = recorded.learned();
    test::show(one.what, learned.given);
    CHECK(learned.given.adopted);
    CHECK_MESSAGE(learned.given.words.find(one.learned) != std::string::npos, learned.given.words);
    CHECK(learned.given.held_out < 0.9);
    if (!learned.given.adopted) continue;
    const std::vector<report::CorrectionCurve> curves = report::correction_curves(learned.given);
    const auto curve = std::ranges::find(curves, one.argument, &report::CorrectionCurve::argument);
    REQUIRE(curve != curves.end());
    const double inertia = learned.fit.hypothesis.model.theta[static_cast<std::size_t>(one.axis)];
    std::vector<double> truth;
    double most = 0.0, off = 0.0;
    for (std::size_t k = 0; k < curve->x.size(); ++k) {
      truth.push_back(one.truth(curve->x[k], inertia, learned.given));
      most = std::max(most, std::abs(truth[k]));
      off += std::pow(curve->force[k] - truth[k], 2) / static_cast<double>(curve->x.size());
    }
    CHECK(std::sqrt(off) < 0.3 * most);  // what base numbers hold of it is not the force's
    report::CorrectionCurve drawn = *curve;
    drawn.title = one.what;
    figures.push_back(report::draw_correction(drawn, truth));
    const std::string begin = "| " + std::string{one.what} + " | " + cell(one.law) + " | ";
    rows += begin + cell(learned.given.formula ? learned.given.formula->equation : "a table of features") + " | ";
    std::string numbers;
    for (const NamedValue& number : learned.given.formula ? learned.given.formula->numbers : std::vector<NamedValue>{})
      numbers += (numbers.empty() ? "" : ", ") + number.name + " = " + report::number(number.value, 3) + " ± " +
                 report::number(1.96 * number.std, 2);
    rows += numbers + " | " + report::number(learned.given.held_out, 2) + " |\n";
    if (renew) continue;
    CHECK_MESSAGE(kept.find(begin) != std::string::npos, begin, "not in docs/learned.md: FATHOM_GALLERY_RENEW=yes");
    CHECK(picture.find("aria-label=\"" + report::escape(figures.back().alt) + "\"") != std::string::npos);
  }
  REQUIRE(!figures.empty());
  if (!renew) return;
  std::ofstream{kPicture} << sheet(figures);
  std::ofstream{kPage}
      << "# Forces that no list holds, as they are learned\n\n"
         "Five causes that the model and the list of effects lack, each in a simulated recording of " +
             report::plain(kDuration) +
             " s of a BlueROV2 with noisy\nsensors. What `fathom diagnose` learns of them is a "
             "correction with arguments, not a cause (decisions 170, 189):\na law where one fits, with its numbers and "
             "95 % intervals, in Fossen's notation. Blue: the learned force over one of its arguments, with its\nband; "
             "dashed: the truth, as far as the model's own numbers do not hold it. The last column is the open-loop "
             "error over the base model's,\non stretches that no weight was fitted to.\n\n"
             "![Learned forces beside the truth](learned.svg)\n\n"
             "| hidden | its law | learned | numbers (SI) | error over base |\n|---|---|---|---|---|\n" +
             rows + "\nDrawn and checked by `test/common/learning/learned_gallery_test.cpp`.\n";
}

}  // namespace fathom
