// The library as a product: every term of the base model times every modulator. Most of what no list holds is a known
// term that something slow or other changes: buoyancy that creeps, drag that depends on depth, thrust that weakens with
// the craft's own speed, a current that sets in.
#pragma once

#include "common/inference/scan.hpp"

namespace fathom::inference {

/// Groups appended to `force`, one per term and modulator, not scaled yet. `adjoint`: per run, d log L / d
/// acceleration. Moments and frequencies are those at which the likelihood's slope with the term itself is largest.
void add_products(const likelihood::Problem& problem, const Seen& seen, const model::Scene& scene,
                  const std::vector<Eigen::MatrixXd>& adjoint, likelihood::FreeForce& force);

}  // namespace fathom::inference
