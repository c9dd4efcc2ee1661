// Gliders: lift, drag and moment as polynomials of the angle of attack a = atan2(w, u), times the square of the speed V
// in the vertical plane, and damping in pitch (J. G. Graver, "Underwater gliders: dynamics, control and design",
// Princeton 2005; N. E. Leonard and J. G. Graver, IEEE J. Oceanic Eng. 26(4), 2001):
//   D = (K_D0 + K_D a^2) V^2 against the flow   L = (K_L0 + K_L a) V^2 square to it   M = (K_M0 + K_M a + K_q2 q) V^2 +
//   K_q1 q
// Coefficients in SI units and radians; all of added mass' Coriolis terms stand beside them.
#include <array>
#include <cmath>

#include "common/model/actuators.hpp"
#include "common/model/manoeuvring/standard_set.hpp"

namespace fathom::model {
namespace glider_set {
namespace {

constexpr int kPitch = 4;

double attack(const TermMotion& n) { return std::atan2(n[2], n[0]); }
double square(const TermMotion& n) { return n[0] * n[0] + n[2] * n[2]; }

/// Of a force `size` V^2 against the flow: (-u, -w) V.
template <int order>
double drag_ahead(const TermMotion& n) {
  return -std::pow(attack(n), order) * std::sqrt(square(n)) * n[0];
}
template <int order>
double drag_down(const TermMotion& n) {
  return -std::pow(attack(n), order) * std::sqrt(square(n)) * n[2];
}
/// Of lift, square to it and up where the angle is positive: (w, -u) V.
template <int order>
double lift_ahead(const TermMotion& n) {
  return std::pow(attack(n), order) * std::sqrt(square(n)) * n[2];
}
template <int order>
double lift_down(const TermMotion& n) {
  return -std::pow(attack(n), order) * std::sqrt(square(n)) * n[0];
}
template <int order>
double moment(const TermMotion& n) {
  return std::pow(attack(n), order) * square(n);
}
double damping(const TermMotion& n) { return n[kPitch]; }
double damping_by_speed(const TermMotion& n) { return n[kPitch] * square(n); }

constexpr TermScale kPlain = TermScale::kPlain;
constexpr std::array<ManoeuvringTerm, 8> kTerms{{{"K_D0", 0, 0, drag_ahead<0>, kPlain, false, 2, drag_down<0>},
                                                 {"K_D", 0, 0, drag_ahead<2>, kPlain, false, 2, drag_down<2>},
                                                 {"K_L0", 0, 0, lift_ahead<0>, kPlain, false, 2, lift_down<0>},
                                                 {"K_L", 0, 0, lift_ahead<1>, kPlain, false, 2, lift_down<1>},
                                                 {"K_M0", kPitch, 0, moment<0>, kPlain},
                                                 {"K_M", kPitch, 0, moment<1>, kPlain},
                                                 {"K_q1", kPitch, 0, damping, kPlain},
                                                 {"K_q2", kPitch, 0, damping_by_speed, kPlain}}};

}  // namespace
}  // namespace glider_set

const StandardSet& glider() {
  static const StandardSet set{.name = "glider",
                               .source = "Graver 2005, Leonard and Graver 2001",
                               .terms = glider_set::kTerms,
                               .moves = {true, false, true, false, true, false},
                               .coriolis = AddedCoriolis::kWhole,
                               .pushed = acting_wrench};
  return set;
}

}  // namespace fathom::model
