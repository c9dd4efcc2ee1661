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

constexpr std::array<std::array<int, 2>, 3> kOneSided{{{5, 0}, {1, 0}, {3, 2}}};

/// A pair of axes, whose first one is loaded.
class Coupling : public Form {
 public:
  Coupling(int row, int column, std::string_view unit) : Form{{.unit = unit}}, row_{row}, column_{column} {}

 protected:
  [[nodiscard]] bool row_free(const Scene& scene) const { return scene.vehicle->dof[static_cast<std::size_t>(row_)]; }
  [[nodiscard]] bool column_free(const Scene& scene) const {
    return scene.vehicle->dof[static_cast<std::size_t>(column_)];
  }
  [[nodiscard]] bool column_moves(const Scene& scene) const { return scene.nu_rms[column_] > 0.0; }
  /// N, N m, m/s, rad/s.
  [[nodiscard]] double start_force(const Scene& scene) const { return 0.02 * std::max(scene.tau_rms[row_], 1e-3); }
  [[nodiscard]] double start_speed(const Scene& scene) const { return std::max(scene.nu_rms[column_], 1e-3); }
  [[nodiscard]] std::string label() const { return std::string(kAxisNames[static_cast<std::size_t>(row_)]) + "_"; }
  [[nodiscard]] std::string letter() const { return kVelocityNames[static_cast<std::size_t>(column_)]; }

  int row_, column_;
};

class LinearDrag final : public Coupling {
 public:
  LinearDrag(int row, int column) : Coupling{row, column, drag_unit(row, column, 1)} {}
  FormName name(const Scene& scene) const override {
    return when(row_free(scene) && column_moves(scene), label() + letter());
  }
  Starts starts(const Scene& scene) const override { return {{start_force(scene) / start_speed(scene)}}; }
  void load(const Motion& motion, EffectTheta theta, Load& load) const override {
    if (theta[0] != 0.0) load.wrench[row_] += theta[0] * motion.nu_r()[column_];
  }
};

class QuadraticDrag final : public Coupling {
 public:
  QuadraticDrag(int row, int column) : Coupling{row, column, drag_unit(row, column, 2)} {}
  FormName name(const Scene& scene) const override {
    return when(row_free(scene) && column_moves(scene), label() + letter() + "|" + letter() + "|");
  }
  Starts starts(const Scene& scene) const override {
    const double speed = start_speed(scene);
    return {{start_force(scene) / (speed * speed)}};
  }
  void load(const Motion& motion, EffectTheta theta, Load& load) const override {
    if (theta[0] == 0.0) return;
    const double velocity = motion.nu_r()[column_];
    load.wrench[row_] += theta[0] * std::abs(velocity) * velocity;
  }
};

class AddedMass final : public Coupling {
 public:
  AddedMass(int row, int column) : Coupling{row, column, inertia_unit(row, column)} {}
  FormName name(const Scene& scene) const override {
    return when(row_free(scene) && column_moves(scene) && column_free(scene), label() + letter() + "_dot");
  }
  Starts starts(const Scene& scene) const override { return {{0.2 * start_force(scene) / start_speed(scene)}}; }
  void load(const Motion& motion, EffectTheta theta, Load& load) const override {
    if (theta[0] == 0.0) return;
    load.added_inertia()(row_, column_) += theta[0];
    load.added_inertia()(column_, row_) += theta[0];
    // Momentum that the pair adds, and what it costs to turn it (Fossen 2011, eq. 6.44); steady water seen from a
    // turning body accelerates by -w x v_WF.
    const Vector6d nu_r = motion.nu_r();
    const Eigen::Vector3d w = motion.nu.tail<3>();
    Vector6d momentum = Vector6d::Zero(), water = Vector6d::Zero();
    const Eigen::Vector3d water_dot = motion.a_WF_B - w.cross(motion.v_WF_B);
    momentum[row_] = theta[0] * nu_r[column_];
    momentum[column_] = theta[0] * nu_r[row_];
    if (column_ < 3) water[row_] = theta[0] * water_dot[column_];
    if (row_ < 3) water[column_] = theta[0] * water_dot[row_];
    const Eigen::Vector3d P = momentum.head<3>(), L = momentum.tail<3>(), v_r = nu_r.head<3>();
    load.wrench.head<3>() -= w.cross(P);
    load.wrench.tail<3>() -= w.cross(L) + v_r.cross(P);
    load.wrench += water;
  }
};

/// From the likeliest hulls to those without any symmetry: the order of the variants.
Forms every_coupling() {
  Forms all;
  std::array<bool, 36> drag{}, inertia{};
  const auto add_drag = [&](int row, int column) {
    if (std::exchange(drag[static_cast<std::size_t>(6 * row + column)], true)) return;
    all.push_back(std::make_unique<LinearDrag>(row, column));
    all.push_back(std::make_unique<QuadraticDrag>(row, column));
  };
  const auto add_inertia = [&](int row, int column) {
    const auto [low, high] = std::minmax(row, column);
    if (std::exchange(inertia[static_cast<std::size_t>(6 * low + high)], true)) return;
    all.push_back(std::make_unique<AddedMass>(low, high));
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
  return all;
}

}  // namespace

const Effect& cross_coupling() {
  static const Effect kEffect{{.name = "cross_coupling",
                               .sentence = "Motion along one axis loads another axis.",
                               .revealed_by = "motion along one axis at a time, at several speeds",
                               .stage = Stage::kBody,
                               .forms_coexist = true,
                               .feels_motion = false},
                              kCrossCouplingParameters,
                              every_coupling()};
  return kEffect;
}

}  // namespace fathom::model::effects
