// An imitation is told from the real thing: beside a free curve over the right quantity it has nothing left to do.
#include "common/diagnosis/lack_of_form.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "common/diagnosis/free_curve.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::diagnosis;
using identification::FitResult;
using identification::TrajectoryFit;

namespace {

/// A layer of denser water: a force up below some depth. No effect of the registry has this form.
class DenserBelow final : public model::Form {
 public:
  explicit DenserBelow(double depth) : depth_{depth} {}
  void load(const model::Motion& motion, model::EffectTheta theta, model::Load& load) const override {
    const double below = std::tanh((motion.p_WB.z() - depth_) / kThickness);
    load.wrench.head<3>() -= theta[0] * below * motion.R_WB.transpose().col(2);
  }

 private:
  static constexpr double kThickness = 0.1;  // m
  double depth_;
};
struct Layer : model::Effect {
  explicit Layer(double depth)
      : Effect{{.name = "layer", .feels_place = true},
               std::array{model::EffectParameter{"force", "N", 5.0}},
               model::forms(DenserBelow{depth})} {}
};

/// A dead band with sharp edges, a wider one ahead than astern: nearly the registry's, and on every thruster.
class WiderAhead final : public model::Form {
 public:
  void feel(model::Motion& motion, model::EffectTheta theta, std::span<const double>) const override {
    for (double& force : motion.force) {
      if (force < 1.3 * theta[0] && force > -0.7 * theta[0]) force = 0.0;
    }
  }
};
struct CrookedBand : model::Effect {
  CrookedBand()
      : Effect{{.name = "crooked_band", .feels_motion = false},
               std::array{model::EffectParameter{"half_width", "N", 1.0}},
               model::forms(WiderAhead{})} {}
};

struct Case {
  model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  test::VirtualDive dive;
  std::vector<Trial> trials;
  model::Scene scene;

  explicit Case(const std::vector<model::ActiveEffect>& effects)
      : dive{test::make_dive(vehicle, {.duration = 150.0, .seed = 11, .spread = 0.0, .effects = effects})},
        trials{dive.trial},
        scene{model::scene_of(vehicle, trials)} {}
};

/// Accepts `suspect` as if a search had, and has its form tested.
SearchResult tested(const Case& c, const std::string& suspect, const std::vector<double>& start, int variant = 0) {
  const TrajectoryFit problem{c.vehicle, c.trials, {.window = 5.0, .threads = 1, .iterations = 10}};
  SearchResult result;
  result.before = problem.fit(model::nominal_model(c.vehicle, false));
  model::Model model = result.before.model;
  model.add(test::active(suspect, start, variant));
  result.after = problem.fit(model, &result.before);
  Judged judged;
  judged.effect = model::find_effect(suspect);
  judged.variant = variant;
  result.accepted.push_back(judged);
  const bool moved = test_forms(result, problem, result.after, c.scene, [](const std::string&, double) {});
  CHECK(moved == result.accepted.empty());
  return result;
}

}  // namespace

TEST_CASE("lack of form: a spring that imitates a layer is refused, and depth is named") {
  const Case scene{std::vector<model::ActiveEffect>{}};
  const double middle = 0.5 * (scene.scene.p_low.z() + scene.scene.p_high.z());
  const Layer layer{middle};
  const Case c{{{&layer, 0, "", {3.0}}}};
  const SearchResult result = tested(c, "compressibility", {1.0});
  CHECK(result.accepted.empty());
  REQUIRE(result.free_form);
  CHECK(result.free_form->axis == "Z");
  CHECK(result.free_form->with == "depth");
  CHECK(result.refused.back().reason.find("depth") != std::string::npos);
}

TEST_CASE("lack of form: a true effect leaves a free curve nothing") {
  const Case c{{test::active("compressibility", {8.0})}};
  const SearchResult result = tested(c, "compressibility", {1.0});
  CHECK(result.accepted.size() == 1);
  CHECK_FALSE(result.free_form);
}

TEST_CASE("lack of form: what is unlisted elsewhere costs a true effect nothing") {
  const Layer layer{0.5 * (Case{{}}.scene.p_low.z() + Case{{}}.scene.p_high.z())};
  const Case c{{test::active("current", {0.12, -0.08}), {&layer, 0, "", {3.0}}}};
  const SearchResult result = tested(c, "current", {0.05, -0.05});
  CHECK(result.accepted.size() == 1);
  REQUIRE(result.free_form);
  CHECK(result.free_form->with == "depth");
}

TEST_CASE("lack of form: a curve that sees a corner of a large effect does not take its name from it") {
  const CrookedBand band;
  const Case c{{{&band, 0, "", {3.0}}}};
  const SearchResult result = tested(c, "thruster_deadband", {3.05}, 1);
  CHECK(result.accepted.size() == 1);
  CHECK(result.free_form.has_value());  // it is said all the same
}

TEST_CASE("free curve: linear between its knots, held beyond its ends, closed over heading") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const std::vector<double> knots{0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0};
  model::Motion motion;
  motion.vehicle = &vehicle;
  const auto force = [&](const FreeCurve& curve) {
    model::Load load;
    curve.load(motion, knots, 0, load);
    return load.wrench[curve.axis()];
  };
  const FreeCurve depth{2, Quantity::kDepth, 1.0, 8.0, 1.0, false};
  for (const auto& [z, wanted] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {3.25, 2.25}, {8.0, 7.0}, {9.0, 7.0}}) {
    motion.p_WB.z() = z;
    CHECK(force(depth) == doctest::Approx(wanted));
  }
  const FreeCurve heading{5, Quantity::kHeading, -std::numbers::pi, std::numbers::pi, 1.0, false};
  motion.R_WB = rotation_from_euler({0.0, 0.0, 0.999999 * std::numbers::pi});  // just before the curve closes
  CHECK(force(heading) == doctest::Approx(knots[0]).epsilon(1e-4));
}
