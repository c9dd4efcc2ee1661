// Physics: water that moves in the world frame; drag and added-mass terms feel the relative velocity
// nu_r = nu - [R_WB^T v_WF; 0] (Fossen 2011, sec. 8.1). Forms: the ordinary one is steady; `by depth`, v_WF grows along
// a line with the depth (shear: wind above, a layer below); `turning`, v_WF becomes another about a moment (a stream
// that sets in, a tide that turns); `changing`, it goes along straight lines between seven moments of the run, and
// stays beyond them. Ignores: vertical flow, what changes from
// place to place, that the water's own acceleration pushes. Revealed by the same motion on several headings, depths,
// early and late. Confused with a tether's constant pull and with W-B tilted by trim.
#include <algorithm>
#include <array>

#include "common/model/effect.hpp"
#include "common/model/onset.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::size_t kMoments = 7;  // a tide's turn takes minutes, and two of them are never closer than that
constexpr double kShearSigma = 0.05, kMostShear = 3.0;  // 1/s: the same over some metres
constexpr double kLeastDepths = 0.3;                    // m that must have been visited to tell one from another
constexpr double kLeastSpan = 60.0;                     // s: below, nothing in the water changes along lines

constexpr EffectParameter velocity(std::string_view name) {
  return {.name = name, .unit = "m/s", .sigma = 0.1, .low = -3.0, .high = 3.0};
}
constexpr EffectParameter shear(std::string_view name) {
  return {.name = name, .unit = "1/s", .sigma = kShearSigma, .low = -kMostShear, .high = kMostShear};
}
constexpr std::array kCurrentParameters{
    velocity("v_N"), velocity("v_E"), shear("shear_N"), shear("shear_E"),
    // After the turn, or at the second moment and on; v_N, v_E are those before it, or at the first one.
    velocity("v_N_2"), velocity("v_E_2"), velocity("v_N_3"), velocity("v_E_3"), velocity("v_N_4"), velocity("v_E_4"),
    velocity("v_N_5"), velocity("v_E_5"), velocity("v_N_6"), velocity("v_E_6"), velocity("v_N_7"), velocity("v_E_7"),
    EffectParameter{"at_depth", "m", 100.0}, EffectParameter{"from", "s", 1e3}, EffectParameter{"until", "s", 1e3},
    kOnsetParameter,
    EffectParameter{
        .name = "duration", .unit = "s", .sigma = 30.0, .low = kOnsetDuration, .high = 600.0, .blurred = true}};
constexpr std::size_t kNorth = 0, kEast = 1, kShearNorth = 2, kShearEast = 3, kNext = 4;
constexpr std::size_t kAmplitudes = kNext + 2 * (kMoments - 1);
constexpr std::size_t kAtDepth = kAmplitudes, kFrom = kAtDepth + 1, kUntil = kFrom + 1, kTurn = kUntil + 1,
                      kDuration = kTurn + 1;
static_assert(kCurrentParameters.size() == kDuration + 1);
constexpr double kStart = 0.01;               // m/s
constexpr std::array kTurnStarts{2.0, 30.0};  // s within which it turns
constexpr int kTurnMoments = 10;

void flow(Motion& motion, double north, double east) {
  motion.v_WF_B += motion.R_WB.transpose() * Eigen::Vector3d(north, east, 0.0);
}

bool seen(const Scene& scene) { return scene.attitude && scene.velocity; }

class Steady final : public Form {
 public:
  Steady() : Form{{.sought = {kNorth, kEast}, .obeys = 0}} {}
  FormName name(const Scene& scene) const override { return when(seen(scene)); }
  Starts starts(const Scene&) const override {
    std::vector<double> start(kCurrentParameters.size(), 0.0);
    start[kNorth] = start[kEast] = kStart;
    return {start};
  }
  void feel(Motion& motion, EffectTheta theta, std::span<const double>) const override {
    flow(motion, theta[kNorth], theta[kEast]);
  }
};

class ByDepth final : public Form {
 public:
  ByDepth() : Form{{.sought = {kNorth, kEast, kShearNorth, kShearEast}, .given = {kAtDepth}, .obeys = 0}} {}
  FormName name(const Scene& scene) const override {
    return when(seen(scene) && scene.position && scene.p_high.z() - scene.p_low.z() > kLeastDepths, "by depth");
  }
  Starts starts(const Scene& scene) const override {
    std::vector<double> start(kCurrentParameters.size(), 0.0);
    start[kNorth] = start[kEast] = kStart;
    start[kShearNorth] = start[kShearEast] = kStart / std::max(scene.p_high.z() - scene.p_low.z(), kLeastDepths);
    start[kAtDepth] = 0.5 * (scene.p_low.z() + scene.p_high.z());
    return {start};
  }
  void feel(Motion& motion, EffectTheta theta, std::span<const double>) const override {
    const double below = motion.p_WB.z() - theta[kAtDepth];
    flow(motion, theta[kNorth] + theta[kShearNorth] * below, theta[kEast] + theta[kShearEast] * below);
  }
};

class Changing final : public Form {
 public:
  Changing() : Form{traits_of_changing()} {}
  FormName name(const Scene& scene) const override {
    return when(seen(scene) && scene.runs == 1 && scene.t_high - scene.t_low > kLeastSpan, "changing");
  }
  Starts starts(const Scene& scene) const override {
    std::vector<double> start(kCurrentParameters.size(), 0.0);
    for (std::size_t i = 0; i < start.size(); ++i)
      if (traits().sought.has(i)) start[i] = kStart;
    start[kFrom] = scene.t_low;
    start[kUntil] = scene.t_high;
    return {start};
  }
  void feel(Motion& motion, EffectTheta theta, std::span<const double>) const override {
    const double span = theta[kUntil] - theta[kFrom];
    const double place =
        span > 0.0 ? std::clamp((motion.t - theta[kFrom]) / span, 0.0, 1.0) * static_cast<double>(kMoments - 1) : 0.0;
    const auto k = std::min(static_cast<std::size_t>(place), kMoments - 2);
    const double share = place - static_cast<double>(k);
    const std::size_t before = north_of(k), after = north_of(k + 1);
    flow(motion, (1.0 - share) * theta[before] + share * theta[after],
         (1.0 - share) * theta[before + 1] + share * theta[after + 1]);
  }

 private:
  static std::size_t north_of(std::size_t moment) { return moment == 0 ? kNorth : kNext + 2 * (moment - 1); }
  static FormTraits traits_of_changing() {
    NumberSet sought{kNorth, kEast};
    for (std::size_t i = kNext; i < kAmplitudes; ++i) sought.add(i);
    return {.sought = sought, .given = {kFrom, kUntil}, .obeys = 0};
  }
};

class Turning final : public Form {
 public:
  Turning() : Form{{.sought = {kNorth, kEast, kNext, kNext + 1, kTurn, kDuration}, .obeys = 0}} {}
  FormName name(const Scene& scene) const override {
    return when(seen(scene) && scene.runs == 1 && scene.t_high - scene.t_low > kLeastSpan, "turning");
  }
  Starts starts(const Scene& scene) const override {
    Starts starts;
    for (const double moment : onset_starts(scene.t_low, scene.t_high, kTurnMoments)) {
      for (const double duration : kTurnStarts) {
        std::vector<double> start(kCurrentParameters.size(), 0.0);
        for (const std::size_t i : {kNorth, kEast, kNext, kNext + 1}) start[i] = kStart;
        start[kTurn] = moment;
        start[kDuration] = duration;
        starts.push_back(std::move(start));
      }
    }
    return starts;
  }
  void feel(Motion& motion, EffectTheta theta, std::span<const double>) const override {
    const double after = share_over(motion.t, theta[kTurn], theta[kDuration]);
    flow(motion, (1.0 - after) * theta[kNorth] + after * theta[kNext],
         (1.0 - after) * theta[kEast] + after * theta[kNext + 1]);
  }
};

}  // namespace

const Effect& current() {
  static const Effect kEffect{{.name = "current",
                               .sentence = "The water itself moves past the site.",
                               .revealed_by = "the same motion on opposite and crossing headings, above and below, "
                                              "early and late",
                               .stage = Stage::kWater,
                               .amplitudes = static_cast<int>(kAmplitudes),
                               .feels_place = true},
                              kCurrentParameters,
                              forms(Steady{}, ByDepth{}, Turning{}, Changing{})};
  return kEffect;
}

}  // namespace fathom::model::effects
