#include "common/learning/terms.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/inference/feature_library.hpp"
#include "common/inference/thruster_laws.hpp"
#include "common/learning/edges.hpp"
#include "common/learning/pulls.hpp"

namespace fathom::learning {
namespace {

using likelihood::Factor;
using likelihood::Quantity;

constexpr int kDepthBumps = 6, kPlanBumps = 3, kTimeSteps = 12, kFewSteps = 4;
constexpr std::array kEdgeReaches{1.0 / 30, 1.0 / 12, 1.0 / 5};  // of the width of where it was
constexpr double kSmallestRange = 0.05;                          // m
constexpr double kMoves = 1e-3;                                  // m/s, rad/s: an axis that does less shows nothing
constexpr const char* kWorldNames[3] = {"north", "east", "down"};

Factor v(int axis) { return {.quantity = Quantity::kVelocity, .index = axis}; }
Factor s(int axis) { return {.quantity = Quantity::kSpeed, .index = axis}; }
Factor tau(int axis) { return {.quantity = Quantity::kWrench, .index = axis}; }
Factor size(int axis) { return {.quantity = Quantity::kWrenchSize, .index = axis}; }
Factor f(int thruster) { return {.quantity = Quantity::kThruster, .index = thruster}; }
Factor f_size(int thruster) { return {.quantity = Quantity::kThrusterSize, .index = thruster}; }
Factor of(Quantity quantity, int index, double a, double b) {
  return {.quantity = quantity, .index = index, .a = a, .b = b};
}

/// How much an actuator has done lately.
std::vector<Factor> uses(int thruster) {
  std::vector<Factor> uses;
  for (int bank = 0; bank < static_cast<int>(likelihood::kUseMemories.size()); ++bank)
    uses.push_back({.quantity = Quantity::kRecentUse, .index = thruster, .bank = bank});
  return uses;
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

/// Measured columns, about their means and over their spreads, as modulators.
void of_columns(const likelihood::Problem& problem, std::vector<Modulator>& all) {
  constexpr double kConstant = 1e-6;  // of its mean
  const std::size_t count = problem.vehicle->candidates.size();
  for (std::size_t place = 0; place < count; ++place) {
    const auto at = static_cast<Eigen::Index>(2 * place);
    double sum = 0.0, square = 0.0, samples = 0.0, most = 0.0;
    const auto each = [&](const auto& use) {
      for (const likelihood::RunData& run : problem.runs) {
        for (const Eigen::VectorXd& columns : run.trial().columns) use(columns[at]);
      }
    };
    each([&](double x) { sum += x, samples += 1.0; });
    if (samples == 0.0) continue;
    const double mean = sum / samples;
    each([&](double x) { square += (x - mean) * (x - mean), most = std::max(most, std::abs(x - mean)); });
    const double spread = std::sqrt(square / samples);
    if (spread <= kConstant * std::abs(mean)) continue;
    const std::string& name = problem.vehicle->candidates[place].text;
    all.push_back({", by " + name,
                   {{{.quantity = Quantity::kColumn,
                      .index = static_cast<int>(place),
                      .a = mean,
                      .b = spread,
                      .c = most,
                      .column = name}}},
                   kConstantTerm | kStreamTerm | kDragTerm | kThrustTerm | kThrusterTerm});
  }
}

class Terms {
 public:
  Terms(const likelihood::Problem& problem, const inference::Seen& seen, const model::Scene& scene)
      : scene_{scene}, numbers_{seen.fit.numbers} {
    for (int i = 0; i < problem.simulated; ++i) axes_.push_back(problem.axes[static_cast<std::size_t>(i)]);
    if (!scene.input_is_wrench) thrusters_ = static_cast<int>(seen.fit.hypothesis.model.allocation.cols());
    for (const int axis : axes_) along(axis, seen.fit.hypothesis.model.allocation);
    if (scene.attitude) world();
    if (scene.attitude) levers();
    if (scene.attitude && scene.position && std::ranges::find(axes_, 0) != axes_.end()) pulls();
    together();
    if (std::ranges::any_of(axes_, [](int axis) { return axis < 3; }))
      all.push_back({"mass", model::kMass, {{}}, kMassTerm, true});
    for (const inference::ThrusterLaw& law : inference::thruster_laws(problem, seen, scene)) along_lines(law);
  }
  std::vector<Term> all;

 private:
  void plain(const char* words, int axis, std::vector<Factor> factors) {
    all.push_back({words, axis, {std::move(factors)}});
  }
  [[nodiscard]] bool moves(int axis) const { return scene_.nu_rms[axis] > kMoves; }

  void along(int axis, const model::Allocation& allocation) {
    all.push_back({"a force", axis, {{}}, kConstantTerm});
    all.push_back({"drag", axis, {{v(axis)}, {s(axis), v(axis)}}, kDragTerm, true});
    all.push_back({"thrust", axis, {{tau(axis)}}, kThrustTerm, true});
    plain("velocity", axis, {v(axis), v(axis)});
    plain("velocity", axis, {v(axis), v(axis), v(axis)});
    for (int j = 0; j < 6; ++j) {
      if (!moves(j)) continue;
      if (j != axis) {
        plain("velocity", axis, {v(j)});
        plain("velocity", axis, {s(j), v(j)});
        plain("velocity", axis, {s(j), v(axis)});
        plain("velocity", axis, {v(j), v(j)});
      }
      for (int k = j + 1; k < 6; ++k) {
        if (!moves(k)) continue;
        plain("velocity", axis, {v(j), v(k)});
        if (j != axis && k != axis) plain("velocity", axis, {s(j), v(k)});
        if (j != axis && k != axis) plain("velocity", axis, {v(j), s(k)});
      }
    }
    plain("thrust", axis, {size(axis)});
    plain("thrust", axis, {size(axis), tau(axis)});
    for (const int j : axes_) {
      if (j != axis) plain("thrust of another axis", axis, {tau(j)});
      if (j != axis) plain("thrust of another axis", axis, {size(j)});
    }
    Columns others;
    for (int j = 0; j < thrusters_; ++j) {
      if (std::abs(allocation(axis, j)) > 1e-9) continue;  // acts there as it is
      others.push_back({f(j)});
      others.push_back({f_size(j)});
    }
    for (const std::vector<Factor>& one : others) plain("a thruster off its line", axis, one);
    Columns slow_velocity, slow_thrust;
    for (int bank = 0; bank < static_cast<int>(likelihood::kVelocityMemories.size()); ++bank)
      slow_velocity.push_back({{.quantity = Quantity::kSlowVelocity, .index = axis, .bank = bank}});
    for (int bank = 0; bank < static_cast<int>(likelihood::kThrustMemories.size()); ++bank)
      slow_thrust.push_back({{.quantity = Quantity::kSlowWrench, .index = axis, .bank = bank}});
    all.push_back({.words = "velocity a moment ago", .axis = axis, .columns = slow_velocity, .closed = false});
    all.push_back({.words = "thrust a moment ago", .axis = axis, .columns = slow_thrust, .closed = false});
  }

  /// A force, and a stream past the hull.
  void world() {
    for (int w = 0; w < 3; ++w) {
      if (std::ranges::find(axes_, w) == axes_.end()) continue;
      const std::string name = kWorldNames[w];
      const int axis = likelihood::kWorldAxis + w;
      if (w < 2) all.push_back({"a stream toward " + name, model::kStream + w, {{}}, kStreamTerm});
      // Along the vertical the base number of weight holds the force.
      all.push_back({"a force toward " + name, axis, {{}}, kConstantTerm | kWorldTerm, w == 2});
    }
  }

  /// Lines that end somewhere.
  void pulls() {
    for (const Factor& stretch : stretches_of(scene_))
      all.push_back({.words = "a pull toward a point", .axis = model::kPull, .columns = {{stretch}}, .searched = true});
  }

  /// Weight and buoyancy that do not act at one point.
  void levers() {
    for (const int i : inference::levers_that_turn(axes_)) {
      all.push_back({std::string("a lever between weight and buoyancy in ") + "xyz"[i],
                     model::kLever + i,
                     {{}},
                     kConstantTerm,
                     inference::base_has_lever(numbers_, i)});
    }
  }

  /// All of the drag, all of the thrust, each thruster along its line.
  void together() {
    all.push_back({"the hull's drag", model::kHullDrag, {{}}, kDragTerm, true});
    all.push_back({"the whole thrust", model::kAllThrust, {{}}, kThrustTerm | kWholeTerm, true});
    Columns slow;
    for (int bank = 0; bank < static_cast<int>(likelihood::kThrustMemories.size()); ++bank)
      slow.push_back({{.quantity = Quantity::kSlowWrench, .bank = bank}});
    all.push_back(
        {.words = "thrust a moment ago, along each axis", .axis = model::kEachAxis, .columns = slow, .closed = false});
    for (int j = 0; j < thrusters_; ++j) {
      const std::string name = "thruster " + std::to_string(j + 1);
      const int axis = model::kThrusterLine + j;
      all.push_back({name, axis, {{f(j)}}, kThrusterTerm});
      Columns worn;
      for (const Factor& use : uses(j)) worn.push_back({f(j), use});
      all.push_back({name + ", by what it has done lately", axis, worn});
      all.push_back({name + ", by its size", axis, {{f_size(j)}, {f_size(j), f(j)}}});
      for (int k = 0; k < thrusters_; ++k) {
        if (k != j)
          all.push_back(
              {name + ", by thruster " + std::to_string(k + 1), axis, {{f_size(j), f(k)}, {f_size(j), f_size(k)}}});
      }
    }
  }

  /// What propellers do by their own force and advance.
  void along_lines(const inference::ThrusterLaw& of) {
    const auto own = [&](Quantity quantity) { return Factor{.quantity = quantity, .index = of.index}; };
    Columns curve;
    for (const Factor& knot : of.knots) curve.push_back({knot});
    all.push_back({.words = "a thrust curve of " + of.words, .axis = of.axis, .columns = curve, .closed = false});
    const auto law = [&](const char* words, Columns columns) {
      all.push_back({of.words + ", by " + words, of.axis, std::move(columns)});
    };
    Columns worn;
    for (const Factor& use : uses(of.index)) worn.push_back({own(Quantity::kThruster), use});
    if (of.axis == model::kEachThruster) law("what each has done lately", worn);
    law("the size of the force", {{own(Quantity::kThrusterSize)}});
    law("the root of the force", {{own(Quantity::kThrusterRoot)}});
    const char* advance = "the speed of advance";
    law(advance, {{own(Quantity::kThrusterRoot), own(Quantity::kAdvance)}});
    law(advance, {{own(Quantity::kThrusterSize), own(Quantity::kAdvance)}});
    law(advance, {{own(Quantity::kThruster), own(Quantity::kAdvanceSize)}});
    law(advance, {{own(Quantity::kAdvanceSize), own(Quantity::kAdvance)}});
  }

  const model::Scene& scene_;
  const std::vector<likelihood::Number>& numbers_;
  std::vector<int> axes_;
  int thrusters_{};
};

}  // namespace

std::vector<Term> terms_of(const likelihood::Problem& problem, const inference::Seen& seen, const model::Scene& scene) {
  return std::move(Terms{problem, seen, scene}.all);
}

std::vector<Modulator> modulators_of(const likelihood::Problem& problem, const model::Scene& scene) {
  std::vector<Modulator> all;
  const unsigned still = kConstantTerm | kStreamTerm, base = kDragTerm | kThrustTerm;
  const double half = std::max(0.5 * (problem.t_high - problem.t_low), 1.0);
  const Factor ramp = of(Quantity::kRamp, 0, 0.5 * (problem.t_low + problem.t_high), half);
  all.push_back({", growing with time", {{ramp}}, still | base | kThrusterTerm | kMassTerm});
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
    all.push_back({", at places", bumps_over_plan(scene), kConstantTerm, false});
  }
  if (scene.attitude) {
    for (const Edge& edge : edges_of(scene)) {
      Columns reaches;
      for (const double share : kEdgeReaches) reaches.push_back({near(edge, share * edge.width)});
      all.push_back({", near " + edge.words, reaches, kWorldTerm | kDragTerm | kWholeTerm, false});
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
  for (int i = 0; i < problem.simulated; ++i) {
    const int j = problem.axes[static_cast<std::size_t>(i)];
    const std::string name = std::string{"tau_"} + model::kAxisNames[static_cast<std::size_t>(j)];
    all.push_back({", by |" + name + "|", {{size(j)}}, base});
  }
  return all;
}

}  // namespace fathom::learning
