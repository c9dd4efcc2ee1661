#include "common/model/hydrodynamics.hpp"

#include <cmath>

#include "common/base/config.hpp"
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

}  // namespace

std::vector<ManoeuvringCoefficient> read_coefficients(const Config& config) {
  std::vector<ManoeuvringCoefficient> coefficients;
  for (const std::string& name : config.keys()) {
    const ManoeuvringTerm* term = find_manoeuvring_term(name);
    if (term == nullptr) config.fail(name, "'" + name + "' is no hydrodynamic derivative (docs/model.md lists them)");
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

Hydrodynamics Hydrodynamics::from(const Config& config) {
  Hydrodynamics h;
  h.length = bounded::positive(config, "length", "m");
  h.added_mass << bounded::vector3(config, "added_mass", "kg"), bounded::vector3(config, "added_inertia", "kg m^2");
  if (h.added_mass.minCoeff() < 0.0) config.fail("added_mass", "added mass and inertia must not be negative");
  if (config.has("centre_of_buoyancy")) h.p_BB = bounded::vector3(config, "centre_of_buoyancy", "m");
  if (config.has("coefficients")) h.coefficients = read_coefficients(config.section("coefficients"));
  if (config.has("reference")) h.reference = read_coefficients(config.section("reference"));
  if (config.has("umbilical")) h.umbilical = read_umbilical(config.section("umbilical"));
  if (config.has("chain")) h.chain = read_chain(config.section("chain"));
  if (config.has("load_cells")) {
    for (const Config& one : config.list("load_cells")) h.load_cells.push_back(read_cell(one));
  }
  return h;
}

}  // namespace fathom::model
