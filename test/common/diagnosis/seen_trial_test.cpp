// A sample that was kept comes back as it was, to the bit, whatever came before it.
#include "common/diagnosis/seen_trial.hpp"

#include <doctest/doctest.h>

#include <random>

using namespace fathom;
using namespace fathom::diagnosis;

namespace {

constexpr Eigen::Index kActuators = 5;

model::Allocation allocation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return model::Allocation::NullaryExpr(6, kActuators, [&] { return normal(random); });
}

LiveSample drawn(std::mt19937& random, int k, const model::Allocation& allocation) {
  std::normal_distribution<double> normal;
  LiveSample sample;
  sample.motion.utime = 1'700'000'000'000'000 + 10'000 * k;
  sample.motion.valid = k == 0 || k % 7 != 3;
  if (!sample.motion.valid) return sample;
  sample.q_WB = Eigen::Quaterniond{normal(random), normal(random), normal(random), normal(random)}.normalized();
  sample.p_WB = Eigen::Vector3d::NullaryExpr([&] { return normal(random); });
  sample.motion.nu = Vector6d::NullaryExpr([&] { return normal(random); });
  sample.motion.down_B = down_of(sample.q_WB);
  sample.force = model::ActuatorForces::NullaryExpr(kActuators, [&] { return normal(random); });
  sample.motion.tau = allocation * sample.force;
  sample.voltage = normal(random);
  sample.has_position = k % 2 == 0;
  if (k % 5 == 0) sample.commands_from = sample.motion.utime;
  for (int i = 0; i < k % 4; ++i)
    sample.commands.emplace_back(Eigen::VectorXd::NullaryExpr(kActuators, [&] { return normal(random); }));
  return sample;
}

void check_same(const LiveSample& a, const LiveSample& b) {
  CHECK(a.motion.utime == b.motion.utime);
  CHECK(a.motion.valid == b.motion.valid);
  CHECK(a.motion.nu == b.motion.nu);
  CHECK(a.motion.down_B == b.motion.down_B);
  CHECK(a.motion.tau == b.motion.tau);
  CHECK(a.p_WB == b.p_WB);
  CHECK(a.q_WB.coeffs() == b.q_WB.coeffs());
  REQUIRE(a.force.size() == b.force.size());
  CHECK(a.force == b.force);
  CHECK(a.voltage == b.voltage);
  CHECK(a.has_position == b.has_position);
  CHECK(a.commands_from == b.commands_from);
  REQUIRE(a.commands.size() == b.commands.size());
  for (std::size_t i = 0; i < a.commands.size(); ++i) CHECK(a.commands[i] == b.commands[i]);
}

}  // namespace

TEST_CASE("seen trial: samples come back to the bit, in any order, and again after a new beginning") {
  std::mt19937 random{7};
  SeenTrial seen;
  for (int run = 0; run < 2; ++run) {
    const model::Allocation B = allocation(random);
    seen.begin(B);
    CHECK(seen.empty());
    std::vector<LiveSample> all;
    for (int k = 0; k < 200; ++k) {
      all.push_back(drawn(random, k, B));
      seen.keep(all.back());
    }
    REQUIRE(seen.size() == all.size());
    CHECK(seen.first() == all.front().motion.utime);
    CHECK(seen.last() == all.back().motion.utime);
    LiveSample sample;
    for (std::size_t i = all.size(); i-- > 0;) {
      seen.get(i, sample);
      check_same(sample, all[i]);
    }
    const Eigen::Matrix3d turned = Eigen::AngleAxisd{0.1, Eigen::Vector3d::UnitX()}.toRotationMatrix();
    seen.turn(turned, Eigen::Matrix3d::Identity());
    seen.get(5, sample);
    CHECK(sample.motion.nu.head<3>() == turned * all[5].motion.nu.head<3>());
    CHECK(sample.motion.nu.tail<3>() == all[5].motion.nu.tail<3>());
  }
}
