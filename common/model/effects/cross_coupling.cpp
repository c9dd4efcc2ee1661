// Physics: motion along one axis loads another. Off-diagonal drag w_i = D_ij nu_r,j or D_ij |nu_r,j| nu_r,j, and
// off-diagonal added mass M_ij = M_ji with its Coriolis part, so that it does no work. Pairs that a hull symmetric
// about its x-z plane allows: {X Z M} with {u w q}, {Y K N} with {v p r} (Fossen 2011, sec. 6.3 and 6.4); what is
// carried on one side only: N and Y with u, K with w; then those of a hull without symmetry. Ignores products of two
// speeds, and u^2 in place of |u|u. Revealed by single-axis motion: watch the idle axes. Confused with thruster_gain
// and thruster_misalignment, and added mass with centre_of_mass.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/model/effect.hpp"
#include "common/model/parameters.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kCrossCouplingParameters{EffectParameter{"coefficient", "N/(m/s)", 1.0}};
constexpr std::array<std::array<int, 3>, 2> kPlanes{{{0, 2, 4}, {1, 3, 5}}};

enum class CrossCouplingForm { kLinear, kQuadratic, kInertia };

struct Term {
  int row;
  int column;
  CrossCouplingForm form;
};

constexpr std::array<std::array<int, 2>, 3> kOneSided{{{5, 0}, {1, 0}, {3, 2}}};

/// Numbers of the forms, which others know them by, go from the likeliest hulls to those without any symmetry.
constexpr std::array<Term, 75> make_terms() {
  std::array<Term, 75> terms{};
  std::array<bool, 36> drag{}, inertia{};
  std::size_t n = 0;
  const auto add_drag = [&](int row, int column) {
    if (std::exchange(drag[static_cast<std::size_t>(6 * row + column)], true)) return;
    terms[n++] = {row, column, CrossCouplingForm::kLinear};
    terms[n++] = {row, column, CrossCouplingForm::kQuadratic};
  };
  const auto add_inertia = [&](int row, int column) {
    const auto [low, high] = std::minmax(row, column);
    if (std::exchange(inertia[static_cast<std::size_t>(6 * low + high)], true)) return;
    terms[n++] = {low, high, CrossCouplingForm::kInertia};
  };
  for (const auto& plane : kPlanes) {
    for (const int row : plane) {
      for (const int column : plane) {
        if (row == column) continue;
        add_drag(row, column);
        if (row < column) add_inertia(row, column);
      }
    }
  }
  const auto add = [&](int row, int column) {
    add_drag(row, column);
    add_inertia(row, column);
  };
  for (const auto& [row, column] : kOneSided) add(row, column);
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) {
      if (row != column) add(row, column);
    }
  }
  return terms;
}
constexpr auto kTerms = make_terms();

std::string term_name(const Term& term) {
  const auto row = static_cast<std::size_t>(term.row);
  const auto column = static_cast<std::size_t>(term.column);
  const std::string v = kVelocityNames[column];
  const std::string base = std::string(kAxisNames[row]) + "_";
  if (term.form == CrossCouplingForm::kLinear) return base + v;
  if (term.form == CrossCouplingForm::kQuadratic) return base + v + "|" + v + "|";
  return base + v + "_dot";
}

class CrossCoupling final : public Effect {
 public:
  std::string_view name() const override { return "cross_coupling"; }
  std::string_view sentence() const override { return "Motion along one axis loads another axis."; }
  std::string_view revealed_by() const override { return "motion along one axis at a time, at several speeds"; }
  std::span<const EffectParameter> parameters() const override { return kCrossCouplingParameters; }
  bool feels_motion() const override { return false; }
  bool variants_matter() const override { return true; }
  std::string_view unit(int variant, std::size_t) const override {
    const Term& term = kTerms[static_cast<std::size_t>(variant)];
    if (term.form == CrossCouplingForm::kInertia) return inertia_unit(term.row, term.column);
    return drag_unit(term.row, term.column, term.form == CrossCouplingForm::kLinear ? 1 : 2);
  }
  std::vector<std::string> variants(const Scene& scene) const override {
    // Positions in this list are the variant numbers, so a term whose axes stand still keeps its place with no name.
    std::vector<std::string> names;
    for (const Term& term : kTerms) {
      const bool free = scene.vehicle->dof[static_cast<std::size_t>(term.row)];
      const bool moves = scene.nu_rms[term.column] > 0.0 && (term.form != CrossCouplingForm::kInertia ||
                                                             scene.vehicle->dof[static_cast<std::size_t>(term.column)]);
      names.push_back(free && moves ? term_name(term) : "-");
    }
    return names;
  }
  std::vector<std::vector<double>> starts(const Scene& scene, int variant) const override {
    const Term& term = kTerms[static_cast<std::size_t>(variant)];
    const double speed = std::max(scene.nu_rms[term.column], 1e-3);
    const double force = 0.02 * std::max(scene.tau_rms[term.row], 1e-3);
    if (term.form == CrossCouplingForm::kLinear) return {{force / speed}};
    if (term.form == CrossCouplingForm::kQuadratic) return {{force / (speed * speed)}};
    return {{0.2 * force / speed}};
  }

  void load(const Motion& motion, EffectTheta theta, int variant, Load& load) const override {
    const Term& term = kTerms[static_cast<std::size_t>(variant)];
    if (theta[0] == 0.0) return;
    const Vector6d nu_r = motion.nu_r();
    const double velocity = nu_r[term.column];
    if (term.form == CrossCouplingForm::kLinear) load.wrench[term.row] += theta[0] * velocity;
    if (term.form == CrossCouplingForm::kQuadratic) load.wrench[term.row] += theta[0] * std::abs(velocity) * velocity;
    if (term.form == CrossCouplingForm::kInertia) {
      load.added_inertia()(term.row, term.column) += theta[0];
      load.added_inertia()(term.column, term.row) += theta[0];
      // Momentum that the pair adds, and what it costs to turn it (Fossen 2011, eq. 6.44); steady water seen from a
      // turning body accelerates by -w x v_WF.
      const Eigen::Vector3d w = motion.nu.tail<3>();
      Vector6d momentum = Vector6d::Zero(), water = Vector6d::Zero();
      const Eigen::Vector3d water_dot = motion.a_WF_B - w.cross(motion.v_WF_B);
      momentum[term.row] = theta[0] * nu_r[term.column];
      momentum[term.column] = theta[0] * nu_r[term.row];
      if (term.column < 3) water[term.row] = theta[0] * water_dot[term.column];
      if (term.row < 3) water[term.column] = theta[0] * water_dot[term.row];
      const Eigen::Vector3d P = momentum.head<3>(), L = momentum.tail<3>(), v_r = nu_r.head<3>();
      load.wrench.head<3>() -= w.cross(P);
      load.wrench.tail<3>() -= w.cross(L) + v_r.cross(P);
      load.wrench += water;
    }
  }
};

}  // namespace

const Effect& cross_coupling() {
  static const CrossCoupling kEffect;
  return kEffect;
}

}  // namespace fathom::model::effects
