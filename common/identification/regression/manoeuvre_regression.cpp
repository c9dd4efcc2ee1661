#include "common/identification/regression/manoeuvre_regression.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/identification/regression/term_errors.hpp"
#include "common/model/derivative_motion.hpp"
#include "common/model/manoeuvres.hpp"

namespace fathom::identification {

AxisCandidates candidates_of(int axis, const model::StandardSet& set) {
  AxisCandidates candidates;
  for (const model::ManoeuvringTerm& term : set.terms) {
    if (term.axis != axis || term.steers || term.other >= 0) continue;
    candidates.names.emplace_back(term.name);
    candidates.terms.push_back(&term);
  }
  return candidates;
}

Eigen::MatrixXd columns_of(const std::vector<ManoeuvreRows::Row>& stretch, int axis, const AxisCandidates& candidates,
                           const model::Vehicle& vehicle, const Eigen::Vector3d& v_WF) {
  const model::Hydrodynamics& h = *vehicle.hydrodynamics;
  const auto columns = static_cast<Eigen::Index>(candidates.terms.size());
  Eigen::VectorXd scale(columns);
  for (Eigen::Index j = 0; j < columns; ++j) {
    scale[j] =
        model::manoeuvring_scale(*candidates.terms[static_cast<std::size_t>(j)], h.lengths(vehicle.water_density));
  }
  Eigen::MatrixXd z(static_cast<Eigen::Index>(stretch.size()), columns + 1);
  for (std::size_t n = 0; n < stretch.size(); ++n) {
    const auto& row = stretch[n];
    const auto i = static_cast<Eigen::Index>(n);
    const Eigen::Vector3d v_F = row.q_WB.conjugate() * (row.v_WF + v_WF);
    Vector6d nu_r = row.nu;
    nu_r.head<3>() -= v_F;
    const Vector6d b = model::hydrodynamic_wrench(vehicle, row.q_WB, row.nu, row.nu_dot, row.known) -
                       model::water_wrench(vehicle, row.nu.tail<3>(), v_F, row.q_WB.conjugate() * row.a_WF);
    model::TermMotion motion{nu_r};
    motion.cruise = h.cruise;
    for (Eigen::Index j = 0; j < columns; ++j) {
      z(i, j) = scale[j] * candidates.terms[static_cast<std::size_t>(j)]->value(motion);
    }
    z(i, columns) = b[axis];
  }
  return z;
}

LaggedGram gram_of(const ManoeuvreRows& rows, int axis, const AxisCandidates& candidates, const model::Vehicle& vehicle,
                   const RegressionSettings& settings) {
  LaggedGram gram{static_cast<Eigen::Index>(candidates.terms.size()) + 1};
  const int block = static_cast<int>(std::lround(std::max(2.0, settings.block / rows.dt)));
  for (const auto& stretch : rows.stretches) {
    gram.add(columns_of(stretch, axis, candidates, vehicle, settings.v_WF), block);
  }
  return gram;
}

std::vector<AxisRegression> regress(const model::Vehicle& vehicle, std::span<const ManoeuvreRows> runs,
                                    const RegressionSettings& settings) {
  need_hydrodynamics(vehicle);
  std::vector<AxisRegression> result;
  for (int axis = 0; axis < 6; ++axis) {
    AxisRegression& one = result.emplace_back();
    one.axis = axis;
    one.candidates = candidates_of(axis, *vehicle.hydrodynamics->set);
    std::vector<LaggedGram> grams;
    for (const ManoeuvreRows& run : runs) {
      grams.push_back(gram_of(run, axis, one.candidates, vehicle, settings));
      one.manoeuvres.push_back(stepwise({grams.back()}, one.candidates.names, settings.stepwise));
      if (settings.errors) add_term_errors(vehicle, {&run, 1}, axis, one.candidates, settings, one.manoeuvres.back());
    }
    if (runs.size() > 1) {
      one.together = stepwise(grams, one.candidates.names, settings.stepwise);
      if (settings.errors) add_term_errors(vehicle, runs, axis, one.candidates, settings, one.together);
    } else {
      one.together = one.manoeuvres.front();
    }
  }
  return result;
}

Eigen::Vector3d estimate_current(const model::Vehicle& vehicle, std::span<const ManoeuvreRows> runs,
                                 RegressionSettings settings) {
  constexpr std::array<int, 3> kAxes{0, 1, 5};
  constexpr double kFinest = 0.002, kFirst = 0.1, kFastest = 1.0;  // m/s
  const auto cost = [&](const Eigen::Vector3d& v_WF) {
    settings.v_WF = v_WF;
    double sum = 0.0;
    for (const int axis : kAxes) {
      const AxisCandidates candidates = candidates_of(axis, *vehicle.hydrodynamics->set);
      LaggedGram gram{static_cast<Eigen::Index>(candidates.names.size()) + 1};
      for (const ManoeuvreRows& run : runs) gram.add(gram_of(run, axis, candidates, vehicle, settings));
      const StepwiseResult fit = stepwise({gram}, candidates.names, settings.stepwise);
      sum += fit.samples * std::log(std::max(fit.sigma, 1e-12));
    }
    return sum;
  };
  Eigen::Vector3d best = Eigen::Vector3d::Zero();
  double least = cost(best);
  for (double step = kFirst; step > kFinest;) {
    bool better = false;
    for (const Eigen::Vector3d& way :
         {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(-1, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, -1, 0)}) {
      const Eigen::Vector3d there = best + step * way;
      if (there.norm() > kFastest) continue;
      const double now = cost(there);
      if (now >= least) continue;
      least = now;
      best = there;
      better = true;
    }
    if (!better) step *= 0.5;
  }
  return best;
}

}  // namespace fathom::identification
