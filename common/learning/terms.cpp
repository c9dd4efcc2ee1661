#include "common/learning/terms.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/inference/feature_library.hpp"
#include "common/inference/thruster_laws.hpp"
#include "common/learning/pulls.hpp"

namespace fathom::learning {
namespace {

using likelihood::Factor;
using likelihood::Quantity;

// Sizes, of twice the rms, where a bend of a thrust curve begins to be sought: a step is seen from close by only.
constexpr int kBends = 15;
constexpr double kSmallestBend = 0.03, kBendRatio = 1.33;
constexpr const char* kWorldNames[3] = {"north", "east", "down"};

Factor v(int axis) { return {.quantity = Quantity::kVelocity, .index = axis}; }
Factor s(int axis) { return {.quantity = Quantity::kSpeed, .index = axis}; }
Factor tau(int axis) { return {.quantity = Quantity::kWrench, .index = axis}; }
Factor size(int axis) { return {.quantity = Quantity::kWrenchSize, .index = axis}; }
Factor f(int thruster) { return {.quantity = Quantity::kThruster, .index = thruster}; }
Factor f_size(int thruster) { return {.quantity = Quantity::kThrusterSize, .index = thruster}; }

/// A force, by how much its actuator has done lately, and by the square of it: nothing weakens without an end.
Columns worn(const Factor& force) {
  Columns worn;
  for (int bank = 0; bank < static_cast<int>(likelihood::kUseMemories.size()); ++bank) {
    const Factor use{.quantity = Quantity::kRecentUse, .index = force.index, .bank = bank};
    worn.push_back({force, use});
    worn.push_back({force, use, use});
  }
  return worn;
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
    if (scene.attitude && scene.position && std::ranges::find(axes_, 0) != axes_.end()) pulls(Room{problem});
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
  void pulls(const Room& room) {
    for (const Factor& stretch : stretches_of(room))
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
    all.push_back({"the hull's drag against translation", model::kGoingDrag, {{}}, kDragTerm | kGoingTerm, true});
    if (std::ranges::any_of(axes_, [](int axis) { return axis < 3; })) {
      const Columns speed{{{.quantity = Quantity::kFlowSpeed}}};  // the base's own terms hold it without
      all.push_back({"drag against the way", model::kAgainstWay, {{}}, kDragTerm | kGoingTerm, true});
      all.push_back({"drag against the way, of the speed", model::kAgainstWay, speed, kDragTerm | kGoingTerm});
    }
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
      all.push_back({name + ", by what it has done lately", axis, worn(f(j))});
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
    for (const Quantity quantity : {Quantity::kThrustHeld, Quantity::kThrustBelow}) {
      for (int k = 0; k < kBends; ++k) {
        Factor bend = own(quantity);
        bend.a = kSmallestBend * std::pow(kBendRatio, k) * of.knots.front().a;
        all.push_back({.words = "a thrust curve of " + of.words +
                                (quantity == Quantity::kThrustHeld ? ", up to a size" : ", below a size"),
                       .axis = of.axis,
                       .columns = {{bend}},
                       .searched = true});
      }
    }
    const auto law = [&](const char* words, Columns columns) {
      all.push_back({of.words + ", by " + words, of.axis, std::move(columns)});
    };
    if (of.axis == model::kEachThruster) law("what each has done lately", worn(own(Quantity::kThruster)));
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

}  // namespace fathom::learning
