// Factors that read the place and the heading. Bumps fade by themselves; all headings are near one that was visited.
#include <numbers>

#include "common/model/learned/factors/factor_kind.hpp"

namespace fathom::model {
namespace {

double square(double x) { return x * x; }

template <int axis>
double in_box(const Factor&, const FeatureState& s, const Visited& visited) {
  return fade_outside(s.p_WB[axis], visited.p_low[axis], visited.p_high[axis]);
}
template <int axis>
double along(const Factor& f, const FeatureState& s) {
  return (s.p_WB[axis] - f.a) / f.b;
}
std::string line(const char* symbol, const Factor& f) {
  return "(" + std::string{symbol} + (f.a < 0.0 ? " + " : " - ") + brief_number(std::abs(f.a)) + " m) / " +
         brief_number(f.b) + " m";
}
/// How far beyond the edge `a` of what was visited, m: toward the bearing `c`, downward (index 1) or upward (2).
double beyond_edge(const Factor& f, const FeatureState& s) {
  if (f.index == 1) return s.p_WB.z() - f.a;
  if (f.index == 2) return -s.p_WB.z() - f.a;
  return std::cos(f.c) * s.p_WB.x() + std::sin(f.c) * s.p_WB.y() - f.a;
}
std::string bearing_words(double bearing) {
  const double turn = std::fmod(bearing * 180.0 / std::numbers::pi + 720.0, 360.0);
  return std::to_string(static_cast<int>(std::lround(turn)) % 360);
}
std::string beyond(const std::string& away, double length) {
  return length > 0.0 ? "max(" + away + " - " + brief_number(length) + " m, 0)" : away;
}
/// Like a law of the first `axes`: as far again as it has been.
double as_far_again(int axes, const FeatureState& s, const Visited& visited) {
  double left = 1.0;
  for (int i = 0; i < axes; ++i) {
    const double half = 0.5 * (visited.p_high[i] - visited.p_low[i]);
    left *= fade_outside(s.p_WB[i], visited.p_low[i] - half, visited.p_high[i] + half);
  }
  return left;
}
std::string in_plan(const Factor& f) { return "N " + brief_number(f.a) + " m, E " + brief_number(f.b) + " m"; }
std::string from_away(double length) {
  return length > 0.0 ? ", acting from " + brief_number(length) + " m away" : std::string{};
}
std::string turns(const Factor& f) { return f.index == 1 ? "psi" : std::to_string(f.index) + " psi"; }

}  // namespace

constinit const FactorKind factor_depth{.word = "depth",
                                        .sentence = "depth, about the middle of the range",
                                        .unit = "1",
                                        .value = along<2>,
                                        .words = [](const Factor& f) { return line("z", f); },
                                        .within = in_box<2>};
constinit const FactorKind factor_north{.word = "north",
                                        .sentence = "place along north",
                                        .unit = "1",
                                        .value = along<0>,
                                        .words = [](const Factor& f) { return line("x", f); },
                                        .within = in_box<0>};
constinit const FactorKind factor_east{.word = "east",
                                       .sentence = "place along east",
                                       .unit = "1",
                                       .value = along<1>,
                                       .words = [](const Factor& f) { return line("y", f); },
                                       .within = in_box<1>};

constinit const FactorKind factor_depth_bump{
    .word = "depth_bump",
    .sentence = "depth, near one value of it",
    .unit = "1",
    .value = [](const Factor& f, const FeatureState& s) { return std::exp(-0.5 * square((s.p_WB.z() - f.a) / f.b)); },
    .words = [](const Factor& f) { return "near depth " + brief_number(f.a) + " m"; }};

constinit const FactorKind factor_plan_bump{
    .word = "plan_bump",
    .sentence = "place, near one point of the plan",
    .unit = "1",
    .value =
        [](const Factor& f, const FeatureState& s) {
          return std::exp(-0.5 * (square(s.p_WB.x() - f.a) + square(s.p_WB.y() - f.b)) / square(f.c));
        },
    .words = [](const Factor& f) { return "near (" + brief_number(f.a) + ", " + brief_number(f.b) + ") m"; },
    .where = [](const Factor& f) { return "place at " + in_plan(f) + ", " + brief_number(f.c) + " m wide"; }};

constinit const FactorKind factor_near{
    .word = "near",
    .sentence = "nearness to an edge of where the recording has been: 1 there, falling exponentially, and at most 2",
    .unit = "1",
    .value = [](const Factor& f,
                const FeatureState& s) { return std::min(std::exp(beyond_edge(f, s) / f.b), kLawReach); },
    .words =
        [](const Factor& f) {
          const std::string to = f.index == 0 ? "(" + bearing_words(f.c) + " deg)" : std::string{};
          return "exp(-d" + to + " / " + brief_number(f.b) + " m)";
        },
    .where =
        [](const Factor& f) {
          const std::string toward = f.index == 1   ? "below"
                                     : f.index == 2 ? "above"
                                                    : "toward " + bearing_words(f.c) + " deg";
          return "edge " + toward + ", where " + brief_number(f.b) + " m away from it a third is left";
        },
    .within =
        [](const Factor& f, const FeatureState& s, const Visited&) {
          return fade_beyond(std::max(beyond_edge(f, s) + f.b, 0.0), f.b * kLawReach / kVisitedReach);
        }};

constinit const FactorKind factor_stretch{
    .word = "stretch",
    .sentence = "how much farther than a length d the point (a, b, c) is: of a line that is slack before",
    .unit = "m",
    .of_point = true,
    .value =
        [](const Factor& f, const FeatureState& s) {
          return std::max((Eigen::Vector3d{f.a, f.b, f.c} - s.p_WB).norm() - f.d, 0.0);
        },
    .words =
        [](const Factor& f) {
          const std::string point = "(" + brief_number(f.a) + ", " + brief_number(f.b) + ", " + brief_number(f.c) + ")";
          return beyond("|" + point + " - p|", f.d);
        },
    .where =
        [](const Factor& f) { return "point at " + in_plan(f) + ", D " + brief_number(f.c) + " m" + from_away(f.d); },
    .within = [](const Factor&, const FeatureState& s, const Visited& visited) { return as_far_again(3, s, visited); }};

constinit const FactorKind factor_plan_stretch{
    .word = "plan_stretch",
    .sentence =
        "how much farther than a length d the point (a, b) of the plan is: of a line that hangs down to the craft",
    .unit = "m",
    .of_point = true,
    .value = [](const Factor& f,
                const FeatureState& s) { return std::max(std::hypot(s.p_WB.x() - f.a, s.p_WB.y() - f.b) - f.d, 0.0); },
    .words =
        [](const Factor& f) {
          return beyond("|(" + brief_number(f.a) + ", " + brief_number(f.b) + ") - (x, y)|", f.d);
        },
    .where = [](const Factor& f) { return "point at " + in_plan(f) + from_away(f.d); },
    .within = [](const Factor&, const FeatureState& s, const Visited& visited) { return as_far_again(2, s, visited); }};

constinit const FactorKind factor_heading_cosine{
    .word = "heading_cosine",
    .sentence = "the cosine of the heading",
    .unit = "1",
    .indexed = Indexed::kHarmonics,
    .value =
        [](const Factor& f, const FeatureState& s) {
          return f.index == 1 ? s.heading_cosine : square(s.heading_cosine) - square(s.heading_sine);
        },
    .words = [](const Factor& f) { return "cos " + turns(f); }};

constinit const FactorKind factor_heading_sine{.word = "heading_sine",
                                               .sentence = "the sine of the heading",
                                               .unit = "1",
                                               .indexed = Indexed::kHarmonics,
                                               .value =
                                                   [](const Factor& f, const FeatureState& s) {
                                                     return f.index == 1 ? s.heading_sine
                                                                         : 2.0 * s.heading_cosine * s.heading_sine;
                                                   },
                                               .words = [](const Factor& f) { return "sin " + turns(f); }};

}  // namespace fathom::model
