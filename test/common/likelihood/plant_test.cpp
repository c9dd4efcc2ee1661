// What a scan asks of one more effect is what the effect does.
#include "common/likelihood/plant.hpp"

#include <doctest/doctest.h>

#include "test/common/likelihood/noisy_dive.hpp"

using namespace fathom;
using namespace fathom::likelihood;

namespace {

Vector6d acceleration_at(const Hypothesis& hypothesis, const RunData& run, std::size_t block, const Vector6d& nu) {
  const std::vector<Number> none;
  Plant plant{hypothesis, none, run, 0, false};
  plant.begin(run.start());
  plant.at_middle(block);
  return plant.acceleration(nu);
}

}  // namespace

TEST_CASE("plant: what an effect on the hull adds is the difference of the accelerations with and without it") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const auto dive = test::fly(vehicle, {.duration = 20.0});
  const RunData run{dive.trial, vehicle, {}};
  Hypothesis hypothesis{.model = dive.truth};
  hypothesis.runs.resize(1);
  const model::Scene scene = model::scene_of(vehicle, {&dive.trial, 1});
  const std::size_t block = run.blocks().size() / 2;
  const Vector6d nu{0.4, -0.2, 0.1, 0.05, -0.1, 0.3};
  int asked = 0;
  for (const model::Effect* effect : model::all_effects()) {
    const std::vector<std::string> forms = effect->variants(scene);
    for (std::size_t v = 0; v < forms.size(); ++v) {
      if (forms[v] == "-") continue;
      model::ActiveEffect active{.effect = effect,
                                 .variant = static_cast<int>(v),
                                 .theta = effect->starts(scene, static_cast<int>(v)).front()};
      if (stage_of(active) != Stage::kHull) continue;
      CAPTURE(effect->name());
      CAPTURE(forms[v]);
      const std::vector<Number> none;
      Plant plant{hypothesis, none, run, 0, false};
      plant.begin(run.start());
      plant.at_middle(block);
      const Vector6d plain = plant.acceleration(nu);
      const Vector6d added = plant.added_by(active, plain, plant.inverse_inertia(nu, plain));
      Hypothesis with = hypothesis;
      with.model.add(active);
      const Vector6d whole = acceleration_at(with, run, block, nu) - plain;
      CHECK((added - whole).norm() <= 1e-9 + 1e-6 * whole.norm());
      // And it leaves the plant as it was.
      CHECK(plant.acceleration(nu) == plain);
      ++asked;
    }
  }
  CHECK(asked >= 10);
}
