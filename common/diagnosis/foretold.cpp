#include "common/diagnosis/foretold.hpp"

#include <algorithm>
#include <cmath>

#include "common/diagnosis/moved.hpp"
#include "common/diagnosis/words.hpp"
#include "common/model/dynamics.hpp"
#include "common/residual/whiteness.hpp"

namespace fathom::diagnosis {

constexpr double kHorizon = 5.0;  // s

std::vector<Foretold> badly_foretold(const DiagnosisResult& result) {
  std::vector<Foretold> axes;
  for (const PredictionError& error : result.error_after.prediction) {
    if (error.horizon_s != kHorizon) continue;
    for (const AxisWhiteness& axis : result.residual_after) {
      const auto i =
          static_cast<std::size_t>(std::ranges::find(model::kAxisNames, axis.axis) - model::kAxisNames.begin());
      if (axis.p_value < kNotRandom && error.p_half[i] < kNotRandom)
        axes.push_back({axis.axis, error.r2[i], error.p_average[i] < kNotRandom});
    }
  }
  return axes;
}

std::string hardly_shown_sentence(const DiagnosisResult& result) {
  constexpr double kLittle = 0.5;  // R2
  std::vector<std::string> axes;
  for (const PredictionError& error : result.error_after.prediction) {
    for (std::size_t i = 0; error.horizon_s == kHorizon && i < 6; ++i) {
      if (error.r2[i] < kLittle) axes.emplace_back(model::kVelocityNames[i]);
    }
  }
  return axes.empty() ? ""
                      : "Of the motion along " + joined(axes) +
                            " the validation runs show too little to tell whether the model foretells it. ";
}

std::string foretold_sentence(const std::vector<Foretold>& axes) {
  if (axes.empty()) return "";
  std::vector<std::string> words;
  words.reserve(axes.size());
  for (const Foretold& one : axes)
    words.push_back((one.share > 0.0 ? percent(one.share) : "nothing") + " of the motion along " + one.axis);
  return "5 s ahead the model foretells " + joined(words) + ". ";
}

bool foretells_nothing(const DiagnosisResult& result, const model::Scene& fitted, const Vector6d& left) {
  constexpr double kHalf = 0.5;  // of the motion's power
  for (Eigen::Index axis = 0; axis < 6; ++axis) {
    const double motion = fitted.nu_rms[axis] * fitted.nu_rms[axis];
    if (fitted.vehicle->dof[static_cast<std::size_t>(axis)] && left[axis] * left[axis] < kHalf * motion) return false;
  }
  bool asked = false;
  for (const PredictionError& error : result.error_after.prediction) {
    for (std::size_t i = 0; error.horizon_s == kHorizon && i < 6; ++i) {
      if (error.r2[i] > 0.0) return false;
      asked = asked || std::isfinite(error.r2[i]);
    }
  }
  return asked;
}

std::vector<std::string> not_followed(const DiagnosisResult& result, const std::vector<Foretold>& foretold) {
  std::vector<std::string> axes = astray(result.residual_after);
  std::erase_if(axes, [&](const std::string& name) {
    const auto& all = result.residual_after;
    const auto axis = std::ranges::find(all, name, &AxisWhiteness::axis);
    return axis->explained + axis->noise > 0.0 && std::ranges::find(foretold, name, &Foretold::axis) == foretold.end();
  });
  return axes;
}

}  // namespace fathom::diagnosis
