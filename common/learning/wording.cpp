#include "common/learning/wording.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "common/model/learned/factors/factor_kind.hpp"
#include "common/model/learned/told.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::learning {
namespace {

template <typename... Arguments>
std::string text(const char* format, Arguments... arguments) {
  char buffer[512];
  std::snprintf(buffer, sizeof buffer, format, arguments...);
  return buffer;
}

/// What may lie behind a correction of a kind: words of the group, the first that fits. Hints, no findings.
struct Hint {
  const char *term, *modulator, *look_for;
};
constexpr Hint kHints[]{
    {"force toward down", "time", "water in a housing, gas, a line that is paid out, or water that becomes lighter"},
    {"force in Z", "time", "water in a housing, gas, or a line that is paid out"},
    {"mass", "growing with time", "water that comes into a housing, or a line that is paid out"},
    {"mass", "moment", "a load that was taken up or lost at that moment"},
    {"drag", "growing with time", "weed or fouling, or more and more line in the water"},
    {"drag", "from a moment on", "something that was caught or lost at that moment"},
    {"drag", "depth", "the surface, the bottom or a layer of other water"},
    {"drag", "distance", "line in the water that comes from there"},
    {"force toward down", "distance", "a line that comes from there and is heavier, or lighter, than water"},
    {"drag against the way", "", "something that trails in the water: line, a net, weed"},
    {"drag", "place", "walls, or line in the water whose length goes with the place"},
    {"thrust curve", "below a size", "a dead band: commands so small that propellers do not turn"},
    {"thrust curve", "up to a size", "a dead band, or a limit, of propellers or their drivers"},
    {"thrust curve", "", "propellers, drivers or a limit of power whose curve is not that of the vehicle file"},
    {"thruster", "advance", "propellers that lose thrust as the craft moves"},
    {"thrust", "growing with time", "motors that warm, or a supply that sags"},
    {"thrust", "voltage", "a supply whose voltage tells on thrust more, or less, than the vehicle file says"},
    {"thrust", "from a moment on", "damage, a reset or a changed setting at that moment"},
    {"thrust", "by", "flow into the thrusters that goes with the motion, or a supply that is shared"},
    {"thrusters", "done lately", "motors or drivers that warm with their work, or air that they draw"},
    {"thruster", "by thruster", "the wash of one thruster in another"},
    {"thruster off its line", "", "a thruster that is turned, or whose wash meets the hull"},
    {"thruster", "", "that thruster and its driver"},
    {"swing of the water", "", "waves that carry the craft with the water"},
    {"stream", "time", "a tide that turns, or water that is set in motion by the craft itself"},
    {"stream", "moment", "a stream that has set in or turned"},
    {"stream", "depth", "a stream that differs with depth"},
    {"stream", "place", "an eddy or a jet in part of the site"},
    {"a pull toward a point", "", "a tether, a mooring or a hose that is made fast there"},
    {"force toward", "place", "a tether, an outlet, or a stream in part of the site"},
    {"force toward", "", "a tether, or water in motion"},
    {"swing", "", "waves, or a pump or motor of that frequency"},
    {"force", "heading", "magnets, cables that wind, or a sensor whose error turns with the craft"},
    {"velocity a moment ago", "", "flow that is slow to follow: wakes, water in the frame"},
    {"thrust a moment ago", "", "thrust that is slow to follow, by speed or by direction"},
    {"velocity", "", "lift, drag across the axis, or a part of the hull that no symmetry plane holds"}};

/// Period, length and way of the first swing.
std::string swing_words(const CorrectionGiven& given) {
  for (const CorrectionTerm& term : given.terms) {
    for (const CorrectionFactor& factor : term.factors) {
      const auto quantity = model::quantity_from(factor.quantity);
      if (!quantity || model::kind_of(*quantity).rate == nullptr || !(factor.a > 0.0)) continue;
      std::string words = text(" It swings with a period of %.3g s", 2.0 * std::numbers::pi / factor.a);
      const bool travels = *quantity == model::Quantity::kTravelCosine || *quantity == model::Quantity::kTravelSine;
      const double wave_number = travels ? std::hypot(factor.b, factor.c) : 0.0;
      if (wave_number > 0.0)
        words += text(", %.3g m from crest to crest, and travels toward %.0f deg", 2.0 * std::numbers::pi / wave_number,
                      std::fmod(std::atan2(factor.c, factor.b) * 180.0 / std::numbers::pi + 360.0, 360.0));
      return words + ".";
    }
  }
  return "";
}

/// Where lines are made fast, and where walls are.
std::string place_words(const CorrectionGiven& given) {
  std::string words;
  for (const CorrectionTerm& term : given.terms) {
    const std::string where = model::where(term);
    if (!where.empty() && words.find(where) == std::string::npos) words += " It has its " + where + ".";
  }
  return words;
}

/// Whether a law of it sets in.
bool holds_moment(const CorrectionGiven& given) {
  return std::ranges::any_of(given.terms, [](const CorrectionTerm& term) {
    return term.law && std::ranges::any_of(term.factors, [](const CorrectionFactor& factor) {
             return model::quantity_from(factor.quantity) == model::Quantity::kAfter;
           });
  });
}

}  // namespace

std::string look_for(const inference::FreeForceFound& found) {
  if (found.groups.empty()) return "";
  const std::string kind = inference::words(found.groups.front());
  for (const Hint& hint : kHints) {
    if (kind.find(hint.term) != std::string::npos && kind.find(hint.modulator) != std::string::npos)
      return hint.look_for;
  }
  return "";
}

std::string too_little(const std::string& what, double value, const std::string& how, double needed) {
  return what + text(" %.3g, ", value) + how + text(" %.3g needed", needed);
}

std::string correction_sentence(const inference::FreeForceFound& found, const CorrectionGiven& given) {
  std::string with;
  for (const inference::GroupFound& group : found.groups) with += (with.empty() ? "" : "; ") + words(group);
  std::string sentence = text(
                             "A force that no listed effect explains, %.1f %% of the applied force in %s, was learned "
                             "and added to the model. It goes with ",
                             100.0 * given.size, model::kAxisNames[static_cast<std::size_t>(found.size.axis)]) +
                         with + "." + swing_words(given) + place_words(given) +
                         (given.formula ? " " + given.formula->words : "") +
                         " It is a correction with arguments, not a cause.";
  if (!given.look_for.empty()) sentence += " Look for " + given.look_for + ".";
  const double fall = 100.0 * (1.0 - given.held_out);
  sentence += text(" Where its weights were not fitted, the open-loop error is %.0f %% lower (%d predictions).", fall,
                   given.windows);
  if (!given.carried) {
    sentence += " What of it lasts beyond these recordings is not enough to be carried to others.";
  } else if (std::abs(given.held_out_carried - given.held_out) > 1e-12) {
    sentence += text(" Without what depends on time, which other runs are not told, it is %.0f %% lower.",
                     100.0 * (1.0 - given.held_out_carried));
  }
  if (given.carried && holds_moment(given))
    sentence += " Where it sets in at a moment, other runs are told it on their own clock, as listed effects are.";
  if (given.goes_on)
    sentence +=
        " A recording whose clock goes on after these is told what had begun or grown, as it stood at their end, and "
        "what swings or settles, as it goes on.";
  if (given.left.empty()) return sentence;
  sentence += " What remains as a random force, share of the applied force:";
  for (const CorrectionLeft& left : given.left)
    sentence += text(" %s %.1f %% (without it %.1f %%),", left.axis.c_str(), 100.0 * left.share, 100.0 * left.before);
  sentence.back() = '.';
  return sentence;
}

std::string spread_sentence(const CorrectionGiven& given) {
  std::string sentence = " On what judges, all numbers together leave predictions of 10 s open by";
  for (std::size_t i = 0; i < given.prediction_std.size(); ++i) {
    if (given.prediction_std[i] > 0.0)
      sentence += text(" %s %.2g %s,", model::kVelocityNames[i], given.prediction_std[i], i < 3 ? "m/s" : "rad/s");
  }
  if (sentence.back() == ',') {
    sentence.back() = ' ';
    sentence += "(standard deviation).";
  } else {
    sentence.clear();
  }
  if (given.not_visited > 0.0)
    sentence += text(" Of it %.1f %% lies where the force was not learned, not visited: there it fades.",
                     100.0 * given.not_visited);
  return sentence;
}

}  // namespace fathom::learning
