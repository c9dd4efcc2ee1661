#include "common/model/learned/features.hpp"

#include <algorithm>
#include <cmath>

#include "common/model/learned/factors/factor_kind.hpp"

namespace fathom::model {
namespace {

constexpr std::array kKinds{
#define FACTOR(enumerator, name) &factor_##name,
#include "common/model/learned/factors/factors.def"
#undef FACTOR
};

template <typename Is>
bool any(const Feature& feature, const Is& is) {
  return std::any_of(feature.factors.begin(), feature.factors.begin() + feature.count,
                     [&](const Factor& f) { return is(kind_of(f.quantity)); });
}

/// A law of all thrusters or axes reads here the one of which it is just asked.
bool of_owner(int axis, const Factor& factor) {
  const Indexed indexed = kind_of(factor.quantity).indexed;
  return (axis == kEachThruster && indexed == Indexed::kThrusters) || (axis == kEachAxis && indexed == Indexed::kAxes);
}

/// In W, without a length where the point is reached.
Eigen::Vector3d toward_point(const Feature& feature, const FeatureState& state) {
  constexpr double kThere = 1e-9;  // m
  const auto end = feature.factors.begin() + feature.count;
  const auto point =
      std::find_if(feature.factors.begin(), end, [](const Factor& f) { return f.quantity == Quantity::kStretch; });
  if (point == end) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d way = Eigen::Vector3d{point->a, point->b, point->c} - state.p_WB;
  return way.norm() > kThere ? Eigen::Vector3d{way.normalized()} : Eigen::Vector3d::Zero();
}

}  // namespace

const FactorKind& kind_of(Quantity quantity) { return *kKinds[static_cast<std::size_t>(quantity)]; }

std::string_view word(Quantity quantity) { return kind_of(quantity).word; }

std::optional<Quantity> quantity_from(std::string_view word) {
  const auto found = std::ranges::find(kKinds, word, &FactorKind::word);
  if (found == kKinds.end()) return std::nullopt;
  return static_cast<Quantity>(found - kKinds.begin());
}

Vector6d held_back_by_mass(const Vector6d& nu_dot, const Vector6d& nu) {
  const Eigen::Vector3d v = nu.head<3>(), w = nu.tail<3>();
  Vector6d by_mass = Vector6d::Zero();
  by_mass.head<3>() = -(nu_dot.head<3>() + w.cross(v));
  return by_mass;
}

std::string direction_words(int axis) {
  if (axis < kWorldAxis) return kTauNames[axis];
  if (axis < kHullDrag) return std::array{"north", "east", "down"}[static_cast<std::size_t>(axis - kWorldAxis)];
  if (axis == kHullDrag) return "the hull's drag";
  if (axis == kAllThrust) return "the thrust";
  if (axis == kEachThruster) return "each thruster";
  if (axis == kEachAxis) return "each axis";
  if (axis == kMass) return "the mass";
  if (axis == kPull) return "the way to a point";
  if (axis == kGoingDrag) return "the hull's drag against translation";
  if (axis == kAgainstWay) return "the way past the water";
  if (axis >= kLever) return std::string("the lever of weight and buoyancy in ") + "xyz"[axis - kLever];
  if (axis >= kStream) return "the water's " + direction_words(axis - kStream + kWorldAxis);
  return "thruster " + std::to_string(axis - kThrusterLine + 1);
}

std::string direction_symbol(int axis) {
  if (axis < kWorldAxis) return std::string{"tau_"} + kTauNames[axis] + " =";
  if (axis < kHullDrag) return "f_" + direction_words(axis) + " =";
  if (axis == kHullDrag) return "tau = -D(nu) nu";
  if (axis == kAllThrust) return "tau = B f";
  if (axis == kEachThruster) return "delta f_j =";
  if (axis == kEachAxis) return "tau_i =";
  if (axis == kMass) return "m =";
  if (axis == kPull) return "f toward p_A =";
  if (axis == kGoingDrag) return "tau_1 = -(D(nu) nu)_1";
  if (axis == kAgainstWay) return "f = -v";
  if (axis >= kLever) return std::string("G_") + "xyz"[axis - kLever] + " =";
  if (axis >= kStream) return "v_" + direction_words(axis - kStream + kWorldAxis) + " =";
  return "tau = b_" + std::to_string(axis - kThrusterLine + 1);
}

std::string Feature::words() const {
  std::string product;
  for (int i = 0; i < count; ++i) {
    Factor factor = factors[static_cast<std::size_t>(i)];
    if (of_owner(axis, factor)) factor.index = kOwn;
    product += (product.empty() ? "" : " ") + kind_of(factor.quantity).words(factor);
  }
  return product;
}

int Feature::owners(const FeatureState& state) const {
  if (axis == kEachAxis) return 6;
  if (axis != kEachThruster) return 1;
  return state.allocation == nullptr ? 0 : static_cast<int>(std::min(state.allocation->cols(), state.force.size()));
}

Feature Feature::of_own(int own) const {
  if (axis != kEachThruster && axis != kEachAxis) return *this;
  Feature one = *this;
  one.axis = axis == kEachAxis ? own : kThrusterLine + own;
  for (int i = 0; i < count; ++i) {
    Factor& factor = one.factors[static_cast<std::size_t>(i)];
    if (of_owner(axis, factor)) factor.index = own;
  }
  return one;
}

double Feature::product(const FeatureState& state, int own) const {
  double product = scale;
  for (int i = 0; i < count; ++i) {
    const Factor& factor = factors[static_cast<std::size_t>(i)];
    if (own != kOwn && of_owner(axis, factor)) {
      Factor of_own = factor;
      of_own.index = own;
      product *= kind_of(factor.quantity).value(of_own, state);
    } else {
      product *= kind_of(factor.quantity).value(factor, state);
    }
  }
  return product;
}

double Feature::value(const FeatureState& state) const { return product(state, kOwn); }

double Feature::rate(const FeatureState& state) const {
  double sum = 0.0;
  for (int i = 0; i < count; ++i) {
    const Factor& swinging = factors[static_cast<std::size_t>(i)];
    const FactorKind& kind = kind_of(swinging.quantity);
    if (kind.rate == nullptr) continue;
    double product = scale * kind.rate(swinging, state);
    for (int j = 0; j < count; ++j) {
      const Factor& factor = factors[static_cast<std::size_t>(j)];
      if (j != i) product *= kind_of(factor.quantity).value(factor, state);
    }
    sum += product;
  }
  return sum;
}

double Feature::size(const FeatureState& state) const {
  if (weighs()) return std::abs(value(state)) * state.by_mass.head<3>().norm();
  if (against_way()) return std::abs(value(state)) * state.nu.head<3>().norm();
  if (levers())
    return std::abs(value(state)) * Eigen::Vector3d::Unit(axis - kLever).cross(state.R_WB.row(2).transpose()).norm();
  if (streams()) {
    Vector6d wrench = Vector6d::Zero();
    add(state, 1.0, wrench);
    return wrench.head<3>().norm();
  }
  if (axis != kEachThruster && axis != kEachAxis) return std::abs(value(state));
  double square = 0.0;
  for (int own = 0; own < owners(state); ++own) square += std::pow(product(state, own), 2);
  return std::sqrt(square);
}

bool Feature::moves_with_velocity() const {
  return of_drag() || against_way() || any(*this, [](const FactorKind& kind) { return kind.moves; });
}

bool Feature::depends_on_time() const {
  return any(*this, [](const FactorKind& kind) { return kind.in_time; });
}

bool Feature::swings() const {
  return any(*this, [](const FactorKind& kind) { return kind.rate != nullptr; });
}

bool Feature::remembers() const {
  return any(*this, [](const FactorKind& kind) { return kind.banks > 0; });
}

void Feature::add(const FeatureState& state, double weight, Vector6d& wrench) const {
  if (axis == kEachThruster || axis == kEachAxis) {
    for (int own = 0; own < owners(state); ++own) {
      const double size = weight * product(state, own);
      if (axis == kEachAxis) {
        wrench[own] += size;
      } else {
        wrench += size * state.allocation->col(own);
      }
    }
    return;
  }
  const double size = weight * value(state);
  if (axis < kWorldAxis) {
    wrench[axis] += size;
  } else if (axis < kHullDrag) {
    wrench.head<3>() += size * state.R_WB.row(axis - kWorldAxis).transpose();
  } else if (axis == kHullDrag) {
    wrench += size * state.drag;
  } else if (axis == kGoingDrag) {
    wrench.head<3>() += size * state.drag.head<3>();
  } else if (against_way()) {
    wrench.head<3>() -= size * state.nu.head<3>();
  } else if (axis == kAllThrust) {
    wrench += size * state.tau;
  } else if (weighs()) {
    wrench += size * state.by_mass;
  } else if (pulls()) {
    wrench.head<3>() += size * (state.R_WB.transpose() * toward_point(*this, state));
  } else if (levers()) {
    const Eigen::Vector3d down_B = state.R_WB.row(2).transpose();
    wrench.tail<3>() += size * Eigen::Vector3d::Unit(axis - kLever).cross(down_B);
  } else if (streams()) {
    wrench += size * state.by_stream.col(axis - kStream);
    wrench += weight * rate(state) * state.by_stream_rate.col(axis - kStream);
  } else if (state.allocation != nullptr && axis - kThrusterLine < state.allocation->cols()) {
    wrench += size * state.allocation->col(axis - kThrusterLine);
  }
}

Vector6d FreeForce::wrench(const FeatureState& state) const {
  Vector6d sum = Vector6d::Zero();
  for (std::size_t j = 0; j < features.size(); ++j) {
    if (!features[j].streams() && !features[j].weighs()) features[j].add(state, weights[j], sum);
  }
  return sum;
}

double FreeForce::mass(const FeatureState& state) const {
  double mass = 0.0;
  for (std::size_t j = 0; j < features.size(); ++j) {
    if (features[j].weighs()) mass += weights[j] * features[j].value(state);
  }
  return mass;
}

Stream FreeForce::stream(const FeatureState& state) const {
  Stream stream;
  for (std::size_t j = 0; j < features.size(); ++j) {
    if (!features[j].streams()) continue;
    const int toward = features[j].axis - kStream;
    stream.v_WF[toward] += weights[j] * features[j].value(state);
    stream.a_WF[toward] += weights[j] * features[j].rate(state);
  }
  return stream;
}

bool FreeForce::streams() const { return std::ranges::any_of(features, &Feature::streams); }

bool FreeForce::reads_drag() const { return std::ranges::any_of(features, &Feature::of_drag); }

}  // namespace fathom::model
