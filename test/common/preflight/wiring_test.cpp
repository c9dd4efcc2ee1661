// Thrusters under another name or sign than the file's: the arrangement is found from motion alone, and never where the
// file is right, whatever else is wrong.
#include "common/preflight/wiring.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::preflight;

namespace {

Wiring as_filed(std::size_t inputs) {
  Wiring wiring{std::vector<std::size_t>(inputs), std::vector<int>(inputs, 1)};
  std::iota(wiring.actuator.begin(), wiring.actuator.end(), std::size_t{0});
  return wiring;
}

/// What is recorded when input i is told to actuator[i]: the way back from rewired().
void miswire(Trial& trial, const Wiring& wiring) {
  for (auto* inputs : {&trial.input, &trial.held, &trial.told}) {
    for (Eigen::VectorXd& input : *inputs) {
      const Eigen::VectorXd right = input;
      for (std::size_t i = 0; i < wiring.sign.size(); ++i)
        input[static_cast<Eigen::Index>(i)] = wiring.sign[i] * right[static_cast<Eigen::Index>(wiring.actuator[i])];
    }
  }
}

using Allocation = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/// What the wiring makes of the file's columns, on the axes that move: twins may be exchanged.
Allocation effective(const Wiring& wiring, const model::Vehicle& vehicle, bool wrench) {
  const Allocation filed = wrench ? Allocation{Allocation::Identity(6, 6)} : vehicle.allocation;
  Allocation all = filed;
  for (Eigen::Index i = 0; i < all.cols(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    all.col(i) = wiring.sign[k] * filed.col(static_cast<Eigen::Index>(wiring.actuator[k]));
    for (Eigen::Index axis = 0; axis < 6; ++axis) {
      if (!vehicle.dof[static_cast<std::size_t>(axis)]) all(axis, i) = 0.0;
    }
  }
  return all;
}

}  // namespace

TEST_CASE("wiring: whatever thrusters are exchanged or reversed, motion tells which") {
  std::mt19937 random{20};
  for (const char* name : {"bluerov2", "seabotix_lbv150"}) {
    const model::Vehicle vehicle = test::vehicle_from_repository(name);
    for (unsigned seed = 1; seed <= 4; ++seed) {
      CAPTURE(name);
      CAPTURE(seed);
      test::VirtualDive dive = test::make_dive(vehicle, {.duration = 100.0, .seed = seed});
      Wiring truth = as_filed(vehicle.thrusters.size());
      // From one exchange to any arrangement at all.
      const std::size_t exchanges = seed % 4;
      for (std::size_t i = 0; i < exchanges; ++i)
        std::swap(truth.actuator[random() % truth.actuator.size()], truth.actuator[random() % truth.actuator.size()]);
      for (int& sign : truth.sign) sign = random() % 4 == 0 ? -1 : 1;
      miswire(dive.trial, truth);
      const bool changed =
          !effective(truth, vehicle, false).isApprox(effective(as_filed(truth.sign.size()), vehicle, false));
      const std::vector<Wiring> likely = likely_wirings(vehicle, std::span{&dive.trial, 1});
      REQUIRE(likely.empty() != changed);
      if (!changed) continue;
      CHECK(std::ranges::any_of(likely, [&](const Wiring& wiring) {
        return effective(wiring, vehicle, false).isApprox(effective(truth, vehicle, false));
      }));
      const auto fault = wiring_fault(vehicle, std::span{&dive.trial, 1}, {});
      REQUIRE(fault);
      CHECK(fault->error_reduction > 0.5);
      CHECK(fault->readings.size() == likely.size());
    }
  }
}

TEST_CASE("wiring: motion along other axes than the file's is told before thrusters that would all be wrong at once") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  for (const bool wrench : {false, true}) {
    CAPTURE(wrench);
    test::VirtualDive dive = test::make_dive(vehicle, {.duration = 100.0, .seed = 6, .wrench = wrench});
    const Vector6d signs{1.0, -1.0, -1.0, 1.0, -1.0, -1.0};
    for (Vector6d& nu : dive.trial.nu) nu = nu.cwiseProduct(signs).eval();
    const Eigen::Quaterniond half{0.0, 1.0, 0.0, 0.0};  // w x y z
    for (Eigen::Quaterniond& q : dive.trial.q_WB) q = half * q * half.conjugate();
    for (Eigen::Vector3d& p : dive.trial.p_WB) p = half * p;
    const auto fault = wiring_fault(vehicle, std::span{&dive.trial, 1}, {});
    REQUIRE(fault);
    CHECK(fault->error_reduction > 0.5);
    CHECK(fault->readings.front().starts_with("motion told along left and up in place of right and down"));
  }
}

TEST_CASE("wiring: of a measured wrench the reversed axis is told") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  test::VirtualDive dive = test::make_dive(vehicle, {.duration = 100.0, .seed = 4, .wrench = true});
  Wiring truth = as_filed(6);
  truth.sign[2] = -1;
  miswire(dive.trial, truth);
  const auto fault = wiring_fault(vehicle, std::span{&dive.trial, 1}, {});
  REQUIRE(fault);
  CHECK(fault->readings == std::vector<std::string>{"Z reversed"});
}

TEST_CASE("wiring: where the file is right nothing is said of it, whatever effect is strong") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const std::vector<std::vector<model::ActiveEffect>> worlds{{},
                                                             {test::active("thruster_lag", {0.6})},
                                                             {test::active("thruster_gain", {-0.9}, 2)},
                                                             {test::active("thruster_failure", {1.0, 20.0}, 0)},
                                                             {test::active("thruster_misalignment", {0.5}, 1)},
                                                             {test::active("current", {0.4, -0.3})},
                                                             {test::active("thruster_delay", {0.5})}};
  unsigned seed = 30;
  for (const auto& effects : worlds) {
    const test::VirtualDive dive =
        test::make_dive(vehicle, {.duration = 100.0, .seed = ++seed, .noise_memory = 0.3, .effects = effects});
    CAPTURE(effects.empty() ? "nothing" : effects.front().effect->name());
    CHECK_FALSE(wiring_fault(vehicle, std::span{&dive.trial, 1}, {}));
  }
}

TEST_CASE("wiring: a reading is told in the file's names") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const auto name = [&](std::size_t i) { return vehicle.thrusters[i].name; };
  Wiring wiring = as_filed(vehicle.thrusters.size());
  CHECK(words_for(wiring, vehicle, false).empty());
  std::swap(wiring.actuator[0], wiring.actuator[2]);
  wiring.sign[1] = -1;
  CHECK(words_for(wiring, vehicle, false) == name(0) + " and " + name(2) + " exchanged, " + name(1) + " reversed");
  wiring = as_filed(vehicle.thrusters.size());
  std::rotate(wiring.actuator.begin(), wiring.actuator.begin() + 1, wiring.actuator.begin() + 3);
  CHECK(words_for(wiring, vehicle, false) == name(0) + " acting as " + name(1) + ", " + name(1) + " acting as " +
                                                 name(2) + ", " + name(2) + " acting as " + name(0));
  std::ranges::fill(wiring.sign, -1);
  CHECK(words_for(as_filed(6), vehicle, true).empty());
  CHECK(words_for({{0, 1, 2, 3, 4, 5}, {-1, -1, -1, -1, -1, -1}}, vehicle, true) == "every axis reversed");
}
