#include "common/model/learned/learned_force.hpp"

#include <algorithm>
#include <cmath>

#include "common/model/learned/factors/factor_kind.hpp"

namespace fathom::model {
namespace {

constexpr double kLeastVisited = 1e-6;
constexpr Eigen::Index kTaps = kThrustMemories.size(), kSlow = kVelocityMemories.size();
constexpr std::size_t kOfAxes = 6 * static_cast<std::size_t>(kTaps + kSlow);
constexpr int kPast = 40;         // instants at which what actuators have done is looked up
constexpr double kPastReach = 4;  // memories back

/// Behind the taps: per actuator and memory of its use.
Eigen::Map<Eigen::VectorXd> use_in(std::span<double> z, Eigen::Index actuators, std::size_t bank) {
  return {z.data() + kOfAxes + bank * static_cast<std::size_t>(actuators), actuators};
}

double clipped(double x, double visited) {
  const double most = kVisitedReach * std::max(visited, kLeastVisited);
  return std::clamp(x, -most, most);
}

void clip(Vector6d& x, const Vector6d& visited) {
  for (Eigen::Index i = 0; i < 6; ++i) x[i] = clipped(x[i], visited[i]);
}

/// Laws of all thrusters or axes, written out: each fades where its own thruster has not been.
FreeForce for_each_owner(const FreeForce& force, const Allocation& allocation) {
  const FeatureState state{.force = ActuatorForces::Zero(allocation.cols()), .allocation = &allocation};
  FreeForce all;
  for (const FeatureGroup& group : force.groups) {
    FeatureGroup out = group;
    out.first = static_cast<int>(all.features.size());
    for (int j = group.first; j < group.first + group.count; ++j) {
      const auto at = static_cast<std::size_t>(j);
      for (int own = 0; own < force.features[at].owners(state); ++own) {
        all.features.push_back(force.features[at].of_own(own));
        all.weights.push_back(force.weights[at]);
      }
    }
    out.count = static_cast<int>(all.features.size()) - out.first;
    all.groups.push_back(std::move(out));
  }
  return all;
}

}  // namespace

LearnedForm::LearnedForm(FreeForce force, Visited visited, Allocation allocation)
    : force_{for_each_owner(force, allocation)},
      visited_{std::move(visited)},
      believed_{visited_},
      allocation_{std::move(allocation)} {
  if (is_law(force)) {
    constexpr double kFarther = kLawReach / kVisitedReach;
    believed_.nu *= kFarther;
    believed_.tau *= kFarther;
    believed_.force *= kFarther;
  }
  for (const Feature& feature : force_.features) {
    part_.push_back(feature.streams()               ? Part::kStreams
                    : feature.weighs()              ? Part::kWeighs
                    : feature.remembers()           ? Part::kRemembers
                    : feature.moves_with_velocity() ? Part::kMoves
                                                    : Part::kStill);
    remembers_ = remembers_ || feature.remembers();
    streams_ = streams_ || feature.streams();
  }
}

FeatureState LearnedForm::state_of(const Motion& motion) const {
  FeatureState state{
      .t = motion.t, .p_WB = motion.p_WB, .R_WB = motion.R_WB, .nu = motion.nu_r(), .force = motion.force};
  const double across = std::hypot(motion.R_WB(0, 0), motion.R_WB(1, 0));
  state.heading_cosine = across > 0.0 ? motion.R_WB(0, 0) / across : 1.0;
  state.heading_sine = across > 0.0 ? motion.R_WB(1, 0) / across : 0.0;
  state.tau = allocation_ * motion.force;
  state.allocation = &allocation_;
  state.columns = motion.columns;
  state.voltage = motion.voltage;
  return state;
}

double LearnedForm::fade(const Feature& feature, const FeatureState& state, const Visited& visited) {
  double left = 1.0;
  for (int i = 0; i < feature.count; ++i) {
    const Factor& factor = feature.factors[static_cast<std::size_t>(i)];
    const FactorKind& kind = kind_of(factor.quantity);
    if (kind.within != nullptr) left *= kind.within(factor, state, visited);
  }
  return left;
}

bool LearnedForm::beyond(const Motion& motion) const {
  const FeatureState state = state_of(motion);
  return std::ranges::any_of(force_.features,
                             [&](const Feature& feature) { return fade(feature, state, visited_) < 1.0; });
}

FeatureState LearnedForm::inside(const FeatureState& state) const {
  FeatureState inside = state;
  clip(inside.nu, believed_.nu);
  clip(inside.tau, believed_.tau);
  for (auto& slow : inside.slow_tau) clip(slow, believed_.tau);
  for (auto& slow : inside.slow_nu) clip(slow, believed_.nu);
  for (ActuatorForces& use : inside.use) {
    for (Eigen::Index i = 0; i < use.size(); ++i)
      use[i] = clipped(use[i], i < believed_.force.size() ? believed_.force[i] : 0.0);
  }
  for (Eigen::Index i = 0; i < inside.force.size(); ++i)
    inside.force[i] = clipped(inside.force[i], i < believed_.force.size() ? believed_.force[i] : 0.0);
  return inside;
}

Vector6d LearnedForm::sum(const FeatureState& state, Part part) const {
  const FeatureState near = inside(state);
  Vector6d wrench = Vector6d::Zero();
  for (std::size_t j = 0; j < force_.features.size(); ++j) {
    if (part_[j] != part) continue;
    force_.features[j].add(near, fade(force_.features[j], state, believed_) * force_.weights[j], wrench);
  }
  return wrench;
}

void LearnedForm::feel(Motion& motion, EffectTheta, std::span<const double> z) const {
  if (streams_) {
    const FeatureState state = state_of(motion);
    Stream stream;
    for (std::size_t j = 0; j < force_.features.size(); ++j) {
      const Feature& feature = force_.features[j];
      if (!feature.streams()) continue;
      const double weight = fade(feature, state, believed_) * force_.weights[j];
      stream.v_WF[feature.axis - kStream] += weight * feature.value(state);
      stream.a_WF[feature.axis - kStream] += weight * feature.rate(state);
    }
    motion.v_WF_B += motion.R_WB.transpose() * stream.v_WF;
    motion.a_WF_B += motion.R_WB.transpose() * stream.a_WF;
  }
  if (!remembers_) return;
  FeatureState state = state_of(motion);
  const Eigen::Map<const Eigen::Matrix<double, 6, kTaps + kSlow>> memory{z.data()};
  for (Eigen::Index b = 0; b < kTaps; ++b) state.slow_tau[static_cast<std::size_t>(b)] = memory.col(b);
  for (Eigen::Index b = 0; b < kSlow; ++b) state.slow_nu[static_cast<std::size_t>(b)] = memory.col(kTaps + b);
  const Eigen::Index actuators = allocation_.cols();
  for (std::size_t b = 0; b < kUseMemories.size(); ++b)
    state.use[b] =
        Eigen::Map<const Eigen::VectorXd>{z.data() + kOfAxes + b * static_cast<std::size_t>(actuators), actuators};
  motion.w_memory += sum(state, Part::kRemembers);
}

void LearnedForm::load(const Motion& motion, EffectTheta, Load& load) const {
  FeatureState state = state_of(motion);
  state.drag = load.drag;
  load.wrench += sum(state, Part::kStill);
  for (std::size_t j = 0; j < force_.features.size(); ++j) {
    if (part_[j] != Part::kWeighs) continue;
    const Feature& feature = force_.features[j];
    load.add_mass(fade(feature, state, believed_) * force_.weights[j] * feature.value(state), motion.nu);
  }
  Vector6d moving = sum(state, Part::kMoves);
  const Vector6d nu_r = motion.nu_r();
  const double given = nu_r.dot(moving), taken = -nu_r.dot(load.drag);  // W
  if (given > 0.0 && given > taken) moving *= std::max(taken, 0.0) / given;
  load.wrench += moving;
}

int LearnedForm::state_size(int) const {
  if (!remembers_) return 0;
  return static_cast<int>(kOfAxes + kUseMemories.size() * static_cast<std::size_t>(allocation_.cols()));
}

void LearnedForm::settle(const Motion& motion, EffectTheta, std::span<double> z) const {
  if (!remembers_) return;
  Eigen::Map<Eigen::Matrix<double, 6, kTaps + kSlow>> memory{z.data()};
  memory.leftCols<kTaps>().colwise() = Vector6d{allocation_ * motion.force};
  memory.rightCols<kSlow>().colwise() = motion.nu_r();
  // What was done before is on record, as it was commanded; no run-in is as long as these memories. Before the record
  // begins they have rested: as much as they do at its first instant they hardly did all the time.
  ActuatorForces then = motion.force;
  for (std::size_t b = 0; b < kUseMemories.size(); ++b) {
    auto use = use_in(z, allocation_.cols(), b);
    use = motion.force.cwiseAbs();
    if (motion.input == nullptr) continue;
    const double dt = kPastReach * kUseMemories[b] / kPast, share = -std::expm1(-dt / kUseMemories[b]);
    for (int k = kPast; k > 0; --k) {
      const double t = motion.t - (k - 0.5) * dt;
      motion.input->at(t, then);
      if (t < motion.input->begins()) then.setZero();
      if (k == kPast) use = then.cwiseAbs();
      use += share * (then.cwiseAbs() - use);
    }
  }
}

void LearnedForm::advance(const Motion& motion, EffectTheta, double dt, std::span<double> z) const {
  if (!remembers_) return;
  Eigen::Map<Eigen::Matrix<double, 6, kTaps + kSlow>> memory{z.data()};
  const Vector6d tau = allocation_ * motion.force;
  for (Eigen::Index b = 0; b < kTaps; ++b)
    memory.col(b) += -std::expm1(-dt / kThrustMemories[static_cast<std::size_t>(b)]) * (tau - memory.col(b));
  for (Eigen::Index b = 0; b < kSlow; ++b)
    memory.col(kTaps + b) +=
        -std::expm1(-dt / kVelocityMemories[static_cast<std::size_t>(b)]) * (motion.nu_r() - memory.col(kTaps + b));
  for (std::size_t b = 0; b < kUseMemories.size(); ++b) {
    auto use = use_in(z, allocation_.cols(), b);
    use += -std::expm1(-dt / kUseMemories[b]) * (motion.force.cwiseAbs() - use);
  }
}

double LearnedForm::run_in(EffectTheta) const {
  double longest = 0.0;  // s
  for (const Feature& feature : force_.features) {
    for (int i = 0; i < feature.count; ++i) {
      const Factor& factor = feature.factors[static_cast<std::size_t>(i)];
      const auto bank = static_cast<std::size_t>(factor.bank);
      if (factor.quantity == Quantity::kSlowVelocity) longest = std::max(longest, kVelocityMemories[bank]);
      if (factor.quantity == Quantity::kSlowWrench) longest = std::max(longest, kThrustMemories[bank]);
    }
  }
  return longest > 0.0 ? run_in_for(longest) : 0.0;
}

LearnedForce::LearnedForce(FreeForce force, Visited visited, Allocation allocation)
    : Effect{{.name = "learned_force",
              .sentence = "A force learned from the recording acts.",
              .revealed_by = "the motion of the recording that showed it",
              .stage = Stage::kBody,
              .feels_place = true},
             {},
             forms(LearnedForm{std::move(force), std::move(visited), std::move(allocation)})} {}

FreeForce without_time(const FreeForce& force) {
  return kept_of(force, [](const FeatureGroup&, const Feature& feature) { return !feature.depends_on_time(); });
}

FreeForce lasting_of(const FreeForce& force) {
  return kept_of(force, [](const FeatureGroup& group, const Feature& feature) {
    return std::all_of(feature.factors.begin(), feature.factors.begin() + feature.count, [&](const Factor& factor) {
      const FactorKind& kind = kind_of(factor.quantity);
      return !kind.in_time || kind.grows || (group.closed && factor.quantity == Quantity::kAfter);
    });
  });
}

bool is_law(const FreeForce& force) {
  constexpr std::size_t kMostAmplitudes = 6;
  return !force.empty() && force.features.size() <= kMostAmplitudes &&
         std::ranges::all_of(force.groups, &FeatureGroup::closed);
}

bool swings(const FreeForce& force) {
  return std::ranges::any_of(force.groups, [&](const FeatureGroup& group) {
    const auto first = force.features.begin() + group.first;
    return group.closed &&
           std::any_of(first, first + group.count, [](const Feature& feature) { return feature.swings(); });
  });
}

FreeForce as_it_stands(const FreeForce& force, double t) {
  const FeatureState then{.t = t};
  FreeForce rest = force;
  for (const FeatureGroup& group : force.groups) {
    for (int j = group.first; j < group.first + group.count; ++j) {
      Feature& feature = rest.features[static_cast<std::size_t>(j)];
      for (int i = 0; i < feature.count;) {
        const Factor factor = feature.factors[static_cast<std::size_t>(i)];
        const bool stays = factor.quantity == Quantity::kAfter || factor.quantity == Quantity::kRamp;
        if (!stays || !group.closed) {
          ++i;
          continue;
        }
        feature.scale *= kind_of(factor.quantity).value(factor, then);
        feature.factors[static_cast<std::size_t>(i)] = feature.factors[static_cast<std::size_t>(--feature.count)];
      }
    }
  }
  return kept_of(rest, [](const FeatureGroup& group, const Feature& feature) {
    return std::all_of(feature.factors.begin(), feature.factors.begin() + feature.count, [&](const Factor& factor) {
      const FactorKind& kind = kind_of(factor.quantity);
      return !kind.in_time || (group.closed && (kind.rate != nullptr || kind.grows));
    });
  });
}

}  // namespace fathom::model
