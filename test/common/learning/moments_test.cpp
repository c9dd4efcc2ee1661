// The moment at which something begins: sought by all columns of its group, and told of later runs only where it holds
// to the end.
#include "common/learning/moments.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "common/learning/products.hpp"
#include "test/common/learning/learned_case.hpp"

using namespace fathom;
using namespace fathom::learning;

namespace {

constexpr double kCaught = 53.0;  // s

/// From a moment on the hull drags more sideways: 0.6 /s and 2 /m of acceleration.
Vector6d caught(double t, const Vector6d& nu) {
  Vector6d nu_dot = Vector6d::Zero();
  if (t > kCaught) nu_dot[1] = -(0.6 + 2.0 * std::abs(nu[1])) * nu[1];
  return nu_dot;
}

/// Of the first factor that is a moment.
double moment_in(const model::FreeForce& force, const model::FeatureGroup& group) {
  const model::Feature& feature = force.features[static_cast<std::size_t>(group.first)];
  for (int i = 0; i < feature.count; ++i) {
    const model::Factor& factor = feature.factors[static_cast<std::size_t>(i)];
    if (factor.quantity == model::Quantity::kAfter) return factor.a;
  }
  return -1.0;
}

}  // namespace

TEST_CASE("moments: a group's moment is where all of its columns together say, wherever it begins from") {
  const test::LearnedCase bag{{.duration = 100.0, .seed = 4, .force = 0.02, .outside = caught}, false};
  const inference::Seen seen = inference::see(bag.problem, bag.conclusion.found.best.fit, 1);
  const model::Scene scene = model::scene_of(test::bluerov(), {&bag.trial, 1});
  model::FreeForce library = products_of(bag.problem, seen, scene, Clock::kLasting);
  std::vector<std::size_t> groups;
  for (std::size_t g = 0; g < library.groups.size(); ++g) {
    const model::FeatureGroup& group = library.groups[g];
    if (group.axis != 1 || group.kind != "drag, from a moment on") continue;
    groups.push_back(g);
    for (int j = group.first; j < group.first + group.count; ++j) {
      for (model::Factor& factor : library.features[static_cast<std::size_t>(j)].factors)
        if (factor.quantity == model::Quantity::kAfter) factor.a = 20.0;
    }
  }
  REQUIRE(groups.size() == 1);
  const auto found = profile_moments(bag.problem, seen, groups, library, 1);
  REQUIRE(found.size() == 1);
  CHECK(found.front().first == groups.front());
  CHECK(found.front().second > 20.0);
  CHECK(std::abs(moment_in(library, library.groups[groups.front()]) - kCaught) < 1.0);
}

TEST_CASE("moments: drag that sets in is learned as such, and stands in runs that come later") {
  const test::LearnedCase bag{{.duration = 120.0, .seed = 4, .force = 0.02, .outside = caught}};
  const Learned learned = bag.learned(false);
  test::show("caught", learned.given);
  REQUIRE(learned.given.adopted);
  CHECK(learned.given.goes_on);
  REQUIRE(learned.later != nullptr);
  bool sets_in = false;
  for (const model::FeatureGroup& group : learned.fit.hypothesis.force.groups)
    sets_in = sets_in || std::abs(moment_in(learned.fit.hypothesis.force, group) - kCaught) < 1.0;
  CHECK(sets_in);
}

TEST_CASE("moments: what came and went stands in no later run") {
  // For half a minute in the middle of the run.
  const auto passing = [](double t, const Vector6d& nu) {
    return Vector6d{t > 30.0 && t < 60.0 ? caught(kCaught + 1.0, nu) : Vector6d{Vector6d::Zero()}};
  };
  const test::LearnedCase gone{{.duration = 100.0, .seed = 4, .force = 0.02, .outside = passing}};
  const Learned learned = gone.learned(false);
  test::show("passing", learned.given);
  REQUIRE(learned.given.adopted);
  if (learned.later == nullptr) return;
  // If anything is told of later runs, it is not that drag: it has gone.
  model::Motion motion{.t = 200.0, .nu = 0.3 * Vector6d::Unit(1), .force = model::ActuatorForces::Zero(6)};
  model::Load load;
  load.clear();
  learned.later->load(motion, {}, 0, load);
  const double inertia = learned.fit.hypothesis.model.theta[1];
  CHECK(std::abs(load.wrench[1]) < 0.3 * inertia * std::abs(caught(kCaught + 1.0, motion.nu)[1]));
}
