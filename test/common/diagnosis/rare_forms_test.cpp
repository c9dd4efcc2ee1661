// Forms that few vehicles have are found as surely as the usual ones: a thruster that gives nothing at all, a hull
// without any symmetry, one that rights itself strongly under a file that knows nothing of it.
#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "common/diagnosis/search.hpp"
#include "common/model/rollout.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::diagnosis;

namespace {

struct Said {
  std::string name, form;
  std::vector<double> theta;
  std::size_t accepted{};
};

Said search_dive(const model::Vehicle& vehicle, const model::ActiveEffect& hidden, unsigned seed, bool wrench = false) {
  const test::VirtualDive dive =
      test::make_dive(vehicle, {.duration = 240.0, .seed = seed, .wrench = wrench, .effects = {hidden}});
  const SearchResult found = search(vehicle, {&dive.trial, 1}, {}, [](const std::string&, double) {});
  if (found.accepted.empty()) return {};
  const Judged& first = found.accepted.front();
  Said said{std::string(first.effect->name()), first.variant_name, {}, found.accepted.size()};
  for (const model::ActiveEffect& active : found.after.model.effects) {
    if (active.effect == first.effect && active.variant == first.variant) said.theta = active.theta;
  }
  return said;
}

}  // namespace

TEST_CASE("search: the only thruster of its axis gives nothing, and is named though the axis' numbers mean nothing") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  int vertical = -1;
  for (std::size_t i = 0; i < vehicle.thrusters.size(); ++i) {
    if (std::abs(vehicle.thrusters[i].axis_B.z()) > 0.9) vertical = static_cast<int>(i);
  }
  REQUIRE(vertical >= 0);
  for (unsigned seed = 21; seed <= 22; ++seed) {
    CAPTURE(seed);
    const Said said = search_dive(vehicle, test::active("thruster_gain", {-1.0}, vertical), seed);
    CHECK(said.name == "thruster_gain");
    CHECK(said.form == vehicle.thrusters[static_cast<std::size_t>(vertical)].name);
    CHECK(said.accepted == 1);
    REQUIRE(said.theta.size() == 1);
    CHECK(said.theta[0] == doctest::Approx(-1.0).epsilon(0.02));
  }
}

TEST_CASE("search: couplings of a hull without symmetry are named, whichever is drawn") {
  std::mt19937 random{20261124};
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const Trial plain = test::make_dive(vehicle, {.duration = 60.0, .seed = 5}).trial;
  const model::Scene scene = model::scene_of(vehicle, {&plain, 1});
  const model::Effect* coupling = model::find_effect("cross_coupling");
  const std::vector<std::string> forms = coupling->variants(scene);
  std::vector<int> others;  // drag of pairs that no plane of symmetry allows
  for (std::size_t i = 39; i < forms.size(); ++i) {
    const bool moves = forms[i].find_first_of("uvwr") != std::string::npos;  // this dive does not roll or pitch
    if (moves && !forms[i].ends_with("_dot")) others.push_back(static_cast<int>(i));
  }
  REQUIRE(others.size() >= 8);
  for (unsigned seed = 31; seed <= 33; ++seed) {
    const int form = others[std::uniform_int_distribution<std::size_t>{0, others.size() - 1}(random)];
    const double tiny = coupling->starts(scene, form)[0][0];  // 2 % of the wrench of its axis
    const double size = tiny * std::uniform_real_distribution<double>{5.0, 10.0}(random);
    const std::string& name = forms[static_cast<std::size_t>(form)];
    CAPTURE(name);
    const Said said = search_dive(vehicle, test::active("cross_coupling", {size}, form), seed);
    CHECK(said.name == "cross_coupling");
    CHECK(said.form == name);
    CHECK(said.accepted == 1);
    REQUIRE(said.theta.size() == 1);
    CHECK(said.theta[0] == doctest::Approx(size).epsilon(0.1));
  }
}

TEST_CASE("search: a strong pendulum that the vehicle's file leaves out is named, though it bends inertia and drag") {
  const model::Vehicle vehicle = test::without_parameters(test::vehicle_from_repository("beluga"), "G_");
  std::mt19937 random{1125};
  std::uniform_real_distribution<double> any{-1.0, 1.0};
  for (unsigned seed = 42; seed <= 43; ++seed) {
    const std::vector<double> G{6.0 * any(random), 6.0 * any(random), 30.0 + 10.0 * any(random)};
    CAPTURE(seed);
    const Said said = search_dive(vehicle, test::active("restoring_moment", G, 7), seed, true);
    CHECK(said.name == "restoring_moment");
    CHECK(said.accepted == 1);
    REQUIRE(said.theta.size() == 3);
    for (std::size_t i = 0; i < 3; ++i) CHECK(said.theta[i] == doctest::Approx(G[i]).epsilon(0.02).scale(5.0));
  }
}
