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

constexpr std::string_view kLinearForce = "N/(m/s)";
constexpr std::string_view kLinearMoment = "N m/(rad/s)";
constexpr std::string_view kQuadraticForce = "N/(m/s)^2";
constexpr std::string_view kQuadraticMoment = "N m/(rad/s)^2";

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
