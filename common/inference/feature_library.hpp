// What a free force may run over: groups of smooth functions, one kind and one axis each, scaled to the applied wrench.
#pragma once

#include "common/inference/scan.hpp"

namespace fathom::inference {

/// Library of a seen model. Own linear and quadratic drag and own thrust are left out: base numbers hold them.
[[nodiscard]] likelihood::FreeForce feature_library(const likelihood::Problem& problem, const Seen& seen,
                                                    const model::Scene& scene);

/// Components of the lever of weight and buoyancy that are felt where these axes move.
[[nodiscard]] std::vector<int> levers_that_turn(const std::vector<int>& axes);

/// Two strongest lines, from `lowest` [rad/s] on, of the likelihood's slope with a force toward world axis `w`.
/// `slope`: likelihood::adjoint per run.
[[nodiscard]] std::vector<double> strongest_tones(const likelihood::Problem& problem,
                                                  const std::vector<Eigen::MatrixXd>& slope, int w, double lowest);

/// Features as accelerations at the seen model's states. `groups`: indices into the library.
class FeatureColumns {
 public:
  FeatureColumns(const likelihood::Problem& problem, const Seen& seen, const likelihood::FreeForce& library,
                 std::vector<std::size_t> groups, std::size_t run);
  [[nodiscard]] std::size_t size() const { return features_.size(); }
  void at(std::size_t block, likelihood::RowMatrix& acceleration);

 private:
  const likelihood::Problem& problem_;
  const Seen& seen_;
  std::vector<likelihood::Feature> features_;
  bool streams_{};
  std::size_t run_;
  std::vector<likelihood::Number> none_;
  likelihood::Plant plant_;
};

}  // namespace fathom::inference
