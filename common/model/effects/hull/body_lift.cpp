// Physics: a hull that goes at an angle to its path lifts, as its fins do, and its Munk moment is not the ideal one of
// its added masses: forces and moments as products of the speed ahead and of the speed across or of turning, on
//   Y and N by v and r,  Z and M by w and q      (Y_uv, N_uv, Y_ur, N_ur, Z_uw, M_uw, Z_uq, M_uq: Prestero 2001,
//   sec. 4.3
// and 4.5; Feldman 1979), each a form of its own: w_i = c u_r nu_r,j, which turns round when the craft goes astern, as
// Munk's moment does, beside what the base model's added masses make of the same product; and w_i = c |u_r| nu_r,j,
// which does not, as fins that lift either way. What fixed fins do at no deflection is among them. Ignores: stall.
// Revealed by drifting and turning at several speeds ahead and astern, and at rest. Confused with linear drag across at
// one speed, with masses that serve inertia and Coriolis moment at once, and with speed_drag.
#include <array>

#include "common/model/speed_products.hpp"

namespace fathom::model::effects {
namespace {

constexpr std::array kBodyLiftParameters{EffectParameter{.name = "coefficient", .unit = "N/(m/s)^2", .sigma = 20.0}};

constexpr Eigen::Index kU = 0;

Forms every_product() {
  using Sense = SpeedProduct::Sense;
  constexpr std::array<std::array<Eigen::Index, 2>, 8> kLoadedBy{
      {{1, 1}, {5, 1}, {1, 5}, {5, 5}, {2, 2}, {4, 2}, {2, 4}, {4, 4}}};
  Forms all;
  for (const Sense sense : {Sense::kWithSign, Sense::kEitherWay}) {
    for (const auto& [row, column] : kLoadedBy) all.push_back(std::make_unique<SpeedProduct>(row, kU, column, sense));
  }
  return all;
}

}  // namespace

const Effect& body_lift() {
  static const Effect kEffect{
      {.name = "body_lift",
       .sentence = "The hull lifts: drifting and turning load it in proportion to its speed ahead.",
       .revealed_by = "drifting and turning at rest, at half and at full speed ahead",
       .stage = Stage::kBody,
       .amplitudes = 1,
       .forms_coexist = true,
       .feels_motion = false},
      kBodyLiftParameters,
      every_product()};
  return kEffect;
}

}  // namespace fathom::model::effects
