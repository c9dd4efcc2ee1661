// The base model's parameters: fixed order, names as in vehicle files and reports, units, axes and physical signs.
#pragma once

#include <optional>
#include <span>
#include <string_view>

namespace fathom::model {

/// Parameters of the lumped Fossen model. Masses are rigid plus added: m_X = m - X_udot, I_X = I_x - K_pdot.
/// Drag derivatives are negative where they dissipate. W_B is weight minus buoyancy (positive sinks).
/// G = r_G W - r_B B: the restoring moment is G x (down in body axes).
// clang-format off
enum class BaseParameter {
  m_X, m_Y, m_Z, I_X, I_Y, I_Z,
  X_u, Y_v, Z_w, K_p, M_q, N_r,
  X_uu, Y_vv, Z_ww, K_pp, M_qq, N_rr,
  W_B, G_x, G_y, G_z
};
// clang-format on

constexpr int kBaseParameterCount = 22;

constexpr int index(BaseParameter parameter) { return static_cast<int>(parameter); }

/// "m_X", "X_u", "X_u|u|", "W-B", "G_z": the spelling of vehicle files, results and messages.
[[nodiscard]] std::string_view name(BaseParameter parameter);
/// "kg", "N/(m/s)^2", ...
[[nodiscard]] std::string_view unit(BaseParameter parameter);
/// Of a load on axis `row` (0..5 = X Y Z K M N) per velocity of axis `column` (u v w p q r) to the power 1, 2 or 3.
[[nodiscard]] std::string_view drag_unit(int row, int column, int power);
/// Of an element of the mass matrix: "kg", "kg m" or "kg m^2".
[[nodiscard]] std::string_view inertia_unit(int row, int column);
/// 0..5 = X Y Z K M N: the axis whose equation the parameter belongs to (W-B: Z, G_x: M, G_y: K, G_z: K).
/// Masses, W-B and G enter other axes' equations too.
[[nodiscard]] int axis(BaseParameter parameter);
/// +1: physics wants it positive (masses); -1: negative (drag); 0: either.
[[nodiscard]] int sign_constraint(BaseParameter parameter);
/// Nothing when no parameter has this name.
[[nodiscard]] std::optional<BaseParameter> parameter_from_name(std::string_view name);
/// All of them, in order.
[[nodiscard]] std::span<const BaseParameter> base_parameters();

}  // namespace fathom::model
