#include "common/inference/feature_columns.hpp"

#include <algorithm>

namespace fathom::inference {

FeatureColumns::FeatureColumns(const likelihood::Problem& problem, const Seen& seen,
                               const likelihood::FreeForce& library, std::vector<std::size_t> groups, std::size_t run)
    : problem_{problem}, seen_{seen}, run_{run}, plant_{seen.fit.hypothesis, none_, problem.runs[run], run, false} {
  for (const std::size_t g : groups) {
    const likelihood::FeatureGroup& group = library.groups[g];
    for (int j = group.first; j < group.first + group.count; ++j)
      features_.push_back(library.features[static_cast<std::size_t>(j)]);
  }
  operators_ = std::ranges::any_of(
      features_, [](const likelihood::Feature& feature) { return feature.streams() || feature.weighs(); });
  plant_.begin(problem.runs[run].start());
}

void FeatureColumns::at(std::size_t block, likelihood::ColumnsOut acceleration) {
  const auto b = static_cast<Eigen::Index>(block);
  plant_.at_middle(block);
  const likelihood::FeatureState state = plant_.features_at(seen_.reference[run_].nu_middle.col(b), operators_);
  const Matrix6d inverse = seen_.inverse[run_].col(b).reshaped(6, 6);
  for (std::size_t j = 0; j < features_.size(); ++j) {
    Vector6d wrench = Vector6d::Zero();
    features_[j].add(state, 1.0, wrench);
    const Vector6d nu_dot = inverse * wrench;
    for (int i = 0; i < seen_.reference[run_].axes; ++i)
      acceleration(i, static_cast<Eigen::Index>(j)) =
          i < problem_.simulated ? nu_dot[problem_.axes[static_cast<std::size_t>(i)]] : 0.0;
  }
  plant_.end_block(block, seen_.reference[run_].nu_end.col(b));
}

}  // namespace fathom::inference
