#include "common/report/folds.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>

#include "common/base/error.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::report {
namespace {

constexpr double kAhead = 10.0;  // s, the longest horizon that is predicted

const std::array<double, 6>* errors(const ModelError& of) {
  const auto found = std::ranges::find(of.prediction, kAhead, &PredictionError::horizon_s);
  return found == of.prediction.end() ? nullptr : &found->rmse;
}

std::string joined(const std::vector<std::string>& words, const std::string& none) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text.empty() ? none : text;
}

std::vector<std::string> accepted(const DiagnosisResult& result) {
  std::vector<std::string> names;
  for (const EffectFound& effect : result.effects) {
    if (effect.accepted) names.push_back(effect.name);
  }
  return names;
}

/// Squares of errors over folds, each as heavy as the others.
class Pooled {
 public:
  void add(const std::array<double, 6>& rmse) {
    for (std::size_t i = 0; i < 6; ++i) {
      if (!std::isfinite(rmse[i])) continue;
      squares_[i] += rmse[i] * rmse[i];
      count_[i] += 1.0;
    }
  }
  [[nodiscard]] double operator[](std::size_t axis) const {
    return count_[axis] > 0.0 ? std::sqrt(squares_[axis] / count_[axis]) : std::nan("");
  }

 private:
  std::array<double, 6> squares_{}, count_{};
};

/// "u .030 -> .021" of each axis that is simulated.
template <class Errors>
std::string change(const Errors& before, const Errors& after) {
  std::string text;
  for (std::size_t i = 0; i < 6; ++i) {
    if (!std::isfinite(before[i])) continue;
    std::array<char, 64> part{};
    std::snprintf(part.data(), part.size(), "  %s %.4f -> %.4f", model::kVelocityNames[i], before[i], after[i]);
    text += part.data();
  }
  return text;
}

}  // namespace

std::vector<Fold> folds_of(std::vector<std::string> paths, int count) {
  std::ranges::sort(paths);  // a run that is named twice would judge a fit of itself
  paths.erase(std::unique(paths.begin(), paths.end()), paths.end());
  if (paths.size() < 2)
    throw InputError("--folds: at least two recordings are needed, " + std::to_string(paths.size()) +
                     " is given; without --folds the end of every recording judges");
  const std::size_t folds = std::min(static_cast<std::size_t>(count), paths.size());
  std::vector<Fold> all(folds);
  for (std::size_t i = 0; i < paths.size(); ++i) {
    for (std::size_t k = 0; k < folds; ++k) (i % folds == k ? all[k].held_out : all[k].fitted).push_back(paths[i]);
  }
  return all;
}

std::string fold_table(const std::vector<DiagnosisResult>& results) {
  std::string text = "leave-run-out validation: error 10 s ahead (m/s, rad/s), base model -> with what was found\n";
  Pooled before, after;
  std::map<std::string, std::size_t> found;
  for (std::size_t k = 0; k < results.size(); ++k) {
    const DiagnosisResult& result = results[k];
    const std::vector<std::string> names = accepted(result);
    for (const std::string& name : names) ++found[name];
    text += "fold " + std::to_string(k + 1) + ", held out " + joined(result.validate, "nothing") + ": " +
            result.verdict + " (" + joined(names, "no effect") + ")\n";
    const auto *base = errors(result.error_before), *with = errors(result.error_after);
    if (base == nullptr || with == nullptr) continue;
    before.add(*base);
    after.add(*with);
    text += " " + change(*base, *with) + "\n";
  }
  text += "all folds\n " + change(before, after) + "\n";
  for (const auto& [name, times] : found)
    text += name + ": found in " + std::to_string(times) + " of " + std::to_string(results.size()) + "\n";
  return text;
}

}  // namespace fathom::report
