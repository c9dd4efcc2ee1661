// When rankings come, and in which order they name what they suspect.
#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "common/diagnosis/live_diagnoser.hpp"
#include "common/model/effect_size.hpp"
#include "test/support/virtual_dive.hpp"

namespace fathom::diagnosis {
namespace {

constexpr Utime kStart = 1'600'000'000'000'000;
constexpr double kBlock = 5.0;  // s

LiveSettings short_settings() {
  LiveSettings settings;
  settings.warm_up = 10.0;
  settings.block = kBlock;
  settings.fewest_blocks = 5;
  return settings;
}

std::vector<EffectRanking> listen(LiveDiagnoser& diagnoser, const Trial& trial) {
  std::vector<EffectRanking> rankings;
  const auto keep = [&](std::optional<EffectRanking> ranking) {
    if (ranking) rankings.push_back(*std::move(ranking));
  };
  for (std::size_t k = 0; k < trial.size(); ++k) {
    const Utime utime = utime_after(kStart, trial.t[k]);
    Thrusters thrusters{.utime = utime};
    thrusters.force.assign(trial.input[k].data(), trial.input[k].data() + trial.input[k].size());
    keep(diagnoser.step(thrusters));
    keep(diagnoser.step(Battery{.utime = utime, .voltage = trial.voltage[k]}));
    keep(diagnoser.step(
        StateEstimate{.utime = utime, .p_WB = trial.p_WB[k], .q_WB = trial.q_WB[k], .nu = trial.nu[k], .valid = true}));
  }
  keep(diagnoser.finish());
  return rankings;
}

}  // namespace

TEST_CASE("live ranking: one per block of message time, collecting until there are enough of them") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const test::VirtualDive dive =
      test::make_dive(vehicle, {.duration = 80.0, .seed = 6, .effects = {test::active("thruster_lag", {0.5})}});
  LiveDiagnoser diagnoser{short_settings(), vehicle};
  const auto rankings = listen(diagnoser, dive.trial);
  REQUIRE(rankings.size() > 10);
  std::size_t collecting = 0;
  for (std::size_t i = 0; i + 1 < rankings.size(); ++i) {
    CHECK(rankings[i].utime > (i == 0 ? kStart : rankings[i - 1].utime));
    if (rankings[i].verdict == "collecting") {
      CHECK(collecting++ == i);
      CHECK(rankings[i].candidates.empty());
    }
  }
  CHECK(collecting > 0);
  CHECK(collecting < rankings.size() - 1);
  // Blocks end at multiples of their length, counted from the first state.
  for (std::size_t i = 1; i + 1 < rankings.size(); ++i) {
    const double t = seconds_between(kStart, rankings[i].utime);
    CHECK(std::fmod(t, kBlock) < 1.0 + 1e-9);  // a row follows each second
  }
  CHECK(rankings.back().utime == utime_after(kStart, dive.trial.t.back()));
}

TEST_CASE("live ranking: nothing is adequate while MODEL has more residual than noise explains, by its time stamp") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const test::VirtualDive dive = test::make_dive(vehicle, {.duration = 80.0, .seed = 7});
  const auto verdict = [&](double limit, double ratio, double at) {
    LiveSettings settings = short_settings();
    settings.largest_ratio = limit;
    LiveDiagnoser diagnoser{settings, vehicle};
    ModelEstimate model{.utime = utime_after(kStart, at)};
    model.residual_ratio[2] = ratio;
    diagnoser.hear(model);
    return listen(diagnoser, dive.trial).back().verdict;
  };
  CHECK(verdict(0.0, 30.0, 50.0) == "adequate");
  CHECK(verdict(2.0, 30.0, 50.0) == "unexplained");
  CHECK(verdict(2.0, 1.0, 50.0) == "adequate");
  CHECK(verdict(2.0, 30.0, 79.5) == "adequate");  // it may still be on its way
}

TEST_CASE(
    "live ranking: a residual that was far too large and is small for now is no adequate model's, unless adopted") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const test::VirtualDive dive = test::make_dive(vehicle, {.duration = 80.0, .seed = 7});
  const auto verdict = [&](double before, const std::vector<std::string>& adopted) {
    LiveSettings settings = short_settings();
    settings.largest_ratio = 2.0;
    LiveDiagnoser diagnoser{settings, vehicle};
    for (double t = 1.0; t < 78.0; t += 1.0) {
      ModelEstimate model{.utime = utime_after(kStart, t)};
      if (t > 40.0) model.effects = adopted;
      model.residual_ratio[2] = t < 40.0 ? before : 0.5;
      diagnoser.hear(model);
    }
    return listen(diagnoser, dive.trial).back().verdict;
  };
  CHECK(verdict(20.0, {}) == "unexplained");
  CHECK(verdict(20.0, {"current"}) == "adequate");
  CHECK(verdict(1.5, {}) == "adequate");
}

TEST_CASE("live ranking: each effect once, the convincing ones first and by what they explain") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const test::VirtualDive dive =
      test::make_dive(vehicle, {.duration = 100.0, .seed = 7, .effects = {test::active("thruster_lag", {0.5})}});
  const LiveSettings settings = short_settings();
  LiveDiagnoser diagnoser{settings, vehicle};
  const EffectRanking last = listen(diagnoser, dive.trial).back();
  REQUIRE_FALSE(last.candidates.empty());
  CHECK(last.candidates.front().name == "thruster_lag");
  CHECK((last.verdict == "effect" || last.verdict == "ambiguous"));
  const auto convinces = [&](const EffectEvidence& one) {
    const model::Effect* effect = model::find_effect(one.name);
    const auto variant = std::ranges::find_if(diagnoser.forms(), [&](const LiveForm& form) {
                           return form.effect == effect && form.variant_name == one.variant;
                         })->variant;
    return one.log_odds >= settings.accept_log_odds && one.error_reduction >= settings.smallest_reduction &&
           !model::stopped_at_limit(*effect, variant, one.numbers, vehicle);
  };
  std::set<std::string> names;
  for (std::size_t i = 0; i < last.candidates.size(); ++i) {
    const EffectEvidence& one = last.candidates[i];
    CHECK(names.insert(one.name).second);
    if (i == 0) continue;
    const EffectEvidence& before = last.candidates[i - 1];
    CHECK((convinces(before) || !convinces(one)));
    if (convinces(one)) CHECK(before.error_reduction >= one.error_reduction);
  }
  // The numbers behind it belong to the same form.
  REQUIRE_FALSE(diagnoser.suspicions().empty());
  const LiveSuspicion& first = diagnoser.suspicions().front();
  CHECK(diagnoser.forms()[static_cast<std::size_t>(first.form)].effect->name() == "thruster_lag");
  CHECK(first.theta[0] == doctest::Approx(0.5).epsilon(0.3));
  diagnoser.reset();
  CHECK(diagnoser.suspicions().empty());
  CHECK(diagnoser.forms().empty());
  CHECK_FALSE(diagnoser.finish());
}

TEST_CASE("live ranking: a name that leaves a residual and is not adopted is taken back, the name stays in the list") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const test::VirtualDive dive =
      test::make_dive(vehicle, {.duration = 140.0, .seed = 7, .effects = {test::active("thruster_lag", {0.5})}});
  const auto heard = [&](double ratio, const std::vector<std::string>& effects) {
    LiveSettings settings = short_settings();
    settings.largest_ratio = 2.0;
    LiveDiagnoser diagnoser{settings, vehicle};
    for (double t = 20.0; t < 140.0; t += 5.0) {
      ModelEstimate model{.utime = utime_after(kStart, t), .effects = effects};
      model.residual_ratio[0] = ratio;
      diagnoser.hear(model);
    }
    return listen(diagnoser, dive.trial);
  };
  const auto refused = heard(30.0, {});
  const auto first = std::ranges::find(refused, "effect", &EffectRanking::verdict);
  REQUIRE(first != refused.end());  // the identifier has to hear it first
  CHECK(refused.back().verdict == "unexplained");
  CHECK(refused.back().candidates.front().name == "thruster_lag");
  CHECK(heard(30.0, {"thruster_lag"}).back().verdict == "effect");
  CHECK(heard(1.0, {}).back().verdict == "effect");
}

TEST_CASE("live ranking: an effect larger than any can be names nothing, and nothing else is named beside it") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  for (const unsigned seed : {7U, 8U, 9U}) {
    CAPTURE(seed);
    const test::VirtualDive dive = test::make_dive(
        vehicle, {.duration = 160.0, .seed = seed, .effects = {test::active("thrust_overshoot", {1.1, 1.0})}});
    LiveDiagnoser diagnoser{short_settings(), vehicle};
    const EffectRanking last = listen(diagnoser, dive.trial).back();
    REQUIRE_FALSE(last.candidates.empty());
    CHECK(last.candidates.front().log_odds > short_settings().accept_log_odds);  // by itself it would convince
    CHECK(last.verdict == "unexplained");
  }
}

TEST_CASE("live ranking: of two forms of an effect that are not told apart, the plain one") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  int named = 0;
  for (const unsigned seed : {7U, 8U, 9U, 10U}) {
    CAPTURE(seed);
    const test::VirtualDive dive =
        test::make_dive(vehicle, {.duration = 100.0, .seed = seed, .effects = {test::active("thruster_lag", {0.1})}});
    LiveDiagnoser diagnoser{short_settings(), vehicle};
    for (const EffectRanking& ranking : listen(diagnoser, dive.trial)) {
      if (ranking.verdict != "effect" || ranking.candidates.front().name != "thruster_lag") continue;
      CHECK(ranking.candidates.front().variant.empty());
      ++named;
    }
  }
  CHECK(named > 0);
}

TEST_CASE("live ranking: certain evidence of what explains too little for a name leaves no adequate model") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const test::VirtualDive dive =
      test::make_dive(vehicle, {.duration = 100.0, .seed = 8, .effects = {test::active("thrust_asymmetry", {-0.03})}});
  const auto judged = [&](double smallest_reduction) {
    LiveSettings settings = short_settings();
    settings.smallest_reduction = smallest_reduction;
    LiveDiagnoser diagnoser{settings, vehicle};
    return listen(diagnoser, dive.trial).back();
  };
  const EffectRanking named = judged(0.005);
  REQUIRE(named.candidates.front().name == "thrust_asymmetry");
  REQUIRE(named.candidates.front().log_odds > 2.0 * short_settings().accept_log_odds);
  CHECK(named.verdict == "effect");
  const double share = named.candidates.front().error_reduction;
  CHECK(judged(1.5 * share).verdict == "unexplained");
  CHECK(judged(3.0 * share).verdict == "adequate");
}

TEST_CASE("live ranking: what no list holds and looks the same leaves the name open, as afterwards") {
  constexpr int kExponentialForce = 2;
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  test::DiveSettings settings{.duration = 160.0, .seed = 7};
  double deepest = 0.0;
  for (const Eigen::Vector3d& p_WB : test::make_dive(vehicle, settings).trial.p_WB) {
    deepest = std::max(deepest, p_WB.z());
  }
  for (const double reach : {0.1, 0.3, 0.6}) {
    CAPTURE(reach);
    settings.effects = {test::active("bottom_effect", {12.0, 0.0, reach, deepest}, kExponentialForce)};
    LiveDiagnoser diagnoser{short_settings(), vehicle};
    const EffectRanking last = listen(diagnoser, test::make_dive(vehicle, settings).trial).back();
    REQUIRE_FALSE(last.candidates.empty());
    CHECK(last.candidates.front().name == "bottom_effect");
    CHECK(last.verdict == "ambiguous");
    CHECK(last.against == "a layer of denser water below");
    CHECK_FALSE(diagnoser.rivals());  // nothing to fly
  }
  settings.effects = {test::active("thruster_lag", {0.5})};
  LiveDiagnoser diagnoser{short_settings(), vehicle};
  CHECK(listen(diagnoser, test::make_dive(vehicle, settings).trial).back().against.find("layer") == std::string::npos);
}

}  // namespace fathom::diagnosis
