// Features of a free force as columns that pass through the filter.
#pragma once

#include <vector>

#include "common/inference/scan.hpp"

namespace fathom::inference {

/// Features as accelerations at the seen model's states. `groups`: indices into the library.
class FeatureColumns {
 public:
  FeatureColumns(const likelihood::Problem& problem, const Seen& seen, const likelihood::FreeForce& library,
                 std::vector<std::size_t> groups, std::size_t run);
  [[nodiscard]] std::size_t size() const { return features_.size(); }
  void at(std::size_t block, likelihood::ColumnsOut acceleration);

 private:
  const likelihood::Problem& problem_;
  const Seen& seen_;
  std::vector<likelihood::Feature> features_;
  bool operators_{};
  std::size_t run_;
  std::vector<likelihood::Number> none_;
  likelihood::Plant plant_;
};

}  // namespace fathom::inference
