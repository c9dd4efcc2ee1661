// The search has no confident name for physics that the registry does not hold.
#include "test/common/diagnosis/search_dives.hpp"

using namespace fathom;
using namespace fathom::diagnosis;

namespace {

constexpr double kConfidentShare = 0.02;  // of the error (RMS): what a wrong name may explain before it misleads

/// Physics that the registry does not hold.
template <class Law>
struct Outsider : model::Effect {
  explicit Outsider(std::string_view name)
      : Effect{{.name = name, .sentence = "Not in the registry.", .revealed_by = "nothing"},
               std::array{model::EffectParameter{"size", "", 1.0}},
               model::forms(Law{})} {}
};

/// Lift: sway of a hull that flies at an angle, a product of two speeds.
class Lift final : public model::Form {
 public:
  void load(const model::Motion& motion, model::EffectTheta theta, model::Load& load) const override {
    load.wrench[1] += theta[0] * motion.nu[0] * motion.nu[1];
    load.wrench[2] += theta[0] * motion.nu[0] * motion.nu[2];
  }
};

/// A spinning wheel on board: turning about one axis pushes about another.
class Gyroscope final : public model::Form {
 public:
  void load(const model::Motion& motion, model::EffectTheta theta, model::Load& load) const override {
    load.wrench.tail<3>() -= motion.nu.tail<3>().cross(Eigen::Vector3d(theta[0], 0.0, 0.0));
    load.wrench[5] += theta[0] * motion.nu[0] * motion.nu[2];
  }
};

/// A pump: a force that swells and fades with time, ever faster.
class Pump final : public model::Form {
 public:
  void load(const model::Motion& motion, model::EffectTheta theta, model::Load& load) const override {
    load.wrench[1] += theta[0] * std::sin(0.3 * motion.t + 0.006 * motion.t * motion.t);
  }
};

void check_outsider(const model::Effect& outsider, double size, unsigned seed) {
  const model::Vehicle& vehicle = vehicle_named("seabotix_lbv150");
  const Outcome outcome = search_dive(vehicle, {{&outsider, 0, "", {size}}}, kShort, seed);
  MESSAGE(outsider.name() << " outside the registry: " << (outcome.said.empty() ? "no name; " : outcome.said)
                          << outcome.seconds << " s, residual scale " << outcome.found.before.sigma.transpose());
  // It was strong enough to be seen at all: the noise put in is 5 mm/s.
  CHECK(outcome.found.before.sigma.head<3>().maxCoeff() > 0.01);
  for (const Judged& judged : outcome.found.accepted) {
    CAPTURE(judged.effect->name());
    CHECK(judged.error_reduction < kConfidentShare);
  }
}

}  // namespace

TEST_CASE("search: what the registry does not hold gets no confident name") {
  check_outsider(Outsider<Lift>{"lift"}, 15.0, 11);
}

TEST_CASE("search survey: outsiders" * doctest::skip() * doctest::description("slow: --no-skip")) {
  check_outsider(Outsider<Lift>{"lift"}, 15.0, 12);
  check_outsider(Outsider<Gyroscope>{"gyroscope"}, 3.0, 13);
  check_outsider(Outsider<Pump>{"pump"}, 3.0, 14);
}
