// One table says everything about every base parameter.
#include "common/model/parameters.hpp"

#include <array>
#include <cstddef>

namespace fathom::model {
namespace {

struct Row {
  std::string_view name;
  std::string_view unit;
  int axis;
  int sign;
};

/// By kind of the load (force, moment), kind of the velocity (m/s, rad/s), and power.
constexpr std::array<std::array<std::array<std::string_view, 3>, 2>, 2> kDrag{
    {{{{"N/(m/s)", "N/(m/s)^2", "N/(m/s)^3"}, {"N/(rad/s)", "N/(rad/s)^2", "N/(rad/s)^3"}}},
     {{{"N m/(m/s)", "N m/(m/s)^2", "N m/(m/s)^3"}, {"N m/(rad/s)", "N m/(rad/s)^2", "N m/(rad/s)^3"}}}}};
constexpr std::string_view kLinearForce = kDrag[0][0][0], kQuadraticForce = kDrag[0][0][1];
constexpr std::string_view kLinearMoment = kDrag[1][1][0], kQuadraticMoment = kDrag[1][1][1];
constexpr std::array<std::string_view, 3> kInertia{"kg", "kg m", "kg m^2"};  // by how many of the two axes turn

constexpr std::array<Row, kBaseParameterCount> kRows{{
    {"m_X", "kg", 0, +1},
    {"m_Y", "kg", 1, +1},
    {"m_Z", "kg", 2, +1},
    {"I_X", "kg m^2", 3, +1},
    {"I_Y", "kg m^2", 4, +1},
    {"I_Z", "kg m^2", 5, +1},
    {"X_u", kLinearForce, 0, -1},
    {"Y_v", kLinearForce, 1, -1},
    {"Z_w", kLinearForce, 2, -1},
    {"K_p", kLinearMoment, 3, -1},
    {"M_q", kLinearMoment, 4, -1},
    {"N_r", kLinearMoment, 5, -1},
    {"X_u|u|", kQuadraticForce, 0, -1},
    {"Y_v|v|", kQuadraticForce, 1, -1},
    {"Z_w|w|", kQuadraticForce, 2, -1},
    {"K_p|p|", kQuadraticMoment, 3, -1},
    {"M_q|q|", kQuadraticMoment, 4, -1},
    {"N_r|r|", kQuadraticMoment, 5, -1},
    {"W-B", "N", 2, 0},
    {"G_x", "N m", 4, 0},
    {"G_y", "N m", 3, 0},
    {"G_z", "N m", 3, 0},
}};

const Row& row(BaseParameter parameter) { return kRows[static_cast<std::size_t>(index(parameter))]; }

constexpr std::array<BaseParameter, kBaseParameterCount> kAll = [] {
  std::array<BaseParameter, kBaseParameterCount> all{};
  for (int i = 0; i < kBaseParameterCount; ++i) all[static_cast<std::size_t>(i)] = static_cast<BaseParameter>(i);
  return all;
}();

}  // namespace

std::string_view name(BaseParameter parameter) { return row(parameter).name; }
std::string_view unit(BaseParameter parameter) { return row(parameter).unit; }
std::string_view drag_unit(int row, int column, int power) {
  return kDrag[row < 3 ? 0 : 1][column < 3 ? 0 : 1][static_cast<std::size_t>(power - 1)];
}
std::string_view inertia_unit(int row, int column) { return kInertia[(row < 3 ? 0U : 1U) + (column < 3 ? 0U : 1U)]; }
int axis(BaseParameter parameter) { return row(parameter).axis; }
int sign_constraint(BaseParameter parameter) { return row(parameter).sign; }
std::span<const BaseParameter> base_parameters() { return kAll; }

std::optional<BaseParameter> parameter_from_name(std::string_view name) {
  for (const BaseParameter parameter : kAll) {
    if (row(parameter).name == name) return parameter;
  }
  return std::nullopt;
}

}  // namespace fathom::model
