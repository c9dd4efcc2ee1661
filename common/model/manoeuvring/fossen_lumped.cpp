// Drag along each axis by its own velocity, linear and quadratic, and all of added mass' Coriolis terms: the base model
// of this program, as most of small vehicles are published (T. I. Fossen, "Handbook of Marine Craft Hydrodynamics and
// Motion Control", 2021, sec. 8.4). Coefficients in SI units.
#include <array>
#include <cmath>

#include "common/model/actuators.hpp"
#include "common/model/manoeuvring/standard_set.hpp"

namespace fathom::model {
namespace fossen_lumped_set {
namespace {

template <int axis>
double linear(const TermMotion& n) {
  return n[axis];
}
template <int axis>
double quadratic(const TermMotion& n) {
  return n[axis] * std::abs(n[axis]);
}

constexpr TermScale kPlain = TermScale::kPlain;
constexpr std::array<ManoeuvringTerm, 12> kTerms{{{"X_u", 0, 0, linear<0>, kPlain},
                                                  {"Y_v", 1, 0, linear<1>, kPlain},
                                                  {"Z_w", 2, 0, linear<2>, kPlain},
                                                  {"K_p", 3, 0, linear<3>, kPlain},
                                                  {"M_q", 4, 0, linear<4>, kPlain},
                                                  {"N_r", 5, 0, linear<5>, kPlain},
                                                  {"X_u|u|", 0, 0, quadratic<0>, kPlain},
                                                  {"Y_v|v|", 1, 0, quadratic<1>, kPlain},
                                                  {"Z_w|w|", 2, 0, quadratic<2>, kPlain},
                                                  {"K_p|p|", 3, 0, quadratic<3>, kPlain},
                                                  {"M_q|q|", 4, 0, quadratic<4>, kPlain},
                                                  {"N_r|r|", 5, 0, quadratic<5>, kPlain}}};

}  // namespace
}  // namespace fossen_lumped_set

const StandardSet& fossen_lumped() {
  static const StandardSet set{.name = "fossen_lumped",
                               .source = "Fossen 2021, sec. 8.4",
                               .terms = fossen_lumped_set::kTerms,
                               .moves = {true, true, true, true, true, true},
                               .coriolis = AddedCoriolis::kWhole,
                               .is_base = true,
                               .pushed = acting_wrench};
  return set;
}

}  // namespace fathom::model
