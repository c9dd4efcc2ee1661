#include "common/diagnosis/live_screening.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace fathom::diagnosis {
namespace {

using identification::IntegralRegressor;
using identification::RowBlock;

constexpr std::size_t kPastLength = 100;  // commands: 2 s, longer than the longest delay
constexpr std::size_t kPastMost = 2 * kPastLength;
constexpr double kSmallestMass = 0.1;  // of the prior mean: keeps a poor first fit physical

std::vector<LiveEvidence::Mass> masses_of(const LiveBasis& basis) {
  std::vector<LiveEvidence::Mass> masses;
  for (std::size_t i = 0; i < basis.parameters.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    if (model::sign_constraint(basis.parameters[i]) > 0) masses.push_back({column, basis.prior_mean[column]});
  }
  return masses;
}

template <class Use>
void for_each_valid(const SeenTrial& seen, const Use& use) {
  LiveSample sample;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    seen.get(i, sample);
    if (sample.motion.valid) use(sample);
  }
}

LiveSample first_of(const SeenTrial& seen) {
  LiveSample sample;
  for (std::size_t i = 0; !sample.motion.valid; ++i) seen.get(i, sample);
  return sample;
}

}  // namespace

LiveScreening::LiveScreening(const LiveBasis& basis, const SeenTrial& seen, const std::optional<Vector6d>& sigma)
    : basis_{basis}, origin_{first_of(seen).motion.utime}, regressor_{basis.integral} {
  const model::Model base = base_of(seen);
  if (sigma) sigma_ = *sigma;
  Eigen::VectorXd information(basis_.prior_mean.size() + turns());
  information.tail(turns()).setConstant(std::pow(basis_.mounting, -2));
  for (Eigen::Index i = 0; i < basis_.prior_mean.size(); ++i) {
    information[i] = std::pow(basis_.vehicle.priors[static_cast<std::size_t>(i)].sigma, -2);
  }
  scene_ = scene_of(seen);
  columns_ = std::make_unique<LiveCandidates>(base, scene_);
  evidence_ = std::make_unique<LiveEvidence>(*columns_, information, masses_of(basis_), basis_.most_blocks);
  const auto inertial = static_cast<Eigen::Index>(columns_->inertial().size());
  wrench_.assign(regressor_.capacity(), WrenchColumns::Zero(6, columns_->columns() + LiveCandidates::kTurns));
  momentum_.assign(regressor_.capacity(), WrenchColumns::Zero(6, inertial));
  filtered_.setZero(6, columns_->columns() + LiveCandidates::kTurns);
  rate_.setZero(6, inertial);
  row_.setZero(information.size() + 1 + columns_->columns());
}

std::optional<Utime> LiveScreening::use(const LiveSample& sample, bool behind) {
  if (sample.commands_from) {
    past_.clear();
    past_begin_ = *sample.commands_from;
  }
  past_.insert(past_.end(), sample.commands.begin(), sample.commands.end());
  if (past_.size() > kPastMost) {
    const std::size_t old = past_.size() - kPastLength;
    past_.erase(past_.begin(), past_.begin() + static_cast<std::ptrdiff_t>(old));
    past_begin_ += static_cast<Utime>(old) * kCommandStep;
  }
  const auto rows = regressor_.step(sample.motion);
  if (!sample.motion.valid) {
    columns_->reset();
    filled_ = 0;
    before_.reset();
    return {};
  }
  const double elapsed = before_ ? seconds_between(before_->utime, sample.motion.utime) : 0.0;
  if (elapsed > basis_.max_gap) {
    columns_->reset();
    filled_ = 0;
  }
  if (!regressor_.took()) return {};
  const model::InputSignal past{seconds_between(origin_, past_begin_), 1e-6 * static_cast<double>(kCommandStep), past_};
  const model::Motion motion{.t = seconds_between(origin_, sample.motion.utime),
                             .p_WB = sample.p_WB,
                             .R_WB = sample.q_WB.toRotationMatrix(),
                             .nu = sample.motion.nu,
                             .force = sample.force,
                             .voltage = sample.voltage,
                             .input = &past,
                             .vehicle = &basis_.vehicle};
  const model::ActuatorForces middle =
      before_ ? model::ActuatorForces{0.5 * (before_->force + sample.force)} : sample.force;
  columns_->step(motion, middle, elapsed, wrench_[next_], momentum_[next_]);
  next_ = (next_ + 1) % wrench_.size();
  filled_ = std::min(filled_ + 1, wrench_.size());
  before_ = {sample.motion.utime, sample.force};
  if (!rows) return {};
  // The instant of a row is its window's end: blocks close by message time alone.
  const auto block = static_cast<std::int64_t>(seconds_between(origin_, rows->end) / basis_.block);
  const bool closed = block_ && block != *block_;
  if (closed) evidence_->close_block();
  if (closed && !behind) evidence_->project();
  block_ = block;
  if (sample.has_position) places_.add(sample.p_WB);
  add(*rows);
  return closed ? std::optional{rows->end} : std::nullopt;
}

void LiveScreening::add(const identification::RowBlock& block) {
  const auto average = regressor_.average();
  const auto derivative = regressor_.derivative();
  const std::size_t count = average.size();
  if (count > filled_) return;
  const Eigen::Index base = basis_.prior_mean.size();
  filtered_.setZero();
  rate_.setZero();
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = (next_ + wrench_.size() - count + i) % wrench_.size();
    filtered_ += average[i] * wrench_[at];
    rate_ += derivative[i] * momentum_[at];
  }
  for (Eigen::Index i = 0; i < rate_.cols(); ++i) {
    filtered_.col(columns_->inertial()[static_cast<std::size_t>(i)]) -= rate_.col(i);
  }
  evidence_->next_instant();
  for (const identification::Row& row : block.view()) {
    row_.head(base) = row.h;
    row_.segment(base, turns()) = filtered_.row(row.axis).segment(columns_->columns(), turns()).transpose();
    row_[base + turns()] = row.y - row.h.dot(basis_.prior_mean);
    row_.tail(columns_->columns()) = filtered_.row(row.axis).head(columns_->columns()).transpose();
    row_ /= sigma_[row.axis];
    evidence_->add(row.axis, row_, row.y / sigma_[row.axis]);
  }
}

model::Scene LiveScreening::scene_of(const SeenTrial& seen) const {
  model::Scene scene{.vehicle = &basis_.vehicle, .position = true, .attitude = true, .velocity = true, .rates = true};
  scene.input_is_wrench = basis_.input_is_wrench;
  const LiveSample first = first_of(seen);
  scene.duration = seconds_between(first.motion.utime, seen.last());
  scene.t_high = scene.duration;
  scene.p_low = scene.p_high = first.p_WB;
  scene.force_rms = model::ActuatorForces::Zero(basis_.nominal.allocation.cols());
  double low = first.voltage, high = first.voltage;
  double count = 0.0;
  for_each_valid(seen, [&](const LiveSample&) { count += 1.0; });
  for_each_valid(seen, [&](const LiveSample& sample) {
    scene.position = scene.position && sample.has_position;
    scene.p_low = scene.p_low.cwiseMin(sample.p_WB).eval();
    scene.p_high = scene.p_high.cwiseMax(sample.p_WB).eval();
    scene.nu_rms += sample.motion.nu.cwiseAbs2();
    scene.tau_rms += sample.motion.tau.cwiseAbs2();
    scene.force_rms += sample.force.cwiseAbs2();
    scene.mean_voltage += sample.voltage / count;
    low = std::min(low, sample.voltage);
    high = std::max(high, sample.voltage);
  });
  scene.nu_rms = (scene.nu_rms / count).cwiseSqrt().eval();
  scene.tau_rms = (scene.tau_rms / count).cwiseSqrt().eval();
  scene.force_rms = (scene.force_rms / count).cwiseSqrt().eval();
  scene.voltage = low > 0.0;
  scene.voltage_range = high - low;
  return scene;
}

// A first fit of the base model: drag and masses for effects that alter what the hull feels, and the size of the
// residual per axis, which weighs the axes against each other.
model::Model LiveScreening::base_of(const SeenTrial& seen) {
  IntegralRegressor regressor{basis_.integral};
  std::vector<RowBlock> blocks;
  LiveSample sample;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    seen.get(i, sample);
    if (const auto block = regressor.step(sample.motion)) blocks.push_back(*block);
  }
  const Eigen::Index n = basis_.prior_mean.size();
  Vector6d scale = Vector6d::Zero();
  Vector6d count = Vector6d::Zero();
  for (const RowBlock& block : blocks) {
    for (const auto& row : block.view()) {
      scale[row.axis] += row.y * row.y;
      count[row.axis] += 1.0;
    }
  }
  Vector6d& sigma = sigma_;
  sigma = (scale.array() / count.array().max(1.0)).sqrt().max(1e-3) * 0.1;
  Eigen::VectorXd theta = basis_.prior_mean;
  for (int round = 0; round < 3; ++round) {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double prior = basis_.vehicle.priors[static_cast<std::size_t>(i)].sigma;
      normal(i, i) = 1.0 / (prior * prior);
      right[i] = basis_.prior_mean[i] / (prior * prior);
    }
    for (const RowBlock& block : blocks) {
      for (const auto& row : block.view()) {
        const double weight = 1.0 / (sigma[row.axis] * sigma[row.axis]);
        normal += weight * row.h * row.h.transpose();
        right += weight * row.y * row.h;
      }
    }
    theta = normal.ldlt().solve(right);
    Vector6d square = Vector6d::Zero();
    for (const RowBlock& block : blocks) {
      for (const auto& row : block.view()) square[row.axis] += std::pow(row.y - row.h.dot(theta), 2);
    }
    for (int axis = 0; axis < 6; ++axis) {
      const double freedom = std::max(count[axis] - 4.0, 1.0);  // about four parameters per axis
      if (count[axis] > 0.0) sigma[axis] = std::max(std::sqrt(square[axis] / freedom), 1e-4);
    }
  }
  model::Model model = basis_.nominal;
  for (std::size_t i = 0; i < basis_.parameters.size(); ++i) {
    double value = theta[static_cast<Eigen::Index>(i)];
    const double mean = basis_.prior_mean[static_cast<Eigen::Index>(i)];
    if (model::sign_constraint(basis_.parameters[i]) > 0) value = std::max(value, kSmallestMass * mean);
    if (model::sign_constraint(basis_.parameters[i]) < 0) value = std::min(value, 0.0);
    model.theta[model::index(basis_.parameters[i])] = value;
  }
  return model;
}

}  // namespace fathom::diagnosis
