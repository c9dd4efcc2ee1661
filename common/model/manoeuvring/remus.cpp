// Torpedoes with four fins astern: T. Prestero, "Verification of a six-degree of freedom simulation model for the REMUS
// autonomous underwater vehicle", MIT/WHOI 2001. Coefficients in SI units; those of added mass'
// Coriolis terms (X_wq, Y_wp, ...) and of the fins at no deflection are among them. X_prop and K_prop [N, N m]: the
// propeller at the speed of which they are told; left out where the vehicle file has a propeller.
#include <array>
#include <cmath>

#include "common/model/manoeuvring/standard_set.hpp"

namespace fathom::model {
namespace remus_set {
namespace {

constexpr int kU = 0, kV = 1, kW = 2, kP = 3, kQ = 4, kR = 5;

template <int a, int b>
double product(const TermMotion& n) {
  return n[a] * n[b];
}
template <int a>
double square(const TermMotion& n) {
  return n[a] * std::abs(n[a]);
}
double always(const TermMotion&) { return 1.0; }
double by_rudder(const TermMotion& n) { return n[kU] * n[kU] * n.rudder; }
double by_plane(const TermMotion& n) { return n[kU] * n[kU] * n.plane; }

constexpr TermScale kPlain = TermScale::kPlain;
constexpr std::array<ManoeuvringTerm, 42> kTerms{
    {{"X_u|u|", 0, 0, square<kU>, kPlain},     {"X_wq", 0, 0, product<kW, kQ>, kPlain},
     {"X_qq", 0, 0, product<kQ, kQ>, kPlain},  {"X_vr", 0, 0, product<kV, kR>, kPlain},
     {"X_rr", 0, 0, product<kR, kR>, kPlain},  {"X_prop", 0, 0, always, kPlain},
     {"Y_v|v|", 1, 0, square<kV>, kPlain},     {"Y_r|r|", 1, 0, square<kR>, kPlain},
     {"Y_uv", 1, 0, product<kU, kV>, kPlain},  {"Y_wp", 1, 0, product<kW, kP>, kPlain},
     {"Y_ur", 1, 0, product<kU, kR>, kPlain},  {"Y_pq", 1, 0, product<kP, kQ>, kPlain},
     {"Y_uud", 1, 0, by_rudder, kPlain, true}, {"Z_w|w|", 2, 0, square<kW>, kPlain},
     {"Z_q|q|", 2, 0, square<kQ>, kPlain},     {"Z_uw", 2, 0, product<kU, kW>, kPlain},
     {"Z_uq", 2, 0, product<kU, kQ>, kPlain},  {"Z_vp", 2, 0, product<kV, kP>, kPlain},
     {"Z_rp", 2, 0, product<kR, kP>, kPlain},  {"Z_uud", 2, 0, by_plane, kPlain, true},
     {"K_p|p|", 3, 0, square<kP>, kPlain},     {"K_prop", 3, 0, always, kPlain},
     {"M_w|w|", 4, 0, square<kW>, kPlain},     {"M_q|q|", 4, 0, square<kQ>, kPlain},
     {"M_uw", 4, 0, product<kU, kW>, kPlain},  {"M_uq", 4, 0, product<kU, kQ>, kPlain},
     {"M_vp", 4, 0, product<kV, kP>, kPlain},  {"M_rp", 4, 0, product<kR, kP>, kPlain},
     {"M_uud", 4, 0, by_plane, kPlain, true},  {"N_v|v|", 5, 0, square<kV>, kPlain},
     {"N_r|r|", 5, 0, square<kR>, kPlain},     {"N_uv", 5, 0, product<kU, kV>, kPlain},
     {"N_ur", 5, 0, product<kU, kR>, kPlain},  {"N_wp", 5, 0, product<kW, kP>, kPlain},
     {"N_pq", 5, 0, product<kP, kQ>, kPlain},  {"N_uud", 5, 0, by_rudder, kPlain, true},
     {"X_vv", 0, 0, product<kV, kV>, kPlain},  {"X_ww", 0, 0, product<kW, kW>, kPlain},
     {"K_uv", 3, 0, product<kU, kV>, kPlain},  {"K_up", 3, 0, product<kU, kP>, kPlain},
     {"K_ur", 3, 0, product<kU, kR>, kPlain},  {"K_wp", 3, 0, product<kW, kP>, kPlain}}};

}  // namespace
}  // namespace remus_set

const StandardSet& remus() {
  static const StandardSet set{.name = "remus",
                               .source = "Prestero 2001",
                               .terms = remus_set::kTerms,
                               .moves = {true, true, true, true, true, true},
                               .coriolis = AddedCoriolis::kAmongTerms,
                               .pushed = pushed_but_for_steering};
  return set;
}

}  // namespace fathom::model
