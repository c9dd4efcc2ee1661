#include "common/joint/live_identifier.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "common/identification/mode_metrics.hpp"
#include "common/identification/projection.hpp"
#include "common/identification/saved_number.hpp"

namespace fathom::joint {
namespace {

constexpr char kMark[] = "joint estimate 1";

/// s beyond the joint estimate's own lag, for which MODEL waits for it.
constexpr double kPatience = 1.0;

}  // namespace

LiveIdentifier::LiveIdentifier(const identification::IdentifierSettings& settings, const model::Vehicle& vehicle)
    : vehicle_{std::make_unique<const model::Vehicle>(vehicle)}, recursive_{settings, vehicle} {}

LiveIdentifier::LiveIdentifier(const identification::IdentifierSettings& settings, const model::Vehicle& vehicle,
                               const JointSettings& joint, const estimation::NavigatorSettings& navigator,
                               const estimation::NavigatorPlaces& places)
    : LiveIdentifier{settings, vehicle} {
  make_ = [this, joint, settings, navigator, places] {
    return std::make_unique<JointEstimate>(joint, settings, navigator, places, *vehicle_);
  };
  joint_ = make_();
}

void LiveIdentifier::stash(const Output& output) {
  for (std::size_t i = 0; i < output.models.size(); ++i)
    pending_.push_back({output.models[i], output.residuals[i], output.blocks[i], output.bends[i]});
}

const LiveIdentifier::Output& LiveIdentifier::step(const StateEstimate& state) {
  const Output& output = recursive_.step(state);
  if (!joint_) return output;
  if (!offered_.empty()) resume_joint();
  stash(output);
  output_.clear();
  joint_->hear(state);
  while (const auto reached = joint_->next()) {
    while (!pending_.empty() && pending_.front().model.utime <= *reached) {
      teach(pending_.front().model);
      say(pending_.front(), true);
      pending_.pop_front();
    }
  }
  // An attitude that this process does not hear, or by another clock: MODEL must not fall silent over it.
  while (!pending_.empty() && seconds_between(pending_.front().model.utime, state.utime) > joint_->lag() + kPatience) {
    say(pending_.front(), false);
    pending_.pop_front();
    ++unreached_;
  }
  return output_;
}

const LiveIdentifier::Output& LiveIdentifier::step(const Thrusters& thrusters) {
  const Output& output = recursive_.step(thrusters);
  if (!joint_) return output;
  if (const auto tau = recursive_.wrench(thrusters)) joint_->hear(thrusters.utime, *tau);
  stash(output);
  output_.clear();
  return output_;
}

void LiveIdentifier::hear(const Excitation& excitation) {
  recursive_.hear(excitation);
  if (!joint_) return;
  std::vector<int> held;
  for (std::size_t i = 0; i < vehicle_->parameters.size(); ++i) {
    if (std::ranges::find(excitation.frozen, vehicle_->parameters[i]) != excitation.frozen.end())
      held.push_back(static_cast<int>(i));
  }
  joint_->hear(excitation.utime, std::move(held));
}

const LiveIdentifier::Output& LiveIdentifier::finish() {
  output_.clear();
  for (const Pending& pending : pending_) say(pending, true);
  pending_.clear();
  return output_;
}

// Linear in its parameters, the recursive estimate converges from anywhere; a Kalman filter on unknown inertias need
// not. What the joint estimate takes over is of samples before, and what it learns of samples after: none counts twice.
void LiveIdentifier::teach(const ModelEstimate& model) {
  if (joint_->started() || !model.effects.empty()) return;
  const auto n = static_cast<Eigen::Index>(model.parameters.size());
  ParameterVector mean(n);
  for (Eigen::Index i = 0; i < n; ++i) mean(i) = model.parameters[static_cast<std::size_t>(i)].value;
  joint_->offer(mean, Eigen::Map<const Eigen::MatrixXd>(model.covariance.data(), n, n));
}

bool LiveIdentifier::speaks(const ModelEstimate& model) const {
  return joint_ && joint_->started() && model.effects.empty();
}

// The residual is that of the model said before: nothing is explained by having been seen.
void LiveIdentifier::say(const Pending& pending, bool reached) {
  Residual residual = pending.residual;
  const bool joint = reached && speaks(pending.model);
  if (joint && said_.size() > 0) {
    for (const identification::Row& row : pending.rows.view())
      residual.wrench(row.axis) = row.y - row.h.head(said_.size()).dot(said_);
  }
  output_.residuals.push_back(residual);
  output_.models.push_back(joint ? with_joint(pending.model, pending.bend) : pending.model);
  const auto& said = output_.models.back().parameters;
  said_.resize(static_cast<Eigen::Index>(said.size()));
  for (std::size_t i = 0; i < said.size(); ++i) said_(static_cast<Eigen::Index>(i)) = said[i].value;
}

// What the model lacks bends both, each in its way: where the residual's test has failed, what they differ by is doubt.
ModelEstimate LiveIdentifier::with_joint(ModelEstimate model, const ParameterMatrix& bend) const {
  ParameterMatrix covariance = joint_->covariance();
  const ParameterVector estimate = identification::project_on_signs(joint_->estimate(), covariance, recursive_.signs());
  const auto n = covariance.rows();
  const ParameterVector nominal = covariance.diagonal();
  if ((model.residual_excess.array() > 0.0).any()) {
    ParameterVector apart(n);
    for (Eigen::Index k = 0; k < n; ++k) apart(k) = estimate(k) - model.parameters[static_cast<std::size_t>(k)].value;
    covariance += bend + apart * apart.transpose();
  }
  for (std::size_t i = 0; i < model.parameters.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    model.parameters[i].value = estimate(k);
    model.parameters[i].std = std::sqrt(covariance(k, k));
  }
  model.covariance.assign(covariance.data(), covariance.data() + n * n);
  model.joint = true;
  model.updates = joint_->rows();
  model.modes = identification::mode_metrics(joint_->filter().model().parameters(), nominal, estimate,
                                             covariance.diagonal().cwiseSqrt());
  return model;
}

ModelEstimate LiveIdentifier::model() const {
  ModelEstimate model = recursive_.model();
  return speaks(model) ? with_joint(std::move(model), recursive_.bend()) : model;
}

void LiveIdentifier::reset() {
  recursive_.reset();
  pending_.clear();
  said_.resize(0);
  unreached_ = 0;
  offered_.clear();
  output_.clear();
  if (make_) joint_ = make_();
}

std::map<std::string, std::int64_t> LiveIdentifier::rejected() const {
  auto all = recursive_.rejected();
  if (joint_) all.merge(joint_->rejected());
  if (unreached_ > 0) all["joint estimate: not reached, MODEL is the recursive one's"] = unreached_;
  return all;
}

std::string LiveIdentifier::save_text() const {
  std::string text = recursive_.save_text();
  if (!joint_ || !joint_->started()) return text;
  const ParameterVector mean = joint_->filter().parameters();
  const ParameterMatrix covariance = joint_->filter().parameter_covariance();
  text += std::string{kMark} + "\n";
  for (Eigen::Index i = 0; i < mean.size(); ++i) identification::put_number(text, mean(i));
  for (Eigen::Index i = 0; i < covariance.size(); ++i) identification::put_number(text, covariance.data()[i]);
  return text + "\nend\n";
}

void LiveIdentifier::offer(const std::string& text, double within) {
  recursive_.offer(text, within);
  const auto at = text.find(kMark);
  if (joint_ && at != std::string::npos) offered_ = text.substr(at + sizeof(kMark));
}

// The recursive estimate has decided by now whether that state is this vehicle's, this run's and fresh.
void LiveIdentifier::resume_joint() {
  std::istringstream text{std::exchange(offered_, {})};
  if (!recursive_.resumed()) return;
  const auto n = joint_->filter().model().size();
  ParameterVector mean(n);
  ParameterMatrix covariance(n, n);
  const auto take = [&] { return identification::take_number(text).value_or(NAN); };
  for (Eigen::Index i = 0; i < mean.size(); ++i) mean(i) = take();
  for (Eigen::Index i = 0; i < covariance.size(); ++i) covariance.data()[i] = take();
  std::string word;
  if (text >> word && word == "end") joint_->restore(mean, covariance);
}

}  // namespace fathom::joint
