// Voltage of the supply about its mean `a` [V], as a share of it; thrust goes with a power between one and three, which
// this and its square hold. `b` is the spread of the share, `c` the most that its recording has shown: what goes with
// it is a law, believed as far again. Where it was not logged the factor is 0, and with it all that it multiplies.
#include "common/model/learned/factors/factor_kind.hpp"

namespace fathom::model {
namespace {

double about_mean(const Factor& f, const FeatureState& s) { return s.voltage > 0.0 ? s.voltage / f.a - 1.0 : 0.0; }

}  // namespace

constinit const FactorKind factor_voltage{
    .word = "voltage",
    .sentence = "the voltage of the supply, about its mean",
    .unit = "1",
    .value = [](const Factor& f, const FeatureState& s) { return about_mean(f, s) / f.b; },
    .words = [](const Factor& f) { return "(V / " + brief_number(f.a) + " V - 1) / " + brief_number(f.b); },
    .within = [](const Factor& f, const FeatureState& s,
                 const Visited&) { return fade_beyond(about_mean(f, s), kLawReach / kVisitedReach * f.c); }};

}  // namespace fathom::model
