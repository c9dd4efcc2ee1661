#include "common/model/hydrodynamics.hpp"

#include <array>
#include <cmath>
#include <string_view>

#include "common/base/config.hpp"
#include "common/base/factors.hpp"
#include "common/model/priors/bounded.hpp"

namespace fathom::model {
namespace {

Umbilical read_umbilical(const Config& config) {
  return {.p_BU = bounded::vector3(config, "position", "m"),
          .diameter = bounded::positive(config, "diameter", "m"),
          .paid_out = bounded::positive(config, "paid_out", "m"),
          .drag_coefficient = bounded::positive(config, "drag_coefficient", "")};
}

Chain read_chain(const Config& config) {
  return {.p_BC = bounded::vector3(config, "position", "m"),
          .weight = bounded::positive(config, "weight", "N/m"),
          .length = bounded::positive(config, "length", "m"),
          .friction = bounded::not_negative(config, "friction", ""),
          .seabed = bounded::quantity(config, "seabed", "m")};
}

LoadCell read_cell(const Config& config) {
  LoadCell cell{.name = config.text("name"),
                .of = config.text("of"),
                .p_BL = bounded::vector3(config, "position", "m"),
                .axis_B = bounded::vector3(config, "axis", "")};
  if (cell.of != "thrusters" && cell.of != "umbilical" && cell.of != "chain") {
    config.fail("of", "'of' must be thrusters, umbilical or chain, not '" + cell.of + "'");
  }
  if (std::abs(cell.axis_B.norm() - 1.0) > 0.01) config.fail("axis", "'axis' must be a unit vector");
  cell.axis_B.normalize();
  return cell;
}

/// One number, or two: of a flow from starboard and from port.
std::array<double, 2> either_way(const Config& config, const std::string& key) {
  const std::vector<double> numbers = bounded::quantities(config, key, "");
  if (numbers.empty() || numbers.size() > 2)
    config.fail(key, "'" + key + "' is one number, or two: of a flow from starboard and from port");
  return {numbers.front(), numbers.back()};
}

Interaction read_interaction(const Config& config) {
  const auto number = [&](const char* key, double otherwise) {
    return config.has(key) ? bounded::quantity(config, key, "") : otherwise;
  };
  Interaction i{.t_P = number("t_P", 0.0),
                .w_P = number("w_P", 0.0),
                .C_1 = number("C_1", 0.0),
                .x_P = number("x_P", -0.5),
                .K_TJJ = number("K_TJJ", 0.0),
                .t_R = number("t_R", 0.0),
                .a_H = number("a_H", 0.0),
                .x_H = number("x_H", -0.5),
                .l_R = number("l_R", -1.0),
                .epsilon = number("epsilon", 1.0),
                .kappa = number("kappa", 0.5),
                .eta = number("eta", 1.0)};
  if (config.has("C_2")) i.C_2 = either_way(config, "C_2");
  i.gamma_R = config.has("gamma_R") ? either_way(config, "gamma_R") : std::array<double, 2>{1.0, 1.0};
  const auto share = [&](const char* key, double value) {
    if (!(value >= 0.0 && value <= 1.0)) config.fail(key, "'" + std::string{key} + "' must lie from 0 to 1");
  };
  share("t_P", i.t_P);
  share("w_P", i.w_P);
  share("t_R", i.t_R);
  share("eta", i.eta);
  if (i.w_P == 1.0) config.fail("w_P", "'w_P' is less than 1: the propeller meets some flow");
  if (i.epsilon <= 0.0) config.fail("epsilon", "'epsilon' must be positive: the rudder meets some flow");
  return i;
}

/// Off the diagonal, by the derivative's name: `Y_rdot: -12 kg m` is -M_26. What is stated on one side alone holds on
/// the other: ideal fluid has no sides.
void read_couplings(const Config& config, Matrix6d& M) {
  constexpr std::string_view kForces = "XYZKMN", kMotions = "uvwpqr";
  std::array<std::array<bool, 6>, 6> told{};
  for (const std::string& name : config.keys()) {
    const bool formed = name.size() == 6 && name[1] == '_' && name.ends_with("dot");
    const std::size_t i = formed ? kForces.find(name[0]) : std::string_view::npos;
    const std::size_t j = formed ? kMotions.find(name[2]) : std::string_view::npos;
    if (i >= 6 || j >= 6 || i == j)
      config.fail(name, "'" + name + "' is no coupling of added mass; they are X_vdot, Y_rdot, M_wdot and the like");
    const std::size_t turns = (i >= 3 ? 1 : 0) + (j >= 3 ? 1 : 0);
    const std::array<const char*, 3> units{"kg", "kg m", "kg m^2"};
    M(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = -bounded::quantity(config, name, units[turns]);
    told[i][j] = true;
  }
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t j = 0; j < 6; ++j) {
      const auto a = static_cast<Eigen::Index>(i), b = static_cast<Eigen::Index>(j);
      if (told[i][j] && !told[j][i]) M(b, a) = M(a, b);
    }
  }
}

/// InputError where a motion would have no energy: no body's inertia is such.
void require_energy(const Config& config, const char* key, const Eigen::MatrixXd& M, const std::string& what) {
  const double least = symmetric_eigen(0.5 * (M + M.transpose())).values[0];
  if (!(least >= -1e-9 * M.diagonal().cwiseAbs().maxCoeff()))
    config.fail(key, "with these numbers " + what + " is not positive: no body is so; are sign and unit right?");
}

}  // namespace

std::vector<ManoeuvringCoefficient> read_coefficients(const Config& config, const StandardSet& set) {
  std::vector<ManoeuvringCoefficient> coefficients;
  for (const std::string& name : config.keys()) {
    const ManoeuvringTerm* term = set.find(name);
    if (term == nullptr)
      config.fail(name, "'" + name + "' is no coefficient of " + std::string{set.name} + " (docs/model.md lists them)");
    if (config.is_section(name)) {
      const Config both = config.section(name);
      const double value = bounded::quantity(both, "value", "");
      coefficients.push_back({term, value, std::abs(value) * bounded::not_negative(both, "error", "")});
    } else {
      coefficients.push_back({term, bounded::quantity(config, name, "")});
    }
  }
  return coefficients;
}

Eigen::Matrix3d Hydrodynamics::inertia(const Eigen::Vector3d& diagonal) const {
  Eigen::Matrix3d I = diagonal.asDiagonal();
  I(0, 1) = I(1, 0) = products[0];
  I(0, 2) = I(2, 0) = products[1];
  I(1, 2) = I(2, 1) = products[2];
  return I;
}

Hydrodynamics Hydrodynamics::from(const Config& config, const Eigen::Vector3d& inertia) {
  Hydrodynamics h;
  if (config.has("model")) {
    const std::string name = config.text("model");
    h.set = find_standard_set(name);
    h.named = true;
    if (h.set == nullptr) config.fail("model", "'" + name + "' is no standard set; they are " + standard_set_names());
  }
  h.length = bounded::positive(config, "length", "m");
  if (config.has("draught")) h.draught = bounded::positive(config, "draught", "m");
  if (config.has("cruise")) h.cruise = bounded::positive(config, "cruise", "m/s");
  const std::string set{h.set->name};
  if (h.set->needs_draught && h.draught == 0.0) config.fail("model", set + " needs the 'draught' of the hull");
  if (h.set->needs_cruise && h.cruise == 0.0)
    config.fail("model", set + " is a series about a speed ahead: state it as 'cruise'");
  if (config.has("rigid_coriolis")) {
    const std::string where = config.text("rigid_coriolis");
    if (where != "apart" && where != "among_coefficients")
      config.fail("rigid_coriolis", "'rigid_coriolis' is apart or among_coefficients, not '" + where + "'");
    h.rigid_coriolis = where == "apart";
  }
  if (config.has("interaction")) h.interaction = read_interaction(config.section("interaction"));
  h.added_mass.diagonal() << bounded::vector3(config, "added_mass", "kg"),
      bounded::vector3(config, "added_inertia", "kg m^2");
  if (h.added_mass.minCoeff() < 0.0) config.fail("added_mass", "added mass and inertia must not be negative");
  if (config.has("added_mass_couplings")) {
    read_couplings(config.section("added_mass_couplings"), h.added_mass);
    require_energy(config, "added_mass_couplings", h.added_mass, "the added mass");
  }
  if (config.has("centre_of_buoyancy")) h.p_BB = bounded::vector3(config, "centre_of_buoyancy", "m");
  if (config.has("centre_of_mass")) h.p_BG = bounded::vector3(config, "centre_of_mass", "m");
  if (config.has("products_of_inertia")) {
    h.products = bounded::vector3(config, "products_of_inertia", "kg m^2");
    require_energy(config, "products_of_inertia", h.inertia(inertia), "the inertia about the centre of mass");
  }
  if (config.has("coefficients")) h.coefficients = read_coefficients(config.section("coefficients"), *h.set);
  if (config.has("reference")) h.reference = read_coefficients(config.section("reference"), *h.set);
  if (config.has("umbilical")) h.umbilical = read_umbilical(config.section("umbilical"));
  if (config.has("chain")) h.chain = read_chain(config.section("chain"));
  if (config.has("load_cells")) {
    for (const Config& one : config.list("load_cells")) h.load_cells.push_back(read_cell(one));
  }
  return h;
}

}  // namespace fathom::model
