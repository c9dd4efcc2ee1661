// Evidence from rows that are made up: the truth is known to the last number, so what must be found is known too.
#include "common/diagnosis/live_evidence.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "test/support/virtual_dive.hpp"

namespace fathom::diagnosis {
namespace {

constexpr Eigen::Index kBase = 3;
constexpr double kNoise = 1.0;  // rows are divided by their standard deviation
constexpr int kRows = 20;       // of a block

/// Candidates of a real vehicle; rows bring made-up numbers for their columns.
struct Bench {
  model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  LiveCandidates candidates{model::nominal_model(vehicle, true), [&] {
                              model::Scene scene{.vehicle = &vehicle, .attitude = true, .velocity = true};
                              scene.rates = scene.input_is_wrench = true;
                              scene.nu_rms.setConstant(0.3);
                              scene.tau_rms.setConstant(5.0);
                              scene.force_rms = model::ActuatorForces::Constant(6, 5.0);
                              return scene;
                            }()};
  Eigen::VectorXd information = Eigen::VectorXd::Constant(kBase, 1e-6);
  std::mt19937 random{17};
  std::normal_distribution<double> normal;

  Eigen::VectorXd random_row() {
    Eigen::VectorXd row(kBase + 1 + candidates.columns());
    for (double& value : row) value = normal(random);
    return row;
  }
  /// Blocks of rows on one axis; `left` is what the base parameters (2, -1, 0.5) leave of y before the noise.
  void feed(LiveEvidence& evidence, int blocks, const std::function<double(Eigen::VectorXd& row)>& left) {
    const Eigen::Vector3d b(2.0, -1.0, 0.5);
    for (int k = 0; k < blocks * kRows; ++k) {
      Eigen::VectorXd row = random_row();
      row[kBase] = 0.0;
      const double rest = left(row);
      row[kBase] = row.head<kBase>().dot(b) + rest + kNoise * normal(random);
      evidence.next_instant();
      evidence.add(0, row, row[kBase]);
      if ((k + 1) % kRows == 0) evidence.close_block();
    }
  }
  [[nodiscard]] const LiveStart& start_with(std::size_t numbers) const {
    const auto& starts = candidates.starts();
    const auto found = std::find_if(starts.begin(), starts.end(), [&](const LiveStart& one) {
      const auto same = [&](const LiveStart& other) { return other.form == one.form; };
      return one.theta.size() == numbers && std::count_if(starts.begin(), starts.end(), same) == 1;
    });
    REQUIRE(found != starts.end());
    return *found;
  }
  [[nodiscard]] double sigma(const LiveStart& start, std::size_t i = 0) const {
    return candidates.forms()[static_cast<std::size_t>(start.form)].effect->parameters()[i].sigma;
  }
};

Eigen::Index column_of(const LiveStart& start) { return kBase + 1 + start.column; }

}  // namespace

TEST_CASE("live evidence: the form that made the rows comes first, with its numbers") {
  Bench bench;
  const LiveStart& truth = bench.start_with(1);
  LiveEvidence evidence{bench.candidates, bench.information, {}, 100};
  constexpr double kMoved = 0.7;  // sigmas away from where it is linearised
  bench.feed(evidence, 30, [&](Eigen::VectorXd& row) {
    return -(3.0 * row[column_of(truth)] + 3.0 * kMoved * row[column_of(truth) + 1]) / 3.0;
  });
  CHECK(evidence.blocks() == 30);
  const auto judged = evidence.judge();
  REQUIRE(judged.size() == bench.candidates.forms().size());
  CHECK(judged.front().form == truth.form);
  CHECK(judged.front().log_odds > 10.0);
  CHECK(judged[1].log_odds < 0.0);
  for (std::size_t i = 1; i < judged.size(); ++i) CHECK(judged[i].log_odds <= judged[i - 1].log_odds);
  constexpr double kScatter = 0.2;  // sigmas: five times 1 / sqrt(600 rows), with the prior's pull of 1 / 600
  CHECK(std::abs((judged.front().theta[0] - truth.theta[0]) / bench.sigma(truth) - kMoved) < kScatter);
  // From a variance of 1 + 1 + 0.49 to the noise.
  CHECK(judged.front().error_reduction == doctest::Approx(1.0 - 1.0 / std::sqrt(2.49)).epsilon(0.15));
  CHECK(judged.front().block_cost.size() == 30);
  CHECK(evidence.likeness(judged.front(), judged.front()) == doctest::Approx(1.0));
  CHECK(std::abs(evidence.likeness(judged.front(), judged.back())) < 0.3);
}

TEST_CASE("live evidence: rows that the base explains convince nobody") {
  Bench bench;
  LiveEvidence evidence{bench.candidates, bench.information, {}, 100};
  CHECK(evidence.judge().empty());
  CHECK_FALSE(evidence.structured());
  bench.feed(evidence, 30, [](Eigen::VectorXd&) { return 0.0; });
  for (const LiveSuspicion& one : evidence.judge()) CHECK(one.log_odds < 3.0);
  CHECK_FALSE(evidence.structured());
}

TEST_CASE("live evidence: what the base can imitate is no candidate's merit") {
  Bench bench;
  const LiveStart& imitated = bench.start_with(1);
  LiveEvidence evidence{bench.candidates, bench.information, {}, 100};
  bench.feed(evidence, 30, [&](Eigen::VectorXd& row) {
    row[column_of(imitated)] = 0.8 * row[0] - 0.3 * row[1];
    row[column_of(imitated) + 1] = 0.1 * row[2];
    return -2.0 * row[column_of(imitated)];
  });
  for (const LiveSuspicion& one : evidence.judge()) {
    if (one.form == imitated.form) CHECK(one.log_odds < 0.0);
  }
}

TEST_CASE("live evidence: a number never leaves its bounds") {
  Bench bench;
  const auto& starts = bench.candidates.starts();
  const auto bounded = std::find_if(starts.begin(), starts.end(), [&](const LiveStart& one) {
    return bench.candidates.forms()[static_cast<std::size_t>(one.form)].effect->name() == "thruster_lag";
  });
  REQUIRE(bounded != starts.end());
  const auto parameter = bench.candidates.forms()[static_cast<std::size_t>(bounded->form)].effect->parameters()[0];
  REQUIRE(std::isfinite(parameter.low));
  LiveEvidence evidence{bench.candidates, bench.information, {}, 100};
  const double beyond = (2.0 * (parameter.low - bounded->theta[0]) - 1.0) / parameter.sigma;
  bench.feed(evidence, 30,
             [&](Eigen::VectorXd& row) { return -(row[column_of(*bounded)] + beyond * row[column_of(*bounded) + 1]); });
  for (const LiveSuspicion& one : evidence.judge()) {
    if (one.form == bounded->form) CHECK(one.theta[0] == doctest::Approx(parameter.low));
  }
}

TEST_CASE("live evidence: taking thrust and mass away together explains nothing") {
  // The candidate undoes a share of y, and with it of the first base parameter, a mass.
  const auto judged_with = [](double share, std::vector<LiveEvidence::Mass> masses) {
    Bench bench;
    const LiveStart& thief = bench.start_with(1);
    LiveEvidence evidence{bench.candidates, bench.information, std::move(masses), 100};
    const Eigen::Index column = column_of(thief);
    for (int k = 0; k < 30 * kRows; ++k) {
      Eigen::VectorXd row = bench.random_row();
      row[kBase] = 2.0 * row[0] + kNoise * bench.normal(bench.random);
      row[column] = -share * row[kBase];
      row[column + 1] = 0.0;
      evidence.next_instant();
      evidence.add(0, row, row[kBase]);
      if ((k + 1) % kRows == 0) evidence.close_block();
    }
    for (const LiveSuspicion& one : evidence.judge()) {
      if (one.form == thief.form) return one;
    }
    return LiveSuspicion{};
  };
  for (const double share : {0.6, 0.85, 0.98}) {
    CAPTURE(share);
    const LiveSuspicion careless = judged_with(share, {});
    CHECK(careless.error_reduction == doctest::Approx(share).epsilon(0.02));
    CHECK(careless.log_odds > 10.0);
    const LiveSuspicion careful = judged_with(share, {{.column = 0, .prior_mean = 0.0}});
    CHECK(careful.error_reduction < 0.05);
    CHECK(careful.log_odds < 3.0);
  }
}

TEST_CASE("live evidence: blocks are bounded, of one length, and merging keeps the verdict") {
  Bench bench;
  const LiveStart& truth = bench.start_with(1);
  constexpr std::size_t kMost = 8;
  LiveEvidence evidence{bench.candidates, bench.information, {}, kMost};
  const auto left = [&](Eigen::VectorXd& row) { return -row[column_of(truth)]; };
  for (int k = 0; k < 60; ++k) {
    bench.feed(evidence, 1, left);
    CHECK(evidence.blocks() <= kMost);
  }
  CHECK(evidence.blocks() >= kMost / 2);
  const auto judged = evidence.judge();
  CHECK(judged.front().form == truth.form);
  // Blocks count alike, so their costs are of one size: noise alone scatters by a few per cent.
  const auto [low, high] = std::minmax_element(judged[0].block_cost.begin(), judged[0].block_cost.end());
  CHECK(*high < 2.0 * *low);
  evidence.close_block();  // an empty one counts for nothing
  CHECK(evidence.judge().front().block_cost.size() == judged.front().block_cost.size());
}

TEST_CASE("live evidence: a residual with memory is structure, unless it is small beside what was applied") {
  for (const double applied : {1.0, 100.0}) {
    Bench bench;
    LiveEvidence evidence{bench.candidates, bench.information, {}, 100};
    double memory = 0.0;
    for (int k = 0; k < 30 * kRows; ++k) {
      Eigen::VectorXd row = bench.random_row();
      memory = 0.95 * memory + std::sqrt(1.0 - 0.95 * 0.95) * bench.normal(bench.random);
      row[kBase] = row[0] + memory;
      evidence.next_instant();
      evidence.add(2, row, applied * row[kBase]);
      if ((k + 1) % kRows == 0) evidence.close_block();
    }
    CHECK(evidence.structured() == (applied == 1.0));
  }
}

}  // namespace fathom::diagnosis
