// Ships in surge, sway and yaw: a Taylor series to the third order in u - U_0, v, r and the rudder's angle d about a
// straight course at the speed U_0 (M. A. Abkowitz, "Lectures on ship hydrodynamics", HyA 5, Lyngby 1964; J.
// Stroem-Tejsen, "A digital computer technique for prediction of standard maneuvers of surface ships", DTMB 2130,
// 1965). Coefficients by 1/2 rho, powers of the length and the speed U through the water (SNAME's prime system); u in a
// name stands for u - U_0, letters in the order u v r d. The propeller, at the speed that keeps U_0, is among them, and
// so is the rudder. Many tables hold the rigid body's Coriolis terms as well (`rigid_coriolis: among_coefficients`).
#include <array>

#include "common/model/manoeuvring/series.hpp"
#include "common/model/manoeuvring/standard_set.hpp"

namespace fathom::model {
namespace abkowitz_set {
namespace {

template <int a, int b, int c, int e>
constexpr ManoeuvringTerm term(std::string_view name, int axis) {
  return series_term<a, b, c, e>(name, axis, TermScale::kLength);
}

constexpr std::array<ManoeuvringTerm, 61> kTerms{
    {term<0, 0, 0, 0>("X_0", 0),   term<1, 0, 0, 0>("X_u", 0),   term<2, 0, 0, 0>("X_uu", 0),
     term<3, 0, 0, 0>("X_uuu", 0), term<0, 2, 0, 0>("X_vv", 0),  term<0, 0, 2, 0>("X_rr", 0),
     term<0, 0, 0, 2>("X_dd", 0),  term<1, 2, 0, 0>("X_uvv", 0), term<1, 0, 2, 0>("X_urr", 0),
     term<1, 0, 0, 2>("X_udd", 0), term<0, 1, 1, 0>("X_vr", 0),  term<0, 1, 0, 1>("X_vd", 0),
     term<0, 0, 1, 1>("X_rd", 0),  term<1, 1, 1, 0>("X_uvr", 0), term<1, 1, 0, 1>("X_uvd", 0),
     term<1, 0, 1, 1>("X_urd", 0), term<0, 0, 0, 0>("Y_0", 1),   term<1, 0, 0, 0>("Y_0u", 1),
     term<2, 0, 0, 0>("Y_0uu", 1), term<0, 1, 0, 0>("Y_v", 1),   term<0, 3, 0, 0>("Y_vvv", 1),
     term<0, 1, 2, 0>("Y_vrr", 1), term<0, 1, 0, 2>("Y_vdd", 1), term<1, 1, 0, 0>("Y_uv", 1),
     term<2, 1, 0, 0>("Y_uuv", 1), term<0, 0, 1, 0>("Y_r", 1),   term<0, 0, 3, 0>("Y_rrr", 1),
     term<0, 2, 1, 0>("Y_vvr", 1), term<0, 0, 1, 2>("Y_rdd", 1), term<1, 0, 1, 0>("Y_ur", 1),
     term<2, 0, 1, 0>("Y_uur", 1), term<0, 0, 0, 1>("Y_d", 1),   term<0, 0, 0, 3>("Y_ddd", 1),
     term<0, 2, 0, 1>("Y_vvd", 1), term<0, 0, 2, 1>("Y_rrd", 1), term<1, 0, 0, 1>("Y_ud", 1),
     term<2, 0, 0, 1>("Y_uud", 1), term<0, 1, 1, 1>("Y_vrd", 1), term<0, 0, 0, 0>("N_0", 5),
     term<1, 0, 0, 0>("N_0u", 5),  term<2, 0, 0, 0>("N_0uu", 5), term<0, 1, 0, 0>("N_v", 5),
     term<0, 3, 0, 0>("N_vvv", 5), term<0, 1, 2, 0>("N_vrr", 5), term<0, 1, 0, 2>("N_vdd", 5),
     term<1, 1, 0, 0>("N_uv", 5),  term<2, 1, 0, 0>("N_uuv", 5), term<0, 0, 1, 0>("N_r", 5),
     term<0, 0, 3, 0>("N_rrr", 5), term<0, 2, 1, 0>("N_vvr", 5), term<0, 0, 1, 2>("N_rdd", 5),
     term<1, 0, 1, 0>("N_ur", 5),  term<2, 0, 1, 0>("N_uur", 5), term<0, 0, 0, 1>("N_d", 5),
     term<0, 0, 0, 3>("N_ddd", 5), term<0, 2, 0, 1>("N_vvd", 5), term<0, 0, 2, 1>("N_rrd", 5),
     term<1, 0, 0, 1>("N_ud", 5),  term<2, 0, 0, 1>("N_uud", 5), term<0, 1, 1, 1>("N_vrd", 5),
     term<0, 0, 0, 1>("X_d", 0)}};

}  // namespace
}  // namespace abkowitz_set

const StandardSet& abkowitz_3() {
  static const StandardSet set{.name = "abkowitz_3",
                               .source = "Abkowitz 1964, Stroem-Tejsen 1965",
                               .terms = abkowitz_set::kTerms,
                               .moves = {true, true, false, false, false, true},
                               .coriolis = AddedCoriolis::kAmongTerms,
                               .needs_cruise = true,
                               .pushed = pushed_but_for_steering};
  return set;
}

}  // namespace fathom::model
