#include "common/inference/feature_library.hpp"

#include <algorithm>
#include <cmath>

#include "common/inference/thruster_laws.hpp"
#include "common/inference/tones.hpp"

namespace fathom::inference {
namespace {

using likelihood::Factor;
using likelihood::Feature;
using likelihood::kWorldAxis;
using likelihood::Quantity;

constexpr int kDepthBumps = 6, kPlanBumps = 3, kTimeSteps = 12, kThrustSteps = 4;
constexpr double kMomentLasts = 0.3;     // s
constexpr double kSmallestRange = 0.05;  // m
constexpr double kLowestTone = 0.2;      // rad/s
constexpr const char* kWorldNames[3] = {"north", "east", "down"};

class Library {
 public:
  Library(const likelihood::Problem& problem, const Seen& seen, const model::Scene& scene)
      : problem_{problem}, seen_{seen}, scene_{scene} {
    for (int i = 0; i < problem.simulated; ++i) axes_.push_back(problem.axes[static_cast<std::size_t>(i)]);
    for (std::size_t r = 0; r < problem.runs.size(); ++r) adjoint_.push_back(adjoint(problem, seen.reference[r], r));
  }

  likelihood::FreeForce make() {
    for (const int axis : axes_) {
      velocity(axis);
      place(axis);
      thrust(axis);
      time(axis);
    }
    if (scene_.attitude) world();
    together();
    scale();
    force_.weights.assign(force_.features.size(), 0.0);
    return std::move(force_);
  }

 private:
  void begin(const std::string& kind, int axis, bool searched = false) {
    force_.groups.push_back(
        {.kind = kind, .axis = axis, .first = static_cast<int>(force_.features.size()), .searched = searched});
  }
  void add(std::initializer_list<Factor> factors) {
    Feature feature{.axis = force_.groups.back().axis, .count = static_cast<int>(factors.size())};
    std::ranges::copy(factors, feature.factors.begin());
    force_.features.push_back(feature);
    ++force_.groups.back().count;
  }
  static Factor v(int axis) { return {.quantity = Quantity::kVelocity, .index = axis}; }
  static Factor s(int axis) { return {.quantity = Quantity::kSpeed, .index = axis}; }
  static Factor tau(int axis) { return {.quantity = Quantity::kWrench, .index = axis}; }
  static Factor size(int axis) { return {.quantity = Quantity::kWrenchSize, .index = axis}; }

  void velocity(int axis) {
    begin("velocity", axis);
    add({v(axis), v(axis)});
    add({v(axis), v(axis), v(axis)});
    for (int j = 0; j < 6; ++j) {
      if (scene_.nu_rms[j] <= 1e-3) continue;
      if (j != axis) {
        add({v(j)});
        add({s(j), v(j)});
        add({s(j), v(axis)});
      }
      for (int k = j + 1; k < 6; ++k) {
        if (scene_.nu_rms[k] > 1e-3) add({v(j), v(k)});
      }
    }
    begin("velocity a moment ago", axis);
    for (int bank = 0; bank < static_cast<int>(likelihood::kVelocityMemories.size()); ++bank)
      add({{.quantity = Quantity::kSlowVelocity, .index = axis, .bank = bank}});
  }

  void place(int axis) {
    if (!scene_.position || axis > 2) return;
    const double low = scene_.p_low.z(), range = scene_.p_high.z() - low;
    if (range > kSmallestRange) {
      begin("depth", axis);
      const double width = range / (kDepthBumps - 1);
      for (int i = 0; i < kDepthBumps; ++i) {
        const Factor bump{.quantity = Quantity::kDepthBump, .a = low + i * width, .b = width};
        add({bump});
        if (i % 2 == 1) add({bump, s(axis), v(axis)});
        if (i % 2 == 1) add({bump, v(axis)});
      }
    }
    if (axis == 2) return;
    begin("drag that changes with place", axis);
    each_plan_bump([&](const Factor& bump) { add({bump, v(axis)}); });
  }

  template <typename Use>
  void each_plan_bump(const Use& use) {
    const Eigen::Vector3d range = scene_.p_high - scene_.p_low;
    const double width = std::max(range.head<2>().maxCoeff() / (kPlanBumps - 1), kSmallestRange);
    for (int i = 0; i < kPlanBumps; ++i) {
      for (int j = 0; j < kPlanBumps; ++j)
        use({.quantity = Quantity::kPlanBump,
             .a = scene_.p_low.x() + range.x() * i / (kPlanBumps - 1),
             .b = scene_.p_low.y() + range.y() * j / (kPlanBumps - 1),
             .c = width});
    }
  }

  void thrust(int axis) {
    begin("thrust", axis);
    add({size(axis)});
    add({size(axis), tau(axis)});
    for (const int j : axes_) {
      if (j != axis) add({tau(j)});
      if (j != axis) add({size(j)});
    }
    const Eigen::Index thrusters = seen_.fit.hypothesis.model.allocation.cols();
    if (!scene_.input_is_wrench) {
      for (int j = 0; j < thrusters; ++j) {
        add({{.quantity = Quantity::kThruster, .index = j}});
        add({{.quantity = Quantity::kThrusterSize, .index = j}});
        add({{.quantity = Quantity::kThrusterSize, .index = j}, {.quantity = Quantity::kThruster, .index = j}});
      }
    }
    begin("thrust with speed", axis);
    for (const int j : axes_) add({size(axis), v(j)});
    begin("thrust a moment ago", axis);
    for (int bank = 0; bank < static_cast<int>(likelihood::kThrustMemories.size()); ++bank)
      add({{.quantity = Quantity::kSlowWrench, .index = axis, .bank = bank}});
    begin("thrust that changes with time", axis);
    steps(kThrustSteps, [&](const Factor& step) {
      add({step, tau(axis)});
      if (scene_.input_is_wrench) return;
      for (int j = 0; j < thrusters; ++j) {
        if (seen_.fit.hypothesis.model.allocation.col(j).cwiseAbs()[axis] > 1e-9)
          add({step, {.quantity = Quantity::kThruster, .index = j}});
      }
    });
  }

  /// Levers of weight and buoyancy, and laws that all thrusters share: one number each instead of one per thruster.
  void together() {
    if (scene_.attitude) {
      for (const int i : levers_that_turn(axes_)) {
        if (base_has_lever(seen_.fit.numbers, i)) continue;
        begin(std::string("a lever between weight and buoyancy in ") + "xyz"[i], model::kLever + i);
        add({});
      }
    }
    for (const ThrusterLaw& law : thruster_laws(problem_, seen_, scene_)) {
      const auto own = [&](Quantity quantity) { return Factor{.quantity = quantity, .index = law.index}; };
      begin("a thrust curve of " + law.words, law.axis);
      for (const Factor& knot : law.knots) add({knot});
      add({own(Quantity::kThrusterSize)});
      begin("the advance of " + law.words, law.axis);
      add({own(Quantity::kThrusterRoot), own(Quantity::kAdvance)});
      add({own(Quantity::kThrusterSize), own(Quantity::kAdvance)});
      add({own(Quantity::kThruster), own(Quantity::kAdvanceSize)});
    }
  }

  template <typename Use>
  void steps(int count, const Use& use) {
    const double length = problem_.t_high - problem_.t_low;
    for (int i = 0; i < count; ++i)
      use({.quantity = Quantity::kAfter, .a = problem_.t_low + length * (i + 0.5) / count, .b = length / count});
  }

  void time(int axis) {
    begin("time", axis);
    steps(kTimeSteps, [&](const Factor& step) { add({step}); });
    begin("heading", axis);
    if (!scene_.attitude) {
      force_.groups.pop_back();
    } else {
      for (int n = 1; n <= 2; ++n) {
        for (const Quantity q : {Quantity::kHeadingCosine, Quantity::kHeadingSine}) {
          const Factor turn{.quantity = q, .index = n};
          add({turn});
          for (int j = 0; j < 2; ++j) add({turn, v(j)});
        }
      }
    }
    // The two times at which the likelihood's slope, summed from there on, is largest either way.
    begin("a moment", axis, true);
    const auto [up, down] = sharpest(axis);
    for (const double t : {up, down}) {
      const Factor step{.quantity = Quantity::kAfter, .a = t, .b = kMomentLasts};
      add({step});
      add({step, tau(axis)});
    }
  }

  std::pair<double, double> sharpest(int axis) const {
    const auto place = static_cast<Eigen::Index>(std::ranges::find(problem_.axes, axis) - problem_.axes.begin());
    double sum = 0.0, most = -1e300, least = 1e300;
    std::pair<double, double> at{problem_.t_low, problem_.t_high};
    for (std::size_t r = 0; r < adjoint_.size(); ++r) {
      const auto& blocks = problem_.runs[r].blocks();
      for (std::size_t b = blocks.size(); b-- > 0;) {
        sum += adjoint_[r](place, static_cast<Eigen::Index>(b));
        const double t = problem_.runs[r].trial().t[blocks[b].first];
        if (sum > most) most = sum, at.first = t;
        if (sum < least) least = sum, at.second = t;
      }
    }
    return at;
  }

  void world() {
    for (int w = 0; w < 3; ++w) {
      if (w < 2 && std::ranges::find(axes_, w) == axes_.end()) continue;
      if (w == 2 && std::ranges::find(axes_, 2) == axes_.end()) continue;
      if (scene_.position) {
        begin(std::string("place, toward ") + kWorldNames[w], kWorldAxis + w);
        each_plan_bump([&](const Factor& bump) { add({bump}); });
      } else {
        begin(std::string("a steady force toward ") + kWorldNames[w], kWorldAxis + w);
        add({});
      }
      begin(std::string("oscillation toward ") + kWorldNames[w], kWorldAxis + w, true);
      force_.groups.back().closed = true;
      for (const double omega : strongest_tones(problem_, adjoint_, w, kLowestTone)) {
        add({{.quantity = Quantity::kToneCosine, .a = omega}});
        add({{.quantity = Quantity::kToneSine, .a = omega}});
      }
    }
  }

  /// Root mean square of each feature becomes that of the applied wrench of its axis.
  void scale() {
    std::vector<std::size_t> all(force_.groups.size());
    for (std::size_t g = 0; g < all.size(); ++g) all[g] = g;
    Eigen::VectorXd square = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(force_.features.size()));
    double count = 0.0, thrust = 0.0;
    const std::vector<likelihood::Number> none;
    for (std::size_t r = 0; r < problem_.runs.size(); ++r) {
      likelihood::Plant plant{seen_.fit.hypothesis, none, problem_.runs[r], r, false};
      plant.begin(problem_.runs[r].start());
      for (std::size_t b = 0; b < problem_.runs[r].blocks().size(); ++b) {
        const auto at = static_cast<Eigen::Index>(b);
        plant.at_middle(b);
        const likelihood::FeatureState state = plant.features_at(seen_.reference[r].nu_middle.col(at), false);
        for (std::size_t j = 0; j < force_.features.size(); ++j) {
          const double size = force_.features[j].size(state);
          square[static_cast<Eigen::Index>(j)] += size * size;
        }
        thrust += state.force.squaredNorm();
        count += 1.0;
        plant.end_block(b, seen_.reference[r].nu_end.col(at));
      }
    }
    for (std::size_t j = 0; j < force_.features.size(); ++j) {
      const int axis = force_.features[j].axis;
      double wrench = axis < kWorldAxis ? scene_.tau_rms[axis] : scene_.tau_rms.head<3>().norm() / std::sqrt(3.0);
      if (axis >= model::kLever) wrench = scene_.tau_rms.segment<2>(3).norm();
      if (axis == model::kEachThruster) wrench = std::sqrt(thrust / std::max(count, 1.0));
      const double rms = std::sqrt(square[static_cast<Eigen::Index>(j)] / std::max(count, 1.0));
      force_.features[j].scale = rms > 1e-12 ? std::max(wrench, 1e-6) / rms : 0.0;
    }
  }

  const likelihood::Problem& problem_;
  const Seen& seen_;
  const model::Scene& scene_;
  std::vector<int> axes_;
  std::vector<Eigen::MatrixXd> adjoint_;
  likelihood::FreeForce force_;
};

}  // namespace

bool base_has_lever(const std::vector<likelihood::Number>& numbers, int component) {
  const int place = static_cast<int>(model::index(model::BaseParameter::G_x)) + component;
  return std::ranges::any_of(numbers, [&](const likelihood::Number& number) {
    return number.kind == likelihood::NumberKind::kBase && number.index == place;
  });
}

std::vector<int> levers_that_turn(const std::vector<int>& axes) {
  const auto moves = [&](int axis) { return std::ranges::find(axes, axis) != axes.end(); };
  std::vector<int> levers;  // a level craft's weight turns it nowhere
  if (moves(4)) levers.push_back(0);
  if (moves(3)) levers.push_back(1);
  if (moves(3) || moves(4)) levers.push_back(2);
  return levers;
}

likelihood::FreeForce feature_library(const likelihood::Problem& problem, const Seen& seen, const model::Scene& scene) {
  return Library{problem, seen, scene}.make();
}

}  // namespace fathom::inference
