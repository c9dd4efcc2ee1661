// Laws that no effect of the registry has are named by what their residual goes with.
#include <doctest/doctest.h>

#include "test/common/diagnosis/made_up_runs.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::diagnosis;

TEST_CASE("associations: what acts against the way it goes, and thrust that grows with speed") {
  const auto friction = [](const Trial& t, std::size_t k) { return t.nu[k][0] > 0.0 ? -5.0 : 5.0; };
  CHECK(among(Dive{7, 0.5, 0.0, friction, 60.0}.left(), "the way it goes, as of dry friction"));
  const auto gains = [](const Trial& t, std::size_t k) { return 0.02 * t.input[k][0] * std::abs(t.nu[k][0]); };
  CHECK(among(Dive{7, 0.5, 0.0, gains, 60.0}.left(), "thrust times speed"));
}

TEST_CASE("associations: thrusters that take each other's water") {
  Tumble tumble{5, 600};
  for (std::size_t k = 0; k < tumble.trials[0].size(); ++k) {
    const Eigen::VectorXd& tau = tumble.trials[0].input[k];
    tumble.residuals[0][k][0] += 1.5 * tau[0] * std::abs(tau[2]);
  }
  CHECK(among(tumble.left(), "thrust of several axes at once"));
}

TEST_CASE("associations: which thrusters are in each other's water, and which one does not give what is asked of it") {
  Tumble tumble{6, 600};
  tumble.vehicle = test::vehicle_from_repository("bluerov2");
  tumble.model = model::nominal_model(tumble.vehicle, false);
  const auto& thrusters = tumble.vehicle.thrusters;
  std::mt19937 random{6};
  std::normal_distribution<double> normal;
  Trial& trial = tumble.trials[0];
  for (std::size_t k = 0; k < trial.size(); ++k) {
    trial.input[k] = k % 10 == 0 ? Eigen::VectorXd::NullaryExpr(static_cast<Eigen::Index>(thrusters.size()),
                                                                [&] { return normal(random); })
                                 : trial.input[k - 1];
    tumble.residuals[0][k][1] += 0.8 * trial.input[k][0] * std::abs(trial.input[k][2]);
    tumble.residuals[0][k][2] += 0.4 * std::pow(trial.input[k][1], 3);
  }
  const auto left = tumble.left();
  CHECK(among(left, "thrust of " + thrusters[0].name + " and " + thrusters[2].name + " at once"));
  CHECK(among(left, "thrust of " + thrusters[1].name + ", not in proportion"));
  CHECK_FALSE(among(left, "thrust of " + thrusters[0].name + " and " + thrusters[1].name));
}
