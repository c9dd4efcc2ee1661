#include "common/inference/own_law.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/inference/feature_screen.hpp"

namespace fathom::inference {
namespace {

using likelihood::Factor;
using likelihood::Feature;
using likelihood::Quantity;

constexpr double kSmallestRange = 0.05;  // m
constexpr double kMoves = 1e-3;          // m/s, rad/s
constexpr double kStartDepth = 0.3;      // of a modulation, before its variance is known

/// What modulates together; empty: the force's own size.
using Group = std::vector<Feature>;

std::vector<Group> groups_of(const likelihood::Problem& problem, const model::Scene& scene) {
  const auto feature = [](const std::vector<Factor>& factors) {
    Feature one{.count = static_cast<int>(factors.size())};
    std::ranges::copy(factors, one.factors.begin());
    return one;
  };
  const auto of = [](Quantity quantity, int index, double a, double b) {
    return Factor{.quantity = quantity, .index = index, .a = a, .b = b};
  };
  std::vector<Group> groups{Group{}};
  const Eigen::Vector3d middle = 0.5 * (scene.p_low + scene.p_high), room = 0.5 * (scene.p_high - scene.p_low);
  if (scene.position && 2.0 * room.z() > kSmallestRange) {
    const Factor depth = of(Quantity::kDepth, 0, middle.z(), room.z());
    groups.push_back({feature({depth}), feature({depth, depth}), feature({depth, depth, depth})});
  }
  if (scene.position && room.head<2>().minCoeff() > 0.5 * kSmallestRange) {
    const Factor north = of(Quantity::kNorth, 0, middle.x(), room.x()),
                 east = of(Quantity::kEast, 0, middle.y(), room.y());
    groups.push_back(
        {feature({north}), feature({east}), feature({north, north}), feature({north, east}), feature({east, east})});
  }
  if (scene.attitude)
    groups.push_back(
        {feature({of(Quantity::kHeadingCosine, 1, 0.0, 1.0)}), feature({of(Quantity::kHeadingSine, 1, 0.0, 1.0)})});
  groups.push_back({feature({Factor{.quantity = Quantity::kFlowSpeed}})});
  for (int j = 0; j < 6; ++j) {
    if (scene.nu_rms[j] <= kMoves) continue;
    groups.push_back({feature({Factor{.quantity = Quantity::kVelocity, .index = j}}),
                      feature({Factor{.quantity = Quantity::kSpeed, .index = j}})});
  }
  const double half = std::max(0.5 * (problem.t_high - problem.t_low), 1.0);
  const Factor ramp = of(Quantity::kRamp, 0, 0.5 * (problem.t_low + problem.t_high), half);
  groups.push_back({feature({ramp}), feature({ramp, ramp})});
  return groups;
}

/// One run: the name's accelerations, axes x blocks, and what modulates them, columns x blocks.
struct Table {
  Eigen::MatrixXd acceleration, by;
};

Table table_of(const likelihood::Problem& problem, const Seen& seen, std::size_t effect,
               const std::vector<Group>& groups, std::size_t columns, std::size_t run) {
  likelihood::Hypothesis without = seen.fit.hypothesis;
  const model::ActiveEffect active = without.model.effects[effect];
  without.model.effects.erase(without.model.effects.begin() + static_cast<std::ptrdiff_t>(effect));
  EffectColumns force{problem, seen, without, run};
  force.add(active, active.theta);
  const std::vector<likelihood::Number> none;
  likelihood::Plant plant{seen.fit.hypothesis, none, problem.runs[run], run, false};
  plant.begin(problem.runs[run].start());
  const auto& reference = seen.reference[run];
  const auto blocks = static_cast<Eigen::Index>(problem.runs[run].blocks().size());
  Table table{Eigen::MatrixXd(reference.axes, blocks), Eigen::MatrixXd(static_cast<Eigen::Index>(columns), blocks)};
  likelihood::RowMatrix acceleration(reference.axes, 1), shown = likelihood::RowMatrix::Zero(reference.axes, 1);
  for (Eigen::Index b = 0; b < blocks; ++b) {
    const auto block = static_cast<std::size_t>(b);
    force.at(block, acceleration, shown);
    table.acceleration.col(b) = acceleration.col(0);
    plant.at_middle(block);
    const likelihood::FeatureState state = plant.features_at(reference.nu_middle.col(b), false);
    double size = 0.0;
    for (int i = 0; i < problem.simulated; ++i) {
      const double applied = seen.applied[problem.axes[static_cast<std::size_t>(i)]];
      if (applied > 0.0) size += std::pow(acceleration(i, 0) / applied, 2);
    }
    Eigen::Index at = 0;
    for (const Group& group : groups) {
      if (group.empty()) table.by(at++, b) = std::sqrt(size);
      for (const Feature& column : group) table.by(at++, b) = column.value(state);
    }
    plant.end_block(block, reference.nu_end.col(b));
  }
  return table;
}

/// About their means and over their spreads, both as the name's force weighs them: what is left is no change of its
/// strength as a whole.
void standardise(std::vector<Table>& tables) {
  const Eigen::Index columns = tables.front().by.rows();
  double weight = 0.0;
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(columns), square = sum;
  for (const Table& table : tables) {
    const Eigen::VectorXd weights = table.acceleration.colwise().squaredNorm();
    weight += weights.sum();
    sum += table.by * weights;
    square += table.by.cwiseAbs2() * weights;
  }
  if (!(weight > 0.0)) return;
  const Eigen::VectorXd mean = sum / weight, spread = (square / weight - mean.cwiseAbs2()).cwiseMax(0.0).cwiseSqrt();
  for (Table& table : tables) {
    for (Eigen::Index j = 0; j < columns; ++j) {
      const double over = spread[j] > 1e-9 * (1.0 + std::abs(mean[j])) ? 1.0 / spread[j] : 0.0;
      table.by.row(j) = over * (table.by.row(j).array() - mean[j]).matrix();
    }
  }
}

}  // namespace

Modulation modulation_of(const likelihood::Problem& problem, const Seen& seen, const model::Scene& scene,
                         std::size_t effect, const Thresholds& thresholds) {
  if (likelihood::stage_of(seen.fit.hypothesis.model.effects[effect]) == likelihood::Stage::kSensor) return {};
  const std::vector<Group> groups = groups_of(problem, scene);
  std::vector<ColumnRange> ranges;
  std::size_t columns = 0;
  for (const Group& group : groups) {
    const std::size_t count = std::max<std::size_t>(group.size(), 1);
    ranges.emplace_back(static_cast<Eigen::Index>(columns), static_cast<Eigen::Index>(count));
    columns += count;
  }
  std::vector<Table> tables;
  for (std::size_t r = 0; r < problem.runs.size(); ++r)
    tables.push_back(table_of(problem, seen, effect, groups, columns, r));
  standardise(tables);
  likelihood::ResponseSums sums;
  for (std::size_t r = 0; r < problem.runs.size(); ++r) {
    likelihood::respond(
        problem, seen.reference[r], r, columns, {},
        [&](std::size_t block, likelihood::ColumnsOut acceleration, likelihood::ColumnsOut) {
          const auto b = static_cast<Eigen::Index>(block);
          acceleration.noalias() = tables[r].acceleration.col(b) * tables[r].by.col(b).transpose();
        },
        sums);
  }
  const auto [gram, gradient] = project(seen, sums);
  Modulation most;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const GroupEvidence evidence = group_evidence(gram, gradient, std::span{&ranges[g], 1}, {kStartDepth});
    const double nats =
        evidence.log_bayes_factor - thresholds.group_price - std::log(static_cast<double>(groups.size()));
    if (!(nats > 0.0)) continue;
    const double depth = evidence.weight.norm();
    if (depth > most.depth) most = {nats, depth};
  }
  return most;
}

}  // namespace fathom::inference
