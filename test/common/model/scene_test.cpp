// What a set of trials offers to effects that choose their forms by it.
#include <doctest/doctest.h>

#include "common/model/rollout.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;

TEST_CASE("scene: signals, ranges and sizes of the runs together") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  std::vector<Trial> trials{test::make_dive(vehicle, {.duration = 20.0, .seed = 61}).trial,
                            test::make_dive(vehicle, {.duration = 40.0, .seed = 62}).trial};
  trials[0].observed.position = false;
  trials[0].voltage.clear();
  const model::Scene scene = model::scene_of(vehicle, trials);
  CHECK(scene.vehicle == &vehicle);
  CHECK(scene.position);  // of one run is enough
  CHECK(scene.attitude);
  CHECK(scene.voltage);
  CHECK_FALSE(scene.input_is_wrench);
  CHECK(scene.duration == doctest::Approx(40.0));
  CHECK(scene.voltage_range == doctest::Approx(3.0));
  CHECK(scene.mean_voltage == doctest::Approx(15.0));
  Vector6d square = Vector6d::Zero();
  double force = 0.0, count = 0.0;
  for (const Trial& trial : trials) {
    for (std::size_t k = 0; k < trial.size(); ++k) {
      square += trial.nu[k].cwiseAbs2();
      force += trial.input[k][2] * trial.input[k][2];
      count += 1.0;
      CHECK((trial.p_WB[k].array() >= scene.p_low.array()).all());
      CHECK((trial.p_WB[k].array() <= scene.p_high.array()).all());
    }
  }
  constexpr double kRounding = 1e-12;
  CHECK((scene.nu_rms - (square / count).cwiseSqrt()).norm() < kRounding);
  REQUIRE(scene.force_rms.size() == 4);
  CHECK(scene.force_rms[2] == doctest::Approx(std::sqrt(force / count)));
  // The vertical thruster alone pushes down.
  CHECK(scene.tau_rms[2] == doctest::Approx(scene.force_rms[2]));
}

TEST_CASE("scene: no run at all offers nothing") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const model::Scene scene = model::scene_of(vehicle, {});
  CHECK_FALSE(scene.position);
  CHECK_FALSE(scene.voltage);
  CHECK(scene.duration == 0.0);
  CHECK(scene.nu_rms.isZero(0.0));
  CHECK(scene.force_rms.size() == 4);
}
