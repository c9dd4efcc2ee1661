// Standard equations of submarine motion: products of two velocities, with the sign or the size of one, made
// dimensionless by powers of the length (M. Gertler and G. R. Hagen, "Standard equations of motion for submarine
// simulation", DTNSRDC 2510, 1967; J. Feldman, DTNSRDC/SPD-0393-09, 1979). Added mass' Coriolis terms are among them.
#include <array>
#include <cmath>

#include "common/model/actuators.hpp"
#include "common/model/manoeuvring/standard_set.hpp"

namespace fathom::model {
namespace gertler_submarine_set {
namespace {

double cubed_over_speed(const TermMotion& n) {
  const double speed = n.nu_r.head<3>().norm();
  return speed > 0.0 ? n[2] * n[2] * n[2] / speed : 0.0;
}

// clang-format off
constexpr std::array<ManoeuvringTerm, 70> kTerms{{
    {"X_uu", 0, 2, [](const TermMotion& n) { return n[0] * n[0]; }},
    {"X_uw", 0, 2, [](const TermMotion& n) { return n[0] * n[2]; }},
    {"X_vv", 0, 2, [](const TermMotion& n) { return n[1] * n[1]; }},
    {"X_ww", 0, 2, [](const TermMotion& n) { return n[2] * n[2]; }},
    {"X_uv", 0, 2, [](const TermMotion& n) { return n[0] * n[1]; }},
    {"X_vr", 0, 3, [](const TermMotion& n) { return n[1] * n[5]; }},
    {"X_wq", 0, 3, [](const TermMotion& n) { return n[2] * n[4]; }},
    {"X_qq", 0, 4, [](const TermMotion& n) { return n[4] * n[4]; }},
    {"X_rr", 0, 4, [](const TermMotion& n) { return n[5] * n[5]; }},
    {"X_rp", 0, 4, [](const TermMotion& n) { return n[5] * n[3]; }},
    {"Y_uu", 1, 2, [](const TermMotion& n) { return n[0] * n[0]; }},
    {"Y_uv", 1, 2, [](const TermMotion& n) { return n[0] * n[1]; }},
    {"Y_vw", 1, 2, [](const TermMotion& n) { return n[1] * n[2]; }},
    {"Y_ur", 1, 3, [](const TermMotion& n) { return n[0] * n[5]; }},
    {"Y_up", 1, 3, [](const TermMotion& n) { return n[0] * n[3]; }},
    {"Y_wp", 1, 3, [](const TermMotion& n) { return n[2] * n[3]; }},
    {"Y_vq", 1, 3, [](const TermMotion& n) { return n[1] * n[4]; }},
    {"Y_wr", 1, 3, [](const TermMotion& n) { return n[2] * n[5]; }},
    {"Y_pq", 1, 4, [](const TermMotion& n) { return n[3] * n[4]; }},
    {"Y_qr", 1, 4, [](const TermMotion& n) { return n[4] * n[5]; }},
    {"Y_v|v|", 1, 2, [](const TermMotion& n) { return n[1] * std::abs(n[1]); }},
    {"Y_p|p|", 1, 4, [](const TermMotion& n) { return n[3] * std::abs(n[3]); }},
    {"Y_r|r|", 1, 4, [](const TermMotion& n) { return n[5] * std::abs(n[5]); }},
    {"Z_uu", 2, 2, [](const TermMotion& n) { return n[0] * n[0]; }},
    {"Z_uw", 2, 2, [](const TermMotion& n) { return n[0] * n[2]; }},
    {"Z_vv", 2, 2, [](const TermMotion& n) { return n[1] * n[1]; }},
    {"Z_uq", 2, 3, [](const TermMotion& n) { return n[0] * n[4]; }},
    {"Z_vr", 2, 3, [](const TermMotion& n) { return n[1] * n[5]; }},
    {"Z_vp", 2, 3, [](const TermMotion& n) { return n[1] * n[3]; }},
    {"Z_pp", 2, 4, [](const TermMotion& n) { return n[3] * n[3]; }},
    {"Z_rr", 2, 4, [](const TermMotion& n) { return n[5] * n[5]; }},
    {"Z_rp", 2, 4, [](const TermMotion& n) { return n[5] * n[3]; }},
    {"Z_w|w|", 2, 2, [](const TermMotion& n) { return n[2] * std::abs(n[2]); }},
    {"Z_q|q|", 2, 4, [](const TermMotion& n) { return n[4] * std::abs(n[4]); }},
    {"K_uu", 3, 3, [](const TermMotion& n) { return n[0] * n[0]; }},
    {"K_uv", 3, 3, [](const TermMotion& n) { return n[0] * n[1]; }},
    {"K_vw", 3, 3, [](const TermMotion& n) { return n[1] * n[2]; }},
    {"K_up", 3, 4, [](const TermMotion& n) { return n[0] * n[3]; }},
    {"K_ur", 3, 4, [](const TermMotion& n) { return n[0] * n[5]; }},
    {"K_vq", 3, 4, [](const TermMotion& n) { return n[1] * n[4]; }},
    {"K_wp", 3, 4, [](const TermMotion& n) { return n[2] * n[3]; }},
    {"K_wr", 3, 4, [](const TermMotion& n) { return n[2] * n[5]; }},
    {"K_pq", 3, 5, [](const TermMotion& n) { return n[3] * n[4]; }},
    {"K_qr", 3, 5, [](const TermMotion& n) { return n[4] * n[5]; }},
    {"K_v|vw|", 3, 3, [](const TermMotion& n) { return n[1] * std::hypot(n[1], n[2]); }},
    {"K_p|p|", 3, 5, [](const TermMotion& n) { return n[3] * std::abs(n[3]); }},
    {"M_uu", 4, 3, [](const TermMotion& n) { return n[0] * n[0]; }},
    {"M_uw", 4, 3, [](const TermMotion& n) { return n[0] * n[2]; }},
    {"M_vv", 4, 3, [](const TermMotion& n) { return n[1] * n[1]; }},
    {"M_uq", 4, 4, [](const TermMotion& n) { return n[0] * n[4]; }},
    {"M_vp", 4, 4, [](const TermMotion& n) { return n[1] * n[3]; }},
    {"M_vr", 4, 4, [](const TermMotion& n) { return n[1] * n[5]; }},
    {"M_pp", 4, 5, [](const TermMotion& n) { return n[3] * n[3]; }},
    {"M_rr", 4, 5, [](const TermMotion& n) { return n[5] * n[5]; }},
    {"M_rp", 4, 5, [](const TermMotion& n) { return n[5] * n[3]; }},
    {"M_www/U", 4, 3, [](const TermMotion& n) { return cubed_over_speed(n); }},
    {"M_w|w|", 4, 3, [](const TermMotion& n) { return n[2] * std::abs(n[2]); }},
    {"M_q|q|", 4, 5, [](const TermMotion& n) { return n[4] * std::abs(n[4]); }},
    {"N_uu", 5, 3, [](const TermMotion& n) { return n[0] * n[0]; }},
    {"N_uv", 5, 3, [](const TermMotion& n) { return n[0] * n[1]; }},
    {"N_vw", 5, 3, [](const TermMotion& n) { return n[1] * n[2]; }},
    {"N_up", 5, 4, [](const TermMotion& n) { return n[0] * n[3]; }},
    {"N_ur", 5, 4, [](const TermMotion& n) { return n[0] * n[5]; }},
    {"N_vq", 5, 4, [](const TermMotion& n) { return n[1] * n[4]; }},
    {"N_wp", 5, 4, [](const TermMotion& n) { return n[2] * n[3]; }},
    {"N_wr", 5, 4, [](const TermMotion& n) { return n[2] * n[5]; }},
    {"N_pq", 5, 5, [](const TermMotion& n) { return n[3] * n[4]; }},
    {"N_qr", 5, 5, [](const TermMotion& n) { return n[4] * n[5]; }},
    {"N_v|v|", 5, 3, [](const TermMotion& n) { return n[1] * std::abs(n[1]); }},
    {"N_r|r|", 5, 5, [](const TermMotion& n) { return n[5] * std::abs(n[5]); }},
}};
// clang-format on

}  // namespace
}  // namespace gertler_submarine_set

const StandardSet& gertler_submarine() {
  static const StandardSet set{.name = "gertler_submarine",
                               .source = "Gertler and Hagen 1967, Feldman 1979",
                               .terms = gertler_submarine_set::kTerms,
                               .moves = {true, true, true, true, true, true},
                               .coriolis = AddedCoriolis::kAmongTerms,
                               .pushed = acting_wrench};
  return set;
}

}  // namespace fathom::model
