// The registry and the places that effects take in a model.
#include "common/model/effect.hpp"

#include <doctest/doctest.h>

#include <array>

#include "common/model/dynamics.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;

namespace {

constexpr std::array kTwo{model::EffectParameter{"a", "N", 4.0}, model::EffectParameter{"b", "m", 0.5}};
const model::Effect plain{
    {.name = "plain", .sentence = "Does nothing.", .revealed_by = "nothing"}, kTwo, model::forms(model::Form{})};

}  // namespace

TEST_CASE("effect: what an author leaves out does nothing, and a search begins at a tenth of sigma") {
  CHECK(plain.variants({}) == std::vector<std::string>{""});
  CHECK_FALSE(plain.variants_matter());
  CHECK(plain.starts({}, 0) == std::vector<std::vector<double>>{{0.4, 0.05}});
  CHECK(plain.possible(std::vector{1.0, 1.0}, 0, {}));
  CHECK_FALSE(plain.feels_place());
  CHECK(plain.state_size({}, 8) == 0);
  model::Motion motion;
  model::Load load;
  plain.feel(motion, std::vector{1.0, 1.0}, 0, {});
  plain.load(motion, std::vector{1.0, 1.0}, 0, load);
  CHECK(motion.v_WF_B.isZero(0.0));
  CHECK(load.wrench.isZero(0.0));
  CHECK_FALSE(load.has_inertia());
}

TEST_CASE("effect: a model keeps the registry's order, whatever the order of adding") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  model::Model model = model::nominal_model(vehicle, false);
  const auto all = model::all_effects();
  for (auto effect = all.rbegin(); effect != all.rend(); ++effect) {
    model.add({*effect, 0, "", std::vector<double>((*effect)->parameters().size(), 0.0)});
  }
  REQUIRE(model.effects.size() == all.size());
  for (std::size_t i = 0; i < all.size(); ++i) CHECK(model.effects[i].effect == all[i]);
  // Forms of one effect stay in the order in which they came, and one unknown to the registry acts last.
  model.add({&plain, 0, "", {0.0, 0.0}});
  model.add({all[3], 2, "again", std::vector<double>(all[3]->parameters().size(), 0.0)});
  CHECK(model.effects[3].variant == 0);
  CHECK(model.effects[4].variant_name == "again");
  CHECK(model.effects.back().effect == &plain);
}

TEST_CASE("effect: memory is counted over all effects, and is at rest once settled") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  model::Model model = model::nominal_model(vehicle, false);
  CHECK(model.memory_size() == 0);
  model.add(test::active("thruster_lag", {0.3}));
  CHECK(model.memory_size() == 8);  // thrust, shaft speed and what follows thrust, of four
  model.add(test::active("thrust_overshoot", {0.4, 0.8}));
  CHECK(model.memory_size() > 4);
  std::vector<double> memory(static_cast<std::size_t>(model.memory_size()), 7.0);
  model::Motion motion;
  motion.vehicle = &vehicle;
  motion.force = Eigen::Vector4d(1.0, -2.0, 3.0, 0.5);
  model::settle(model, motion, memory);
  const std::vector<double> settled = memory;
  model::Motion first = motion;
  model::feel(model, first, memory, 0.5);
  constexpr double kRounding = 1e-12;
  for (std::size_t i = 0; i < memory.size(); ++i) CHECK(memory[i] == doctest::Approx(settled[i]).epsilon(kRounding));
}
