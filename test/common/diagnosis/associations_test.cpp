// What a residual goes with: structure that is put in is named, noise with a memory is not, although a pilot answers
// it.
#include "common/diagnosis/associations.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>

#include "common/diagnosis/force_residual.hpp"
#include "test/support/timing.hpp"

using namespace fathom;
using namespace fathom::diagnosis;

namespace {

constexpr double kDt = 0.05;          // s
constexpr std::size_t kCount = 6600;  // samples
constexpr double kShare = 0.1, kOdds = 5.0;
constexpr double kTumbleDt = 0.2;           // s
constexpr std::size_t kTumbleSamples = 60;  // that do not overlap

model::Vehicle one_axis() {
  model::Vehicle vehicle;
  vehicle.dof[0] = true;
  return vehicle;
}

/// A craft of 10 kg that surges, turning slowly; `memory`: of the noise, s; `answer`: of a pilot to its speed,
/// N/(m/s); `effort`: what is wanted of the thrusters, N (RMS). What the model lacks is noise of 1 N, and the
/// structure.
struct Dive {
  model::Vehicle vehicle = one_axis();
  model::Model model = model::nominal_model(vehicle, true);
  std::vector<Trial> trials{1};
  std::vector<std::vector<Vector6d>> residuals{1};

  using Structure = std::function<double(const Trial&, std::size_t)>;
  explicit Dive(unsigned seed, double memory = 0.0, double answer = 0.0, const Structure& structure = {},
                double effort = 20.0, std::size_t count = kCount) {
    model.theta[model::index(*model::parameter_from_name("m_X"))] = 10.0;
    model.theta[model::index(*model::parameter_from_name("X_u"))] = -8.0;
    std::mt19937 random{seed};
    std::normal_distribution<double> normal;
    Trial& trial = trials[0];
    trial.name = "dive";
    trial.dt = kDt;
    trial.observed = {true, true, true, true};
    const double keep = memory > 0.0 ? std::exp(-kDt / memory) : 0.0;
    double noise = 0.0, u = 0.0, x = 0.0, wanted = 0.0;
    std::vector<double> sum{0.0};  // of what the model lacks
    for (std::size_t k = 0; k < count; ++k) {
      const double t = kDt * static_cast<double>(k);
      if (k % 80 == 0) wanted = effort * normal(random);
      noise = keep * noise + std::sqrt(1.0 - keep * keep) * normal(random);
      trial.t.push_back(t);
      trial.p_WB.emplace_back(x, std::sin(0.11 * t), 2.0 + 0.5 * std::sin(0.07 * t));
      trial.q_WB.emplace_back(Eigen::AngleAxisd(0.05 * t + std::sin(0.2 * t), Eigen::Vector3d::UnitZ()));
      trial.nu.emplace_back(u * Vector6d::Unit(0));
      trial.pose_valid.push_back(1);
      trial.velocity_valid.push_back(1);
      trial.rates_valid.push_back(1);
      trial.input.emplace_back(Eigen::VectorXd::Unit(6, 0) * (wanted - answer * u - 0.5 * x));
      const double lacking = noise + (structure ? structure(trial, k) : 0.0);
      sum.push_back(sum.back() + lacking);
      u += kDt / 10.0 * (trial.input.back()[0] - 8.0 * u + lacking);
      x += kDt * u;
    }
    const std::size_t span = residual_span(kDt), half = span / 2;  // a residual is a mean
    residuals[0].assign(count, Vector6d::Constant(std::numeric_limits<double>::quiet_NaN()));
    for (std::size_t k = half; k + half < count; ++k)
      residuals[0][k] = (sum[k + half + 1] - sum[k - half]) / static_cast<double>(span) * Vector6d::Unit(0);
  }
  [[nodiscard]] std::vector<Association> left(double of_wrench = 0.0) const {
    return LeftOver{model, trials, residuals}.associations(kShare, kOdds, of_wrench);
  }
};

/// A craft that moves along and about all axes for as short a time as lets a thrust be asked, beside noise without a
/// memory.
struct Tumble {
  model::Vehicle vehicle;
  model::Model model;
  std::vector<Trial> trials{1};
  std::vector<std::vector<Vector6d>> residuals{1};

  explicit Tumble(unsigned seed, std::size_t samples = kTumbleSamples) {
    vehicle.dof.fill(true);
    model = model::nominal_model(vehicle, true);
    constexpr double kMemory = 2.0;  // s, of its speeds
    const double keep = std::exp(-kTumbleDt / kMemory);
    const std::size_t span = residual_span(kTumbleDt);
    const std::size_t count = samples * span;
    std::mt19937 random{seed};
    std::normal_distribution<double> normal;
    const auto drawn = [&] { return Vector6d{Vector6d::NullaryExpr([&] { return normal(random); })}; };
    Trial& trial = trials[0];
    trial.name = "tumble";
    trial.dt = kTumbleDt;
    trial.observed = {true, true, true, true};
    Vector6d nu = drawn(), tau = drawn();
    for (std::size_t k = 0; k < count; ++k) {
      const double t = kTumbleDt * static_cast<double>(k);
      if (k % 10 == 0) tau = drawn();
      nu = keep * nu + std::sqrt(1.0 - keep * keep) * drawn();
      trial.t.push_back(t);
      trial.p_WB.emplace_back(std::sin(0.3 * t), std::sin(0.11 * t), 2.0 + 0.5 * std::sin(0.2 * t));
      trial.q_WB.emplace_back(Eigen::AngleAxisd(0.2 * t, Eigen::Vector3d::UnitZ()));
      trial.nu.push_back(nu);
      trial.pose_valid.push_back(1);
      trial.velocity_valid.push_back(1);
      trial.rates_valid.push_back(1);
      trial.input.emplace_back(tau);
      if (k % span == 0) residuals[0].resize(k + span, drawn());  // a residual is a mean
    }
    residuals[0].resize(count);
  }
  [[nodiscard]] std::vector<Association> left() const {
    return LeftOver{model, trials, residuals}.associations(kShare, kOdds, 0.0);
  }
};

double heading(const Trial& trial, std::size_t k) { return euler_from_rotation(trial.q_WB[k].toRotationMatrix()).z(); }

/// Three seconds in about fifteen, at moments without a period.
bool episode(double t) {
  const double n = std::floor(t / 15.0);
  const double begin = 15.0 * n + 12.0 * (0.5 + 0.5 * std::sin(2.4 * n * n));
  return t >= begin && t < begin + 3.0;
}

bool among(const std::vector<Association>& left, const std::string& with) {
  return std::ranges::any_of(left, [&](const Association& a) { return a.with.starts_with(with); });
}

}  // namespace

TEST_CASE("associations: noise goes with nothing, whatever its memory and however a pilot answers it") {
  int found = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    const double memory = std::array{0.0, 0.5, 2.0, 5.0}[seed % 4];
    const double answer = seed % 8 < 4 ? 0.0 : 40.0;
    const auto left = Dive{seed, memory, answer, {}, seed % 16 < 8 ? 4.0 : 20.0}.left();
    for (const Association& one : left) MESSAGE(seed << ": " << one.with << " " << one.share << " " << one.log_odds);
    found += left.empty() ? 0 : 1;
  }
  CHECK(found == 0);
}

TEST_CASE("associations: half a minute of noise goes with nothing either") {
  constexpr std::size_t kShort = 660;
  const unsigned kSeeds = test::seeds(400);
  int found = 0;
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    const double memory = std::array{0.0, 0.5, 2.0, 5.0}[seed % 4];
    const double answer = seed % 8 < 4 ? 0.0 : 40.0;
    const auto left = Dive{seed, memory, answer, {}, seed % 16 < 8 ? 4.0 : 20.0, kShort}.left();
    for (const Association& one : left) MESSAGE(seed << ": " << one.with << " " << one.share << " " << one.log_odds);
    found += left.empty() ? 0 : 1;
  }
  CHECK(found <= 4);  // e^-5 each, and Student's tails
}

TEST_CASE("associations: nor does it with few samples for each of many columns") {
  const unsigned kSeeds = test::seeds(1300);
  int found = 0;
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    const auto left = Tumble{seed}.left();
    for (const Association& one : left) MESSAGE(seed << ": " << one.with << " " << one.share << " " << one.log_odds);
    found += left.empty() ? 0 : 1;
  }
  CHECK(found <= 4);  // 2 at the time of writing; 8 when all samples count as free
}

TEST_CASE("associations: what is small beside the thrust is none, however sure it is") {
  const Dive dive{3, 0.0, 0.0, [](const Trial& t, std::size_t k) { return 2.0 * std::abs(t.nu[k][0]); }};
  const auto all = dive.left();
  REQUIRE(among(all, "speed"));
  const auto speed = std::ranges::find(all, std::string{"speed"}, &Association::with);
  REQUIRE(speed != all.end());
  CHECK(speed->of_wrench > 0.01);
  CHECK(speed->of_wrench < 0.2);
  CHECK(among(dive.left(0.9 * speed->of_wrench), "speed"));
  CHECK_FALSE(among(dive.left(1.1 * speed->of_wrench), "speed"));
}

TEST_CASE("associations: what is put in is named, in noise with a memory, and with the share that it has") {
  struct Case {
    const char* with;
    Dive::Structure structure;
  };
  const std::vector<Case> cases{
      {"position", [](const Trial& t, std::size_t k) { return 4.0 * t.p_WB[k].y(); }},
      {"depth", [](const Trial& t, std::size_t k) { return 8.0 * t.p_WB[k].z(); }},
      {"heading, like a force that is steady in the world",
       [](const Trial& t, std::size_t k) { return 3.0 * std::cos(heading(t, k)); }},
      {"heading", [](const Trial& t, std::size_t k) { return 3.0 * std::cos(2.0 * heading(t, k)); }},
      {"speed", [](const Trial& t, std::size_t k) { return 4.0 * std::abs(t.nu[k][0]); }},
      {"thrust", [](const Trial& t, std::size_t k) { return 0.2 * std::abs(t.input[k][0]); }},
      {"thrust a moment ago", [](const Trial& t, std::size_t k) { return k < 14 ? 0.0 : 0.2 * t.input[k - 14][0]; }},
      {"heading and time, like a force in the world that changes slowly",
       [](const Trial& t, std::size_t k) { return 12.0 * std::cos(heading(t, k)) * std::sin(0.06 * t.t[k] + 1.0); }},
      {"heading and time, like a force in the world that swings with 0.014",
       [](const Trial& t, std::size_t k) { return 3.0 * std::cos(heading(t, k) - 0.09 * t.t[k]); }},
      {"time, swinging slowly", [](const Trial& t, std::size_t k) { return 4.0 * std::sin(0.06 * t.t[k]); }},
      {"time, as a drift", [](const Trial& t, std::size_t k) { return 0.03 * t.t[k]; }},
      {"time, as thrust or drag that changes",
       [](const Trial& t, std::size_t k) { return 0.001 * t.t[k] * t.input[k][0]; }},
      {"a step at 1", [](const Trial& t, std::size_t k) { return t.t[k] > 140.0 ? 4.0 : 0.0; }},
      {"bursts of no recorded cause",
       [](const Trial& t, std::size_t k) { return episode(t.t[k]) ? 12.0 * std::sin(1.9 * t.t[k]) : 0.0; }},
      {"an oscillation of 0.2",
       [](const Trial& t, std::size_t k) { return 2.0 * std::sin(2.0 * std::numbers::pi * 0.2 * t.t[k]); }}};
  for (const Case& each : cases) {
    const auto left = Dive{7, 0.5, 10.0, each.structure}.left();
    CHECK_MESSAGE(among(left, each.with), std::string{each.with} << " is not among " << left.size()
                                                                 << (left.empty() ? "" : ": " + left[0].with));
    for (const Association& one : left) {
      CHECK(one.axis == "X");
      CHECK(one.share <= 1.0);
    }
  }
  const auto left = Dive{8, 0.5, 10.0, cases[0].structure}.left();
  REQUIRE_FALSE(left.empty());
  CHECK(left.front().with == "position");
  CHECK(left.front().share == doctest::Approx(8.0 / 9.0).epsilon(0.1));  // variances 4^2 / 2 of it, 1 of the noise
}

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

TEST_CASE("associations: thrust that is lost now and then comes in bursts, whose size goes with thrust") {
  const auto air = [](const Trial& t, std::size_t k) {  // more and less of it every half second
    const double n = std::floor(2.0 * t.t[k]);
    return episode(t.t[k]) ? -(0.5 + 0.5 * std::sin(9.7 * n * n)) * t.input[k][0] : 0.0;
  };
  int found = 0, with_thrust = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    const auto left = Dive{seed, 0.5, 10.0, air, 60.0}.left();
    found += among(left, "bursts") ? 1 : 0;
    with_thrust += among(left, "bursts, whose size goes with thrust") ? 1 : 0;
    CHECK_FALSE(among(left, "bursts, whose size goes with depth"));
  }
  CHECK(found == 20);
  CHECK(with_thrust >= 10);  // 12 at the time of writing: bursts are few, and only evidence names what they go with
}

TEST_CASE("associations: noise of moments that grows with the speed is no burst, the same of a force is") {
  for (const int axis : {0, 5}) {
    Tumble tumble{4, 600};
    for (std::size_t k = 0; k < tumble.trials[0].size(); ++k)
      tumble.residuals[0][k][axis] *= std::pow(tumble.trials[0].nu[k][1], 2);
    CHECK(among(tumble.left(), "bursts") == (axis == 0));
  }
}

TEST_CASE("associations: a run without the quantity is left out, a run too short tells nothing") {
  Dive dive{3, 0.5, 10.0, [](const Trial& t, std::size_t k) { return 4.0 * t.p_WB[k].y(); }};
  dive.trials[0].observed.position = false;
  CHECK_FALSE(among(dive.left(), "position"));
  Dive brief{3};
  Trial& trial = brief.trials[0];
  for (auto* flags : {&trial.pose_valid, &trial.velocity_valid, &trial.rates_valid}) flags->resize(60);
  trial.t.resize(60);
  trial.p_WB.resize(60);
  trial.q_WB.resize(60);
  trial.nu.resize(60);
  trial.input.resize(60);
  brief.residuals[0].resize(60);
  CHECK(brief.left().empty());
  // Runs of nothing beside a good one: left out.
  Dive whole{9, 0.5, 10.0, [](const Trial& t, std::size_t k) { return 4.0 * t.p_WB[k].y(); }};
  whole.trials.insert(whole.trials.begin(), Trial{.dt = kDt});
  whole.residuals.insert(whole.residuals.begin(), std::vector<Vector6d>{});
  CHECK(among(whole.left(), "position"));
}

TEST_CASE("associations: a free curve is believed when the residual goes with it, and not for noise with a memory") {
  const FreeCurve north{0, Quantity::kNorth, -2.0, 2.0, 1.0, true}, depth{0, Quantity::kDepth, 1.5, 2.5, 1.0, true};
  const auto bump = [](const Trial& t, std::size_t k) {
    return 4.0 * std::exp(-std::pow((t.p_WB[k].z() - 2.2) / 0.1, 2));
  };
  const Dive bumped{4, 0.5, 10.0, bump}, noisy{5, 3.0, 40.0};
  const LeftOver of_bump{bumped.model, bumped.trials, bumped.residuals},
      of_noise{noisy.model, noisy.trials, noisy.residuals};
  CHECK(of_bump.log_odds(depth) > 20.0);
  CHECK(of_bump.log_odds(north) < 5.0);
  CHECK(of_noise.log_odds(depth) < 0.0);
  CHECK(of_noise.log_odds(north) < 0.0);
}
