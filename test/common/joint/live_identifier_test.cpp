// The joint estimate among its messages, in the simulator's tank with all its noise: what comes late or in another
// order, what is no number, what falls silent or jumps, what is frozen, saved and taken up again.
#include "common/joint/live_identifier.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <variant>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/base/spatial.hpp"
#include "common/simulation/simulator.hpp"
#include "test/support/virtual_dive.hpp"

namespace fathom::joint {
namespace {

using fathom::test::vehicle_from_repository;
using simulation::Sample;

constexpr Utime kStart = 1'700'000'000'000'000;

struct Heard {
  Utime utime{};
  Sample sample;
};

struct Scene {
  model::Vehicle vehicle;
  model::Site site;
  identification::IdentifierSettings settings;
  JointSettings joint;
  estimation::NavigatorSettings navigator;
  estimation::NavigatorPlaces places;
  std::vector<Heard> samples;  ///< in the order of their arrival
};

/// Thrust in steps of some seconds on all four axes, back and forth so that no wall is met; up and down only from a
/// time on, the weight being held before.
Scene scene(double duration, std::uint64_t seed = 5, double heave_from = 0.0) {
  const std::string root = FATHOM_SOURCE_DIR;
  const Config pipeline = Config::load(root + "/config/pipelines/tank.yaml");
  Scene s{.vehicle = vehicle_from_repository("seabotix_lbv150"),
          .site = model::Site::load(root + "/config/sites/tank.yaml"),
          .settings = identification::IdentifierSettings::from(pipeline.section("identifier")),
          .joint = JointSettings::from(pipeline.section("identifier").section("joint")),
          .navigator = estimation::NavigatorSettings::from(pipeline.section("estimator")),
          .places = {},
          .samples = {}};
  s.places = estimation::NavigatorPlaces::of(s.vehicle.mounts, s.site);
  simulation::Simulator simulator{s.vehicle,
                                  s.site,
                                  Config::load(root + "/config/simulation/seabotix_lbv150.yaml").section("simulator"),
                                  {.seed = seed}};
  while (seconds_between(kStart, simulator.now()) < duration) {
    for (const Sample& sample : simulator.step())
      s.samples.push_back({std::visit([](const auto& one) { return one.utime; }, sample), sample});
    const double t = seconds_between(kStart, simulator.now());
    const auto sign = [&](double period) { return std::sin(2.0 * M_PI * t / period) > 0.0 ? 1.0 : -1.0; };
    WrenchCommand command{.utime = simulator.now(), .life = 0.3};
    const double heave = t < heave_from ? 0.0 : 5.0 * sign(2.3);
    command.tau << 8.0 * sign(4.0), 7.0 * sign(3.1), 1.2 + heave, 0.0, 0.0, 0.8 * sign(2.7);
    simulator.command(command);
  }
  return s;
}

std::unique_ptr<LiveIdentifier> make(const Scene& s) {
  return std::make_unique<LiveIdentifier>(s.settings, s.vehicle, s.joint, s.navigator, s.places);
}

using Change = std::function<bool(Sample&, double t)>;  ///< false: never comes

/// STATE by the estimator of the same samples, as the processes would.
std::vector<ModelEstimate> feed(const Scene& s, LiveIdentifier& identifier, const Change& change = {},
                                double from = 0.0, double to = 1e9) {
  std::vector<ModelEstimate> models;
  estimation::Navigator navigator{s.navigator, s.places};
  const auto take = [&](const LiveIdentifier::Output& output) {
    models.insert(models.end(), output.models.begin(), output.models.end());
  };
  for (const Heard& heard : s.samples) {
    const double t = seconds_between(kStart, heard.utime);
    if (t < from || t >= to) continue;
    Sample changed = heard.sample;
    if (change && !change(changed, t)) continue;
    std::visit(
        [&](const auto& one) {
          using T = std::decay_t<decltype(one)>;
          if constexpr (requires { navigator.step(one); }) {
            identifier.hear(one);
            for (const StateEstimate& state : navigator.step(one)) take(identifier.step(state));
          } else if constexpr (std::is_same_v<T, Thrusters>) {
            take(identifier.step(one));
          }
        },
        changed);
  }
  take(identifier.finish());
  return models;
}

bool same(const std::vector<ModelEstimate>& a, const std::vector<ModelEstimate>& b) {
  return std::ranges::equal(a, b, [](const ModelEstimate& x, const ModelEstimate& y) {
    return x.utime == y.utime && x.covariance == y.covariance &&
           std::ranges::equal(x.parameters, y.parameters,
                              [](const auto& p, const auto& q) { return p.value == q.value && p.std == q.std; });
  });
}

double worst(const Scene& s, const ModelEstimate& model) {
  double largest = 0.0;
  for (std::size_t k = 0; k < model.parameters.size(); ++k) {
    const NamedValue& p = model.parameters[k];
    if (p.name == "Y_v|v|" || p.name == "Z_w|w|" || p.name == "W-B") continue;
    largest = std::max(largest, std::abs(p.value / s.vehicle.priors[k].mean - 1.0));
  }
  return largest;
}

}  // namespace

TEST_CASE("live identifier: the joint estimate finds the truth, and MODEL is as complete as the recursive one's") {
  const Scene s = scene(40.0);
  const auto both = make(s);
  const auto models = feed(s, *both);
  LiveIdentifier alone{s.settings, s.vehicle};
  const auto recursive = feed(s, alone);
  REQUIRE(models.size() == recursive.size());
  CHECK_FALSE(same(models, recursive));
  CHECK(both->joint()->started());
  CHECK(worst(s, models.back()) < 0.05);
  const ModelEstimate &a = models.back(), &b = recursive.back();
  CHECK(a.utime == b.utime);
  CHECK(a.modes.size() == b.modes.size());
  CHECK(a.covariance.size() == 169);
  CHECK(a.residual_ratio == b.residual_ratio);
  CHECK(a.joint);
  CHECK_FALSE(models.front().joint);  // nobody has taught it yet
  CHECK(std::ranges::none_of(recursive, &ModelEstimate::joint));
  for (std::size_t k = 0; k < 13; ++k) {
    CHECK(a.parameters[k].name == b.parameters[k].name);
    CHECK(a.parameters[k].unit == b.parameters[k].unit);
    CHECK(std::sqrt(a.covariance[14 * k]) == doctest::Approx(a.parameters[k].std));
  }
  CHECK(a.modes.back().sum < b.modes.back().sum);
}

TEST_CASE("live identifier: over seeds, the joint estimate's intervals hold as often as they say") {
  constexpr int kSeeds = 10;
  int inside = 0;
  for (int seed = 11; seed < 11 + kSeeds; ++seed) {
    const Scene s = scene(40.0, static_cast<std::uint64_t>(seed));
    const auto both = make(s);
    const ModelEstimate model = feed(s, *both).back();
    for (std::size_t k = 0; k < 13; ++k) {
      const double off = model.parameters[k].value - s.vehicle.priors[k].mean;
      inside += std::abs(off) < 1.96 * model.parameters[k].std ? 1 : 0;
    }
  }
  MESSAGE("intervals that hold: ", 100.0 * inside / (13.0 * kSeeds), " %");
  // 95 % of 130, of which a third are independent: +- 3.3 %, and three times that.
  CHECK(inside > 0.85 * 13 * kSeeds);
}

TEST_CASE("live identifier: the noise of tilts does not drive numbers apart while the weight is not known") {
  const Scene s = scene(90.0, 5, 70.0);
  const auto learnt = [&](double tilt) {  // rad, of every sample
    std::mt19937 random{3};
    std::normal_distribution<double> normal;
    const auto identifier = make(s);
    return feed(s, *identifier,
                [&](Sample& sample, double) {
                  if (auto* ahrs = std::get_if<Ahrs>(&sample)) {
                    const double about_x = tilt * normal(random), about_y = tilt * normal(random);
                    ahrs->q_WB = ahrs->q_WB * quaternion_from_rotation_vector({about_x, about_y, 0.0});
                  }
                  return true;
                })
        .back();
  };
  // 0.2 deg is as much force as the accelerometer's noise and the model's together, on which the filter counts. What it
  // moves is to be well within the deviations stated; it was .6 to 1.1 of them as long as columns had the same noise.
  const ModelEstimate quiet = learnt(0.0), noisy = learnt(3.5e-3);
  for (std::size_t k = 0; k < noisy.parameters.size(); ++k) {
    const NamedValue& p = noisy.parameters[k];
    if (p.name[0] != 'X' && p.name[0] != 'Y') continue;
    CAPTURE(p.name);
    CAPTURE(p.value);
    CAPTURE(quiet.parameters[k].value);
    CHECK(std::abs(p.value - quiet.parameters[k].value) < 0.5 * p.std);
  }
}

TEST_CASE("live identifier: neither the order of arrival between channels nor a run before changes a bit") {
  Scene s = scene(15.0);
  const auto first = make(s);
  const auto expected = feed(s, *first);
  CHECK(expected.size() > 40);
  first->reset();
  CHECK(same(feed(s, *first), expected));
  // Every channel keeps its own order; those that the lag waits for come at their own time or up to 40 ms after it.
  std::ranges::stable_sort(s.samples, {}, [](const Heard& heard) {
    const bool slow = !std::holds_alternative<Ahrs>(heard.sample) && !std::holds_alternative<Thrusters>(heard.sample);
    return heard.utime + (slow ? 40'000 : 0);
  });
  const auto other = make(s);
  CHECK(same(feed(s, *other), expected));
}

TEST_CASE("live identifier: samples that are no numbers, a silence and a jump in time are survived and counted") {
  const Scene s = scene(40.0);
  const auto clean = make(s);
  const double reached = worst(s, feed(s, *clean).back());
  CHECK(reached < 0.05);
  const double nan = std::nan("");
  struct Case {
    std::string what;
    Change change;
    std::string counted;
  };
  const std::vector<Case> cases{
      {"every tenth picture's flow is no number",
       [&, n = 0](Sample& sample, double) mutable {
         auto* flow = std::get_if<OpticalFlow>(&sample);
         if (flow != nullptr && n++ % 10 == 0) flow->flow_C.x() = nan;
         return true;
       },
       "joint estimate: not finite"},
      {"no attitude for half a second",
       [](Sample& sample, double t) { return !(std::holds_alternative<Ahrs>(sample) && t > 20.0 && t < 20.5); },
       "joint estimate: begun anew"},
      {"no thrusters for a second",
       [](Sample& sample, double t) { return !(std::holds_alternative<Thrusters>(sample) && t > 20.0 && t < 21.0); },
       "joint estimate: begun anew, no input"},
      {"a picture that comes two seconds late",
       [](Sample& sample, double t) {
         if (auto* laser = std::get_if<LaserRange>(&sample); laser != nullptr && t > 20.0 && t < 20.2)
           laser->utime -= 2'000'000;
         return true;
       },
       "joint estimate: late"},
      {"flow that stands still",
       [](Sample& sample, double t) {
         if (auto* flow = std::get_if<OpticalFlow>(&sample); flow != nullptr && t > 20.0 && t < 21.0)
           flow->flow_C = {0.1, 0.1, 0.0};
         return true;
       },
       "joint estimate: frozen"}};
  for (const Case& c : cases) {
    CAPTURE(c.what);
    const auto identifier = make(s);
    const auto models = feed(s, *identifier, c.change);
    REQUIRE(models.size() > 60);
    for (const ModelEstimate& model : models) {
      for (const NamedValue& p : model.parameters) REQUIRE((std::isfinite(p.value) && std::isfinite(p.std)));
    }
    CHECK(worst(s, models.back()) < 0.06);
    CHECK(std::ranges::any_of(identifier->rejected(),
                              [&](const auto& each) { return each.first.starts_with(c.counted) && each.second > 0; }));
  }
}

TEST_CASE(
    "live identifier: without attitudes of its own MODEL is the recursive one's, and waits no longer than a while") {
  const Scene s = scene(20.0);
  const auto deaf = make(s);
  const auto recursive = std::make_unique<LiveIdentifier>(s.settings, s.vehicle);
  std::vector<ModelEstimate> said, expected;
  estimation::Navigator navigator{s.navigator, s.places};
  double longest = 0.0;
  for (const Heard& heard : s.samples) {
    std::visit(
        [&](const auto& one) {
          using T = std::decay_t<decltype(one)>;
          if constexpr (requires { navigator.step(one); }) {
            if constexpr (!std::is_same_v<T, Ahrs>) deaf->hear(one);
            for (const StateEstimate& state : navigator.step(one)) {
              for (const ModelEstimate& model : deaf->step(state).models) {
                longest = std::max(longest, seconds_between(model.utime, state.utime));
                said.push_back(model);
              }
              const auto& models = recursive->step(state).models;
              expected.insert(expected.end(), models.begin(), models.end());
            }
          } else if constexpr (std::is_same_v<T, Thrusters>) {
            (void)deaf->step(one);
            const auto& models = recursive->step(one).models;
            expected.insert(expected.end(), models.begin(), models.end());
          }
        },
        heard.sample);
  }
  REQUIRE(said.size() > 40);
  expected.resize(said.size());  // the last ones still wait
  CHECK(same(said, expected));
  CHECK(longest < 2.0);
  CHECK(deaf->rejected().contains("joint estimate: not reached, MODEL is the recursive one's"));
}

TEST_CASE("live identifier: what is frozen stays put, and goes on when it is resumed") {
  const Scene s = scene(30.0);
  const auto identifier = make(s);
  (void)feed(s, *identifier, {}, 0.0, 18.0);
  Excitation wish{.utime = utime_after(kStart, 18.0)};
  wish.frozen = {"m_X", "X_u", "X_u|u|"};
  identifier->hear(wish);
  const auto models = feed(s, *identifier, {}, 18.0, 30.0);
  REQUIRE(models.size() > 20);
  const auto& middle = models[models.size() / 2].parameters;
  const auto& last = models.back().parameters;
  for (const std::size_t k : {0U, 4U, 8U}) CHECK(last[k].value == doctest::Approx(middle[k].value).epsilon(1e-9));
  for (const std::size_t k : {1U, 5U}) CHECK(last[k].value != middle[k].value);
  CHECK(models.back().frozen == wish.frozen);
}

TEST_CASE("live identifier: saved and offered to a new one it goes on where it was; what is not its own is left") {
  const Scene s = scene(40.0);
  const auto identifier = make(s);
  (void)feed(s, *identifier, {}, 0.0, 25.0);
  const std::string text = identifier->save_text();
  const ModelEstimate before = identifier->model();

  const auto resumed = make(s);
  resumed->offer(text, 120.0);
  const auto models = feed(s, *resumed, {}, 26.0, 40.0);
  CHECK(resumed->resumed());
  CHECK(resumed->joint()->started());
  CHECK(worst(s, models.back()) < 0.05);
  // From the first model on it knows what was known.
  for (std::size_t k = 0; k < 4; ++k)
    CHECK(std::abs(models.front().parameters[k].value - before.parameters[k].value) < 4.0 * before.parameters[k].std);
  CHECK(models.front().parameters[0].std < 1.5 * before.parameters[0].std);
  CHECK(models.back().parameters[0].std < 0.9 * before.parameters[0].std);  // and learns on

  const auto cut = make(s);
  cut->offer(text.substr(0, text.size() - 40), 120.0);
  (void)feed(s, *cut, {}, 26.0, 27.0);
  CHECK_FALSE(cut->joint()->started());
  LiveIdentifier recursive{s.settings, s.vehicle};
  recursive.offer(text, 120.0);  // the joint estimate's part is none of its business
  (void)feed(s, recursive, {}, 26.0, 27.0);
  CHECK(recursive.resumed());
}

TEST_CASE("live identifier: signs are kept in what is reported") {
  const Scene s = scene(12.0);
  const auto identifier = make(s);
  for (const ModelEstimate& model : feed(s, *identifier)) {
    for (std::size_t k = 0; k < 13; ++k) {
      const int sign = model::sign_constraint(*model::parameter_from_name(model.parameters[k].name));
      CHECK(sign * model.parameters[k].value >= 0.0);
    }
  }
}

}  // namespace fathom::joint
