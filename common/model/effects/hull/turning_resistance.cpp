// Physics: a craft that drifts or turns is slowed or driven on ahead by more than rigid-body and added-mass moments:
//   X_vr, X_vv, X_rr  of ships  and  X_wq, X_ww, X_qq  of submarines      (Abkowitz 1964; Fossen 2011, sec. 7.1)
// each a form w_X = c nu_r,i nu_r,j of its own. X_vr stands beside the base model's own m_Y v r, of which a ship's is a
// part (viscous flow takes the rest away). Ignores: terms of third order. Revealed by tight turns and oblique runs,
// compared with the same thrust straight ahead. Confused with m_Y (X_vr) and with centre_of_mass, whose x_G makes X_rr.
#include <array>

#include "common/model/speed_products.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kTurningResistanceParameters{
    EffectParameter{.name = "coefficient", .unit = "N/(m/s)^2", .sigma = 20.0}};

}  // namespace

const Effect& turning_resistance() {
  static const Effect kEffect{{.name = "turning_resistance",
                               .sentence = "Drifting and turning change the resistance ahead.",
                               .revealed_by = "tight turns and oblique runs beside straight ones at the same thrust",
                               .stage = Stage::kBody,
                               .amplitudes = 1,
                               .forms_coexist = true,
                               .feels_motion = false,
                               .own_flow = true},
                              kTurningResistanceParameters,
                              forms(SpeedProduct{0, 1, 5}, SpeedProduct{0, 1, 1}, SpeedProduct{0, 5, 5},
                                    SpeedProduct{0, 2, 4}, SpeedProduct{0, 2, 2}, SpeedProduct{0, 4, 4})};
  return kEffect;
}

}  // namespace fathom::model::effects
