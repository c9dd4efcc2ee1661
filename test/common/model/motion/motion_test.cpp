// The command as a signal of time, and the velocity that the hull feels.
#include "common/model/motion.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

using namespace fathom;

namespace {

constexpr double kRounding = 1e-12;

std::vector<Eigen::VectorXd> ramp() {
  std::vector<Eigen::VectorXd> samples;
  samples.reserve(4);
  for (int k = 0; k < 4; ++k) samples.emplace_back(Eigen::Vector2d(k, 10.0 - k * k));
  return samples;
}

}  // namespace

TEST_CASE("input signal: samples at their times, straight lines between, held outside") {
  const auto samples = ramp();
  const model::InputSignal input{100.0, 0.5, samples};
  model::ActuatorForces force;
  const auto at = [&](double t) {
    input.at(t, force);
    return Eigen::Vector2d(force);
  };
  for (std::size_t k = 0; k < samples.size(); ++k)
    CHECK((at(100.0 + 0.5 * static_cast<double>(k)) - samples[k]).norm() < kRounding);
  CHECK((at(100.75) - Eigen::Vector2d(1.5, 7.5)).norm() < kRounding);
  CHECK(at(-5.0) == samples.front());
  CHECK(at(99.99) == samples.front());
  CHECK(at(101.51) == samples.back());
  CHECK(at(1e9) == samples.back());
}

TEST_CASE("input signal: commands that are held jump at their samples") {
  const auto samples = ramp();
  constexpr double kStep = 0.5;
  const auto now = [&](double hold, double t) {
    const model::InputSignal input{100.0, kStep, samples, {}, {}, {.hold = hold, .step = kStep}};
    model::ActuatorForces force;
    input.now(100.0 + t, force);
    return Eigen::Vector2d(force);
  };
  for (const double t : {0.5, 0.6, 0.99}) CHECK((now(0.5, t) - samples[1]).norm() < kRounding);   // since it was told
  for (const double t : {0.5, 0.6, 0.99}) CHECK((now(-0.5, t) - samples[2]).norm() < kRounding);  // told afterwards
  CHECK((now(0.0, 0.75) - Eigen::Vector2d(1.5, 7.5)).norm() < kRounding);
  CHECK((now(0.25, 0.75) - 0.5 * (samples[1] + Eigen::Vector2d(1.5, 7.5))).norm() < kRounding);  // half way to held
  CHECK(now(0.5, -1.0) == samples.front());
  CHECK(now(-0.5, 9.0) == samples.back());
}

TEST_CASE("input signal: means over parts of a step count for their part, between held and told") {
  const auto samples = ramp();
  constexpr double kStep = 0.5;
  std::vector<Eigen::VectorXd> held, told;  // two parts a step
  for (int k = 0; k < 8; ++k) {
    held.emplace_back(Eigen::Vector2d(k, -k));
    told.emplace_back(Eigen::Vector2d(k + 1, -k - 1));
  }
  const auto now = [&](double hold, double t) {
    const model::InputSignal input{3.0,  kStep, samples,
                                   held, told,  {.hold = hold, .step = 0.4 * kStep, .averaged = true}};
    model::ActuatorForces force;
    input.now(3.0 + t, force);
    return Eigen::Vector2d(force);
  };
  for (const double t : {0.5, 0.6, 0.74}) CHECK((now(0.5, t) - held[2]).norm() < kRounding);
  for (const double t : {0.75, 0.99}) CHECK((now(-0.5, t) - told[3]).norm() < kRounding);
  CHECK((now(0.0, 0.3) - Eigen::Vector2d(1.5, -1.5)).norm() < kRounding);
  CHECK((now(0.25, 0.3) - (0.75 * held[1] + 0.25 * told[1])).norm() < kRounding);
  CHECK((now(0.5, -1.0) - held.front()).norm() < kRounding);
  CHECK((now(0.5, 9.0) - held.back()).norm() < kRounding);
}

TEST_CASE("input signal: an earlier force is the mean over the time that has one force, so no jump is lost") {
  std::vector<Eigen::VectorXd> commands, held, told;  // every 0.05 s; a grid of 0.5 s, in parts of 0.25 s
  std::mt19937_64 random{11};
  std::normal_distribution<double> any;
  constexpr double kStep = 0.5, kPart = 0.25, kCommand = 0.05;
  for (int i = 0; i < 200; ++i) commands.emplace_back(Eigen::Matrix<double, 1, 1>(any(random)));
  const auto mean = [&](double from) {  // of the held commands over a part, by hand
    double sum = 0.0;
    for (int i = 0; i < 250; ++i) {
      const double at = std::clamp((from + (i + 0.5) * kPart / 250) / kCommand, 0.0, 199.0);
      sum += commands[static_cast<std::size_t>(at)][0];
    }
    return sum / 250;
  };
  std::vector<Eigen::VectorXd> samples;
  samples.reserve(20);
  for (int k = 0; k < 20; ++k) samples.push_back(commands[static_cast<std::size_t>(10 * k)]);
  for (int j = 0; j < 40; ++j) held.emplace_back(Eigen::Matrix<double, 1, 1>(mean(j * kPart)));
  told = held;
  const model::InputSignal input{0.0, kStep, samples, held, told, {.hold = 0.5, .step = kCommand, .averaged = true}};
  model::ActuatorForces force, same;
  for (const double t : {3.0, 3.1, 3.24, 4.75}) {
    const double begin = kPart * std::floor(t / kPart);
    input.now(t, force);
    input.ago(t, 0.0, same);
    CHECK(force == same);  // no time ago is now
    for (const int parts : {1, 3, 7}) {
      input.ago(t, parts * kPart, force);
      CHECK(force[0] == doctest::Approx(mean(begin - parts * kPart)).epsilon(1e-9));
    }
    // Between them the impulse is kept: what a part loses its neighbour has.
    double all = 0.0, plain = 0.0;
    for (int j = 0; j < 8; ++j) {
      input.ago(begin + (j + 0.5) * kPart, 0.4 * kPart, force);
      input.now(begin + (j + 0.5) * kPart, same);
      all += force[0];
      plain += same[0];
    }
    input.now(begin - 0.5 * kPart, force);
    input.now(begin + 7.5 * kPart, same);
    CHECK(all == doctest::Approx(plain + 0.4 * (force[0] - same[0])).epsilon(1e-9));
  }
  input.ago(0.1, 5.0, force);
  CHECK(force == held.front());
}

TEST_CASE("input signal: a single sample holds for ever") {
  const std::vector<Eigen::VectorXd> one{Eigen::Vector3d(1.0, 2.0, 3.0)};
  const model::InputSignal input{0.0, 0.1, one};
  model::ActuatorForces force;
  for (const double t : {-1.0, 0.0, 0.05, 7.0}) {
    input.at(t, force);
    CHECK(Eigen::Vector3d(force) == one[0]);
  }
}

TEST_CASE("motion: the water's velocity is taken from the linear part alone") {
  model::Motion motion;
  motion.nu << 1.0, 2.0, 3.0, 4.0, 5.0, 6.0;
  motion.v_WF_B << 0.5, -0.5, 0.25;
  Vector6d expected;
  expected << 0.5, 2.5, 2.75, 4.0, 5.0, 6.0;
  CHECK(motion.nu_r() == expected);
}
