// What a rule or a term of the inference is good for shows where it is taken out: `fathom diagnose --ablate NAME` and
// `./check --sealed --ablate NAME`, on the same sets with and without. docs/benchmark.md has what came of it.
#pragma once

#include <span>
#include <string_view>

#include "common/inference/infer.hpp"

namespace fathom::inference {

struct Ablation {
  std::string_view name;
  std::string_view what;  ///< is taken out
  void (*take_out)(Settings& settings);
};

[[nodiscard]] std::span<const Ablation> ablations();

/// Takes out the rule or term of this name. InputError, with all names, where there is none.
void ablate(std::string_view name, Settings& settings);

}  // namespace fathom::inference
