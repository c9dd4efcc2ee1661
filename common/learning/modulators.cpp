// What a term may go with: the clock, depth and place, edges of where it was, heading, speeds, thrusts, measured
// columns.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "common/learning/edges.hpp"
#include "common/learning/pulls.hpp"
#include "common/learning/terms.hpp"

namespace fathom::learning {
namespace {

using likelihood::Factor;
using likelihood::Quantity;

constexpr int kDepthBumps = 6, kPlanBumps = 3, kTimeSteps = 12, kFewSteps = 4;
constexpr std::array kEdgeReaches{1.0 / 30, 1.0 / 12, 1.0 / 5};  // of the width of where it was
constexpr std::array kSettles{0.2, 0.7};                         // of the recordings: time constants to begin from
constexpr double kSmallestRange = 0.05;                          // m

Factor v(int axis) { return {.quantity = Quantity::kVelocity, .index = axis}; }
Factor s(int axis) { return {.quantity = Quantity::kSpeed, .index = axis}; }
Factor size(int axis) { return {.quantity = Quantity::kWrenchSize, .index = axis}; }
Factor of(Quantity quantity, int index, double a, double b) {
  return {.quantity = quantity, .index = index, .a = a, .b = b};
}

Columns steps_in_time(const likelihood::Problem& problem, int count) {
  Columns steps;
  const double length = problem.t_high - problem.t_low;
  for (int i = 0; i < count; ++i)
    steps.push_back({of(Quantity::kAfter, 0, problem.t_low + length * (i + 0.5) / count, length / count)});
  return steps;
}

Columns bumps_over_plan(const model::Scene& scene) {
  Columns bumps;
  const Eigen::Vector3d range = scene.p_high - scene.p_low;
  const double width = std::max(range.head<2>().maxCoeff() / (kPlanBumps - 1), kSmallestRange);
  for (int i = 0; i < kPlanBumps; ++i) {
    for (int j = 0; j < kPlanBumps; ++j)
      bumps.push_back({{.quantity = Quantity::kPlanBump,
                        .a = scene.p_low.x() + range.x() * i / (kPlanBumps - 1),
                        .b = scene.p_low.y() + range.y() * j / (kPlanBumps - 1),
                        .c = width}});
  }
  return bumps;
}

/// What a measured number does over all recordings: its mean, its root mean square off it, and the most.
struct Wander {
  double mean{}, spread{}, most{};
};
/// `each` hands every sample to what it is given; none: nothing was measured.
template <typename Each>
std::optional<Wander> wander_of(const Each& each) {
  double sum = 0.0, square = 0.0, samples = 0.0;
  each([&](double x) { sum += x, samples += 1.0; });
  if (samples == 0.0) return std::nullopt;
  Wander wander{.mean = sum / samples};
  each([&](double x) {
    square += (x - wander.mean) * (x - wander.mean);
    wander.most = std::max(wander.most, std::abs(x - wander.mean));
  });
  wander.spread = std::sqrt(square / samples);
  return wander;
}

/// Measured columns, about their means and over their spreads, as modulators.
void of_columns(const likelihood::Problem& problem, std::vector<Modulator>& all) {
  constexpr double kConstant = 1e-6;  // of its mean
  const std::size_t count = problem.vehicle->candidates.size();
  for (std::size_t place = 0; place < count; ++place) {
    const auto at = static_cast<Eigen::Index>(2 * place);
    const auto wander = wander_of([&](const auto& use) {
      for (const likelihood::RunData& run : problem.runs) {
        for (const Eigen::VectorXd& columns : run.trial().columns) use(columns[at]);
      }
    });
    if (!wander || wander->spread <= kConstant * std::abs(wander->mean)) continue;
    const std::string& name = problem.vehicle->candidates[place].text;
    all.push_back({", by " + name,
                   {{{.quantity = Quantity::kColumn,
                      .index = static_cast<int>(place),
                      .a = wander->mean,
                      .b = wander->spread,
                      .c = wander->most,
                      .column = name}}},
                   kConstantTerm | kStreamTerm | kDragTerm | kThrustTerm | kThrusterTerm});
  }
}

/// The supply's voltage, where it was logged and changes: thrust goes with a power of it.
void of_voltage(const likelihood::Problem& problem, std::vector<Modulator>& all) {
  constexpr double kSteady = 2e-3;  // of its mean: what the last digit of a log wanders
  const auto wander = wander_of([&](const auto& use) {
    for (const likelihood::RunData& run : problem.runs) {
      for (const double voltage : run.trial().voltage) {
        if (voltage > 0.0) use(voltage);
      }
    }
  });
  if (!wander || wander->spread < kSteady * wander->mean) return;
  const Factor voltage{.quantity = Quantity::kVoltage,
                       .a = wander->mean,
                       .b = wander->spread / wander->mean,
                       .c = wander->most / wander->mean};
  all.push_back({", by the voltage", {{voltage}, {voltage, voltage}}, kThrustTerm | kThrusterTerm});
}

}  // namespace

std::vector<Modulator> modulators_of(const likelihood::Problem& problem, const model::Scene& scene) {
  std::vector<Modulator> all;
  const unsigned still = kConstantTerm | kStreamTerm, base = kDragTerm | kThrustTerm;
  const double half = std::max(0.5 * (problem.t_high - problem.t_low), 1.0);
  const Factor ramp = of(Quantity::kRamp, 0, 0.5 * (problem.t_low + problem.t_high), half);
  all.push_back({", growing with time", {{ramp}}, still | base | kThrusterTerm | kMassTerm});
  for (const double share : kSettles) {
    Factor settling = of(Quantity::kSettling, 0, problem.t_low, share * (problem.t_high - problem.t_low));
    settling.c = problem.t_low + model::kLawReach * (problem.t_high - problem.t_low);
    all.push_back({.words = ", growing with time, ever more slowly",
                   .columns = {{settling}},
                   .of = still | base | kThrusterTerm | kMassTerm,
                   .searched = true});
  }
  all.push_back({", changing with time", steps_in_time(problem, kTimeSteps), kConstantTerm, false, true});
  all.push_back(
      {", changing with time", steps_in_time(problem, kFewSteps), kStreamTerm | base | kThrusterTerm, false, true});
  const Eigen::Vector3d middle = 0.5 * (scene.p_low + scene.p_high), room = 0.5 * (scene.p_high - scene.p_low);
  const Factor depth = of(Quantity::kDepth, 0, middle.z(), room.z());
  const bool dives = scene.position && 2.0 * room.z() > kSmallestRange;
  if (dives) {
    all.push_back({", by depth", {{depth}, {depth, depth}}, still | base});
    Columns bumps;
    for (int i = 0; i < kDepthBumps; ++i)
      bumps.push_back({of(Quantity::kDepthBump, 0, scene.p_low.z() + 2.0 * room.z() * i / (kDepthBumps - 1),
                          2.0 * room.z() / (kDepthBumps - 1))});
    all.push_back({", at depths", bumps, kConstantTerm, false});
  }
  if (scene.position && room.head<2>().minCoeff() > 0.5 * kSmallestRange) {
    const Factor north = of(Quantity::kNorth, 0, middle.x(), room.x()),
                 east = of(Quantity::kEast, 0, middle.y(), room.y());
    all.push_back({", by place", {{north}, {east}}, still | base});
    const Columns bumps = bumps_over_plan(scene);
    all.push_back({", at places", bumps, kConstantTerm, false});
    const auto sought = [&](const char* words, const std::vector<Factor>& factors, unsigned of) {
      all.push_back({.words = words, .columns = {factors}, .of = of, .searched = true});
    };
    for (const std::vector<Factor>& bump : bumps) sought(", about a place", bump, kWorldTerm);
    const Room where{problem};
    for (const Factor& distance : distances_of(where))
      sought(", by the distance to a point", {distance}, kWorldTerm | kGoingTerm);
    for (const Factor& distance : plan_distances_of(where))
      sought(", by the distance in the plan", {distance}, kWorldTerm | kGoingTerm);
  }
  if (scene.attitude) {
    for (const Edge& edge : edges_of(scene)) {
      for (const double share : kEdgeReaches)
        all.push_back(
            {", near " + edge.words, {{near(edge, share * edge.width)}}, kWorldTerm | kDragTerm | kWholeTerm});
    }
    for (int n = 1; n <= 2; ++n) {
      const Factor cosine = of(Quantity::kHeadingCosine, n, 0.0, 1.0), sine = of(Quantity::kHeadingSine, n, 0.0, 1.0);
      all.push_back({n == 1 ? ", by heading" : ", by twice the heading",
                     {{cosine}, {sine}},
                     n == 1 ? kConstantTerm | base : kConstantTerm});
      if (dives && n == 1) all.push_back({", by heading and depth", {{cosine, depth}, {sine, depth}}, kConstantTerm});
    }
  }
  all.push_back({", by the speed", {{{.quantity = Quantity::kFlowSpeed}}}, base | kThrusterTerm});
  for (int j = 0; j < 6; ++j) {
    if (scene.nu_rms[j] <= kMoves) continue;
    const std::string name = model::kVelocityNames[static_cast<std::size_t>(j)];
    all.push_back({", by " + name, {{v(j)}}, kThrustTerm});
    all.push_back({", by |" + name + "|", {{s(j)}}, kThrustTerm | (j < 3 ? kThrusterTerm : 0U)});
  }
  of_columns(problem, all);
  of_voltage(problem, all);
  for (int i = 0; i < problem.simulated; ++i) {
    const int j = problem.axes[static_cast<std::size_t>(i)];
    const std::string name = std::string{"tau_"} + model::kAxisNames[static_cast<std::size_t>(j)];
    all.push_back({", by |" + name + "|", {{size(j)}}, base});
  }
  return all;
}

}  // namespace fathom::learning
