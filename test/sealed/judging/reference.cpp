#include "test/sealed/judging/reference.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace fathom::sealed {
namespace {

constexpr double kHorizon = 5.0, kStride = 5.0, kWindow = 10.0;  // s, as fathom diagnose predicts
constexpr std::size_t kBlock = 4;                                // samples that are averaged to 25 Hz

Vector6 block_noise(const Dive& run, std::size_t k) {
  Vector6 sum = Vector6::Zero();
  for (std::size_t i = k; i < k + kBlock; ++i) sum += run.nu_noise[i];
  return sum / static_cast<double>(kBlock);
}

/// Sums over the windows of one file.
struct Errors {
  Vector6 square{Vector6::Zero()}, sum{Vector6::Zero()}, power{Vector6::Zero()};
  double count{};
};

void predict(const Dive& run, std::size_t first, Body& body, bool with_memory, Errors& errors) {
  const auto window = static_cast<std::size_t>(std::lround(kWindow / run.dt));
  const auto horizon = static_cast<std::size_t>(std::lround(kHorizon / run.dt));
  const auto stride = static_cast<std::size_t>(std::lround(kStride / run.dt));
  const double h = run.dt;
  for (std::size_t start = first; start + window + kBlock < run.size(); start += stride) {
    State state = with_memory ? run.state[start] : State(run.state[start].head<kMemory>());
    state.segment<6>(kSpeed) += block_noise(run, start);
    for (std::size_t k = 0; k < horizon; ++k) {
      body.step(run.begin + static_cast<double>(start + k) * h, h, run.commands, state);
      if ((k + 1) % kBlock != 0) continue;
      const std::size_t at = start + k + 1;
      const Vector6 truth = run.state[at].segment<6>(kSpeed), measured = truth + block_noise(run, at);
      errors.square += (state.segment<6>(kSpeed) - measured).cwiseAbs2();
      errors.sum += measured;
      errors.power += measured.cwiseAbs2();
      errors.count += 1.0;
    }
  }
}

double normalised(const Craft& craft, const Errors& errors) {
  double sum = 0.0, axes = 0.0;
  for (int i = 0; i < 6; ++i) {
    if (!craft.moves[static_cast<std::size_t>(i)]) continue;
    const double mean = errors.sum[i] / errors.count, variance = errors.power[i] / errors.count - mean * mean;
    sum += std::sqrt(errors.square[i] / errors.count / variance);
    axes += 1.0;
  }
  return sum / axes;
}

/// One number or one entry of the state at a window's beginning, moved a little.
struct Nudge {
  Eigen::Index number{-1}, entry{-1};
  double by{};
};

Eigen::VectorXd bound(const SealedSet& set, double length, bool all_signals) {
  static const Mechanisms kNone;
  const Craft& craft = set.craft;
  const Eigen::VectorXd truth = base_values(craft, craft.hull);
  const Eigen::Index numbers = truth.size();
  std::vector<Nudge> nudges;
  for (Eigen::Index j = 0; j < numbers; ++j)
    nudges.push_back({.number = j, .by = 1e-4 * std::max(std::abs(truth[j]), 0.1)});
  std::vector<Eigen::Index> signals;  // of the state that are compared
  for (int i = 0; i < 6; ++i) {
    const bool driven = craft.moves[static_cast<std::size_t>(i)];
    if (driven || all_signals) signals.push_back(kSpeed + i);
    if (all_signals) signals.push_back(kPose + i);
  }
  for (const Eigen::Index entry : signals) nudges.push_back({.entry = entry, .by = 1e-5});
  const auto count = static_cast<Eigen::Index>(nudges.size());
  Eigen::VectorXd sigma(kMemory);
  sigma << Eigen::Vector3d::Constant(set.noise.position), Eigen::Vector3d::Constant(set.noise.angle),
      Eigen::Vector3d::Constant(set.noise.velocity), Eigen::Vector3d::Constant(set.noise.rate);

  Body body(craft, kNone);
  std::vector<Hull> hulls;
  for (const Nudge& nudge : nudges) {
    Eigen::VectorXd values = truth;
    if (nudge.number >= 0) values[nudge.number] += nudge.by;
    hulls.push_back(hull_with(craft, craft.hull, values));
  }
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(numbers, numbers);
  Eigen::MatrixXd slope(static_cast<Eigen::Index>(signals.size()), count);
  for (const Dive& run : set.train) {
    const auto window = static_cast<std::size_t>(std::lround(length / run.dt));
    for (std::size_t start = 0; start + window <= run.size(); start += window) {
      Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(count, count);
      State plain = run.state[start].head<kMemory>();
      std::vector<State> moved(nudges.size(), plain);
      for (std::size_t j = 0; j < nudges.size(); ++j) {
        if (nudges[j].entry >= 0) moved[j][nudges[j].entry] += nudges[j].by;
      }
      constexpr std::size_t kEvery = 2;  // sensitivities are smooth: half of the steps do
      for (std::size_t k = 0; k < window; k += kEvery) {
        const double t = run.begin + static_cast<double>(start + k) * run.dt;
        for (std::size_t j = 0; j < nudges.size(); ++j) {
          for (std::size_t s = 0; s < signals.size(); ++s) {
            slope(static_cast<Eigen::Index>(s), static_cast<Eigen::Index>(j)) =
                (moved[j][signals[s]] - plain[signals[s]]) / nudges[j].by / sigma[signals[s]];
          }
        }
        normal.selfadjointView<Eigen::Lower>().rankUpdate(slope.transpose(), static_cast<double>(kEvery));
        body.hull = craft.hull;
        body.step(t, kEvery * run.dt, run.commands, plain);
        for (std::size_t j = 0; j < nudges.size(); ++j) {
          body.hull = hulls[j];
          body.step(t, kEvery * run.dt, run.commands, moved[j]);
        }
        if (!all_signals) {  // poses and rates without a model are taken as measured: they do not carry a nudge on
          for (State& one : moved) {
            one.head<6>() = plain.head<6>();
            for (int i = 0; i < 6; ++i) {
              if (!craft.moves[static_cast<std::size_t>(i)]) one[kSpeed + i] = plain[kSpeed + i];
            }
          }
        }
      }
      normal = normal.selfadjointView<Eigen::Lower>();
      const Eigen::Index free = count - numbers;
      const Eigen::MatrixXd mixed = normal.topRightCorner(numbers, free);
      information += normal.topLeftCorner(numbers, numbers) -
                     mixed * normal.bottomRightCorner(free, free).ldlt().solve(mixed.transpose());
    }
  }
  return information.ldlt().solve(Eigen::MatrixXd::Identity(numbers, numbers)).diagonal().cwiseMax(0.0).cwiseSqrt();
}

}  // namespace

Floor prediction_floor(const SealedSet& set) {
  static const Mechanisms kNone;
  constexpr double kHeldOut = 0.3;  // of a single file, as fathom diagnose keeps
  const Dive& run = set.validate ? *set.validate : set.train.back();
  const auto first =
      set.validate ? std::size_t{0} : static_cast<std::size_t>((1.0 - kHeldOut) * static_cast<double>(run.size()));
  // Nobody can predict noise, however well its spectrum is known.
  const bool noise = set.plan.kind == Kind::kNoise;
  Floor floor;
  Errors errors;
  Body truth(set.craft, noise ? kNone : set.mechanisms);
  predict(run, first, truth, !noise, errors);
  floor.truth = normalised(set.craft, errors);
  floor.truth_rmse = (errors.square / errors.count).cwiseSqrt();
  Body base(set.craft, kNone);
  base.hull = hull_with(set.craft, set.craft.hull, set.fit.values);
  Errors plain;
  predict(run, first, base, false, plain);
  floor.base = normalised(set.craft, plain);
  // The best fit to accelerations may diverge when it has to predict: no error is then too large.
  if (!std::isfinite(floor.base)) floor.base = std::numeric_limits<double>::infinity();
  return floor;
}

Bound cramer_rao(const SealedSet& set) { return {bound(set, kWindow, false), bound(set, 30.0, true)}; }

}  // namespace fathom::sealed
