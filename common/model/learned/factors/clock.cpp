// Factors that read the clock: what of them another run is told, lasting_of and as_it_stands say. A ramp ends where its
// recording did, what settles is believed as far again.
#include "common/model/learned/factors/factor_kind.hpp"

namespace fathom::model {
namespace {

/// Of a swing of frequency `a` [rad/s] whose phase goes with the place, `b` toward north and `c` toward east [rad/m].
double phase(const Factor& f, const FeatureState& s) { return f.a * s.t - f.b * s.p_WB.x() - f.c * s.p_WB.y(); }

/// Water without vorticity that swings so along the plane dies away downward at the rate of its wave number (Laplace).
double left_at_depth(const Factor& f, const FeatureState& s) {
  constexpr double kMost = 3.0;  // exponents: z = 0 need not be the surface
  return std::exp(std::clamp(-std::hypot(f.b, f.c) * s.p_WB.z(), -kMost, kMost));
}

std::string phase_words(const Factor& f) {
  std::string words = brief_number(f.a) + " t";
  for (const auto& [number, place] : {std::pair{f.b, " x"}, std::pair{f.c, " y"}}) {
    if (number != 0.0) words += (number > 0.0 ? " - " : " + ") + brief_number(std::abs(number)) + place;
  }
  return words;
}

std::string depth_words(const Factor& f) {
  const double number = std::hypot(f.b, f.c);
  return number > 0.0 ? "exp(-" + brief_number(number) + " z) " : "";
}

}  // namespace

constinit const FactorKind factor_after{.word = "after",
                                        .sentence = "a moment: nothing before it, all after it",
                                        .unit = "1",
                                        .in_time = true,
                                        .value =
                                            [](const Factor& f, const FeatureState& s) {
                                              const double x = std::clamp((s.t - f.a) / f.b + 0.5, 0.0, 1.0);
                                              return x * x * (3.0 - 2.0 * x);
                                            },
                                        .words = [](const Factor& f) { return "1(t > " + brief_number(f.a) + " s)"; }};

constinit const FactorKind factor_ramp{
    .word = "ramp",
    .sentence = "time",
    .unit = "1",
    .in_time = true,
    .grows = true,
    .value = [](const Factor& f, const FeatureState& s) { return std::clamp((s.t - f.a) / f.b, -1.0, 1.0); },
    .words = [](const Factor& f) { return "(t - " + brief_number(f.a) + " s) / " + brief_number(f.b) + " s"; }};

/// What goes to an end at a rate that falls with the way that is left: from `a` [s], within `b` [s], believed until
/// `c`.
constinit const FactorKind factor_settling{
    .word = "settling",
    .sentence = "time, ever more slowly",
    .unit = "1",
    .in_time = true,
    .grows = true,
    .value = [](const Factor& f,
                const FeatureState& s) { return -std::expm1(-std::max(std::min(s.t, f.c) - f.a, 0.0) / f.b); },
    .words =
        [](const Factor& f) {
          const std::string since = f.a == 0.0 ? "t" : "(t - " + brief_number(f.a) + " s)";
          return "(1 - exp(-" + since + " / " + brief_number(f.b) + " s))";
        }};

constinit const FactorKind factor_tone_cosine{
    .word = "tone_cosine",
    .sentence = "a swing",
    .unit = "1",
    .in_time = true,
    .value = [](const Factor& f, const FeatureState& s) { return std::cos(f.a * s.t); },
    .rate = [](const Factor& f, const FeatureState& s) { return -f.a * std::sin(f.a * s.t); },
    .words = [](const Factor& f) { return "cos(" + brief_number(f.a) + " t)"; }};

constinit const FactorKind factor_tone_sine{
    .word = "tone_sine",
    .sentence = "a swing",
    .unit = "1",
    .in_time = true,
    .value = [](const Factor& f, const FeatureState& s) { return std::sin(f.a * s.t); },
    .rate = [](const Factor& f, const FeatureState& s) { return f.a * std::cos(f.a * s.t); },
    .words = [](const Factor& f) { return "sin(" + brief_number(f.a) + " t)"; }};

constinit const FactorKind factor_travel_cosine{
    .word = "travel_cosine",
    .sentence = "a swing that travels",
    .unit = "1",
    .in_time = true,
    .value = [](const Factor& f, const FeatureState& s) { return left_at_depth(f, s) * std::cos(phase(f, s)); },
    .rate = [](const Factor& f, const FeatureState& s) { return -f.a * left_at_depth(f, s) * std::sin(phase(f, s)); },
    .words = [](const Factor& f) { return depth_words(f) + "cos(" + phase_words(f) + ")"; }};

constinit const FactorKind factor_travel_sine{
    .word = "travel_sine",
    .sentence = "a swing that travels",
    .unit = "1",
    .in_time = true,
    .value = [](const Factor& f, const FeatureState& s) { return left_at_depth(f, s) * std::sin(phase(f, s)); },
    .rate = [](const Factor& f, const FeatureState& s) { return f.a * left_at_depth(f, s) * std::cos(phase(f, s)); },
    .words = [](const Factor& f) { return depth_words(f) + "sin(" + phase_words(f) + ")"; }};

}  // namespace fathom::model
