// Factors that read the clock: what of them another run is told, lasting_of and as_it_stands say. A ramp ends where its
// recording did.
#include "common/model/learned/factors/factor_kind.hpp"

namespace fathom::model {

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
    .value = [](const Factor& f, const FeatureState& s) { return std::clamp((s.t - f.a) / f.b, -1.0, 1.0); },
    .words = [](const Factor& f) { return "(t - " + brief_number(f.a) + " s) / " + brief_number(f.b) + " s"; }};

constinit const FactorKind factor_tone_cosine{
    .word = "tone_cosine",
    .sentence = "a swing",
    .unit = "1",
    .in_time = true,
    .value = [](const Factor& f, const FeatureState& s) { return std::cos(f.a * s.t); },
    .words = [](const Factor& f) { return "cos(" + brief_number(f.a) + " t)"; }};

constinit const FactorKind factor_tone_sine{
    .word = "tone_sine",
    .sentence = "a swing",
    .unit = "1",
    .in_time = true,
    .value = [](const Factor& f, const FeatureState& s) { return std::sin(f.a * s.t); },
    .words = [](const Factor& f) { return "sin(" + brief_number(f.a) + " t)"; }};

}  // namespace fathom::model
