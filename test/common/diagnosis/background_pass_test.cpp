// A pass on a thread of its own ends with the bits of one that was heard in place, and can be left at any time.
#include "common/diagnosis/background_pass.hpp"

#include <doctest/doctest.h>

#include <optional>

#include "test/support/virtual_dive.hpp"

namespace fathom::diagnosis {
namespace {

/// A dive as a live diagnoser keeps it, and all that a pass over it rests on.
struct Seen {
  model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  std::vector<model::BaseParameter> parameters;
  identification::ParameterVector prior_mean;
  model::Model nominal = model::nominal_model(vehicle, false);
  SeenTrial trial;

  Seen() {
    prior_mean.resize(static_cast<Eigen::Index>(vehicle.priors.size()));
    for (std::size_t i = 0; i < vehicle.priors.size(); ++i) {
      parameters.push_back(*model::parameter_from_name(vehicle.parameters[i]));
      prior_mean[static_cast<Eigen::Index>(i)] = vehicle.priors[i].mean;
    }
    const test::VirtualDive dive =
        test::make_dive(vehicle, {.duration = 60.0, .seed = 4, .effects = {test::active("thruster_lag", {0.4})}});
    trial.begin(nominal.allocation);
    for (std::size_t k = 0; k < dive.trial.size(); ++k) {
      LiveSample sample{.p_WB = dive.trial.p_WB[k], .q_WB = dive.trial.q_WB[k], .force = dive.trial.input[k]};
      sample.motion.utime = utime_after(1'600'000'000'000'000, dive.trial.t[k]);
      sample.motion.nu = dive.trial.nu[k];
      sample.motion.down_B = down_of(sample.q_WB);
      sample.motion.tau = nominal.allocation * sample.force;
      sample.motion.valid = sample.has_position = true;
      if (k == 0) sample.commands_from = sample.motion.utime;
      sample.commands.emplace_back(sample.force);
      trial.keep(sample);
    }
  }
  [[nodiscard]] std::unique_ptr<LiveScreening> pass() const {
    identification::IntegralSettings rows;
    rows.window = 1.0;
    rows.stride = 0.5;
    rows.dof = vehicle.dof;
    rows.parameters = parameters;
    return std::make_unique<LiveScreening>(LiveBasis{.vehicle = vehicle,
                                                     .parameters = parameters,
                                                     .prior_mean = prior_mean,
                                                     .nominal = nominal,
                                                     .block = 5.0,
                                                     .max_gap = 0.3,
                                                     .most_blocks = 50,
                                                     .integral = rows},
                                           trial, std::nullopt);
  }
  template <class Use>
  void each(const Use& use) const {
    LiveSample sample;
    for (std::size_t i = 0; i < trial.size(); ++i) {
      trial.get(i, sample);
      use(sample);
    }
  }
};

}  // namespace

TEST_CASE("background pass: it ends with the bits of one that was heard in place") {
  const Seen seen;
  const auto in_place = seen.pass();
  seen.each([&](const LiveSample& sample) { (void)in_place->use(sample, true); });
  BackgroundPass behind{seen.pass()};
  seen.each([&](const LiveSample& sample) { behind.hear(sample); });
  const auto beside = behind.finish();
  REQUIRE(beside != nullptr);
  REQUIRE(beside->evidence().blocks() > 8);
  CHECK(beside->evidence().blocks() == in_place->evidence().blocks());
  const auto expected = in_place->evidence().judge(), judged = beside->evidence().judge();
  REQUIRE(judged.size() == expected.size());
  for (std::size_t i = 0; i < judged.size(); ++i) {
    CHECK(judged[i].form == expected[i].form);
    CHECK(judged[i].log_odds == expected[i].log_odds);
    CHECK(judged[i].theta == expected[i].theta);
  }
}

TEST_CASE("background pass: it may be left with much to hear, or end with nothing heard") {
  const Seen seen;
  REQUIRE(seen.trial.size() > 450);
  for (const std::size_t told : {std::size_t{0}, std::size_t{1}, std::size_t{450}, seen.trial.size()}) {
    BackgroundPass left{seen.pass()};
    LiveSample sample;
    for (std::size_t i = 0; i < told; ++i) {
      seen.trial.get(i, sample);
      left.hear(sample);
    }
  }
  BackgroundPass idle{seen.pass()};
  CHECK(idle.finish()->evidence().blocks() == 0);
}

}  // namespace fathom::diagnosis
