// What MODEL says beside the parameters: metrics, recent residuals; and all that was learnt as text for a restart.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <utility>

#include "common/base/error.hpp"
#include "common/identification/identifier.hpp"
#include "common/identification/mode_metrics.hpp"
#include "common/identification/saved_number.hpp"

namespace fathom::identification {
namespace {

constexpr double kOfNoAccount = 0.05;  // of the noise's sigma: so small a mean is inside the intervals
constexpr double kFewest = 5.0;        // residuals before anything is said of them
constexpr double kEnough = 20.0;       // before the model is said to lack something
constexpr double kLargestRatio = 2.0;  // of the residual's power to that of the stated noise, as for leaving a mode
constexpr double kLargestCorrelation = 0.98;  // beyond this the factor says more about the sample than the noise
constexpr char kHeader[] = "fathom identifier 10";

double take(std::istringstream& text) {
  const std::optional<double> number = take_number(text);
  if (!number) throw InputError("identifier: the saved state is cut off");
  return *number;
}

}  // namespace

// The paper's sums (eq. 1.15) are over the covariance that the stated noise gives, in mixed units; beside them stands
// the largest relative standard deviation, honest about the residuals' colour.
void Identifier::add_metrics(ModelEstimate& estimate, const RecursiveReport& report) const {
  const ParameterMatrix nominal = estimator_.covariance();
  const auto n = static_cast<Eigen::Index>(parameters_.size());
  const ParameterMatrix honest = report.covariance.topLeftCorner(n, n);
  estimate.modes = mode_metrics(parameters_, nominal.diagonal().head(n), report.estimate.head(n), report.sigma.head(n));
  estimate.covariance.assign(honest.data(), honest.data() + n * n);
  estimate.frozen = frozen_;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    const Recent& r = recent_[axis];
    if (r.weight < kFewest) continue;
    const auto k = static_cast<Eigen::Index>(axis);
    estimate.residual_ratio[k] = r.square;
    const double variance = std::max(r.square - r.mean * r.mean, 1e-12);
    const double rho = std::clamp((r.product - r.mean * r.mean) / variance, 0.0, kLargestCorrelation);
    const double known = variance / r.weight * (1.0 + rho) / (1.0 - rho);
    const double offsets = moment_of_offsets(static_cast<int>(axis), report);
    estimate.residual_excess[k] = misfit_.excess()[k];
    estimate.residual_mean[k] = r.mean / std::sqrt(known + kOfNoAccount * kOfNoAccount + offsets * offsets);
  }
}

// An attitude that wanders about its offset leaves a moment that no half minute averages out, and so does a gyro's bias
// through the drag that it is taken for; neither is a fault of the model's. In the noise's sigmas, what the restoring
// moment makes of `attitude_offset`, and the drag's slope at the speeds of late of `rate_offset`.
double Identifier::moment_of_offsets(int axis, const RecursiveReport& report) const {
  if (axis < 3 || !(settings_.noise_moment > 0.0)) return 0.0;
  const auto of = [&](int parameter) {
    const int i = column(static_cast<model::BaseParameter>(parameter));
    return i < 0 ? 0.0 : report.estimate(i);
  };
  const double righting = axis < 5 ? of(static_cast<int>(model::BaseParameter::G_z)) : 0.0;
  const double slope = of(6 + axis) + 2.0 * of(12 + axis) * recent_[static_cast<std::size_t>(axis)].speed;
  return std::hypot(settings_.attitude_offset * righting, settings_.rate_offset * slope) / settings_.noise_moment;
}

void Identifier::remember(const RowBlock& block) {
  const double keep = std::exp(-settings_.stride / settings_.residual_memory);
  if (settings_.memory > 0.0) misfit_.forget(std::exp(-settings_.stride / settings_.memory));
  for (const Row& row : block.view()) {
    const auto axis = static_cast<std::size_t>(row.axis);
    // Scaled by the estimator so that it has the row's variance when the model is right.
    const double value = estimator_.state().axes[axis].last / std::sqrt(row.variance);
    Recent& r = recent_[axis];
    cost_ += value * value;
    const double product = value * r.last;
    r.weight = keep * r.weight + 1.0;
    const double share = 1.0 / r.weight;
    r.mean += share * (value - r.mean);
    r.square += share * (value * value - r.square);
    r.product += share * (product - r.product);
    r.last = value;
    misfit_.take(row, value * value, r.weight >= kEnough && r.square > kLargestRatio);
    const int quadratic = column(static_cast<model::BaseParameter>(12 + row.axis));  // its column is -|nu| nu
    if (quadratic >= 0) r.speed += share * (std::sqrt(std::abs(row.h(quadratic))) - r.speed);
  }
}

std::string Identifier::save_text() const {
  const RecursiveEstimator::State& s = estimator_.state();
  std::string text = std::string{kHeader} + "\n" + std::to_string(model_utime_) + " " + std::to_string(s.updates) +
                     " " + std::to_string(parameters_.size());
  for (const model::BaseParameter parameter : parameters_) text += " " + std::string{name(parameter)};
  text += "\n";
  if (track_) {
    const model::ActiveEffect& effect = track_->effect();
    text += std::string{effect.effect->name()} + " " + std::to_string(effect.variant) + " " + std::to_string(origin_) +
            (input_ == InputKind::kWrench ? " wrench " : " force ");
    for (const double value : effect.theta) put_number(text, value);
    for (Eigen::Index i = 0; i < linearised_at_.size(); ++i) put_number(text, linearised_at_(i));
  } else {
    text += "-";
  }
  text += "\n";
  const auto all = [&](const auto& values) {
    for (Eigen::Index i = 0; i < values.size(); ++i) put_number(text, values.data()[i]);
    text += "\n";
  };
  all(s.estimate);
  all(s.U);
  all(s.D);
  all(s.information);
  all(s.derivatives);
  all(s.score0);
  all(s.together);
  all(s.apart);
  all(s.fourth);
  all(s.last_scores);
  all(s.last_sums);
  put_number(text, s.oldest);
  put_number(text, s.steps);
  put_number(text, s.steps_until_check);
  for (const AxisStatistics& axis : s.axes) {
    for (const double value : {axis.weight, axis.mean, axis.variance, axis.covariance, axis.last})
      put_number(text, value);
  }
  for (const Recent& r : recent_) {
    for (const double value : {r.weight, r.mean, r.square, r.product, r.last, r.speed}) put_number(text, value);
  }
  all(misfit_.excess());
  for (const ParameterVector& information : misfit_.state().information) all(information);
  text += "\n" + std::to_string(frozen_.size());
  for (const std::string& name : frozen_) text += " " + name;
  return text + "\nend\n";
}

void Identifier::offer(const std::string& text, double within) {
  offered_ = text;
  offered_within_ = within;
}

void Identifier::decide(Utime first) {
  std::istringstream text{std::exchange(offered_, {})};
  std::string header;
  std::getline(text, header);
  Utime utime{};
  std::size_t count{};
  std::int64_t updates{};
  RecursiveEstimator::State s;
  if (header != kHeader) {
    ++rejected_["saved state of another version"];
    return;
  }
  if (!(text >> utime >> updates >> count) || count != parameters_.size()) return;
  const double age = seconds_between(utime, first);
  if (age < 0.0 || age > offered_within_) return;
  for (const model::BaseParameter parameter : parameters_) {
    std::string word;
    if (!(text >> word) || word != name(parameter)) return;
  }
  std::string effect_name;
  text >> effect_name;
  const model::Effect* effect = effect_name == "-" ? nullptr : model::find_effect(effect_name);
  if (effect_name != "-" && effect == nullptr) return;
  try {
    if (effect != nullptr) take_effect(*effect, text);
    s = estimator_.state();
    s.updates = updates;
    const auto all = [&](auto& values) {
      for (Eigen::Index i = 0; i < values.size(); ++i) values.data()[i] = take(text);
    };
    all(s.estimate);
    all(s.U);
    all(s.D);
    all(s.information);
    all(s.derivatives);
    all(s.score0);
    all(s.together);
    all(s.apart);
    all(s.fourth);
    all(s.last_scores);
    all(s.last_sums);
    s.oldest = static_cast<int>(take(text));
    s.steps = take(text);
    s.steps_until_check = take(text);
    for (AxisStatistics& axis : s.axes) {
      for (double* value : {&axis.weight, &axis.mean, &axis.variance, &axis.covariance, &axis.last})
        *value = take(text);
    }
    std::array<Recent, 6> recent{};
    for (Recent& r : recent) {
      for (double* value : {&r.weight, &r.mean, &r.square, &r.product, &r.last, &r.speed}) *value = take(text);
    }
    Misfit misfit{estimator_.size()};
    all(misfit.state().excess);
    for (ParameterVector& information : misfit.state().information) all(information);
    std::size_t frozen{};
    std::string word;
    std::vector<std::string> names;
    text >> frozen;
    while (names.size() < frozen && text >> word) names.push_back(word);
    if (!(text >> word) || word != "end") throw InputError("identifier: the saved state is cut off");
    estimator_.restore(s);
    recent_ = recent;
    misfit_ = misfit;
    frozen_ = names;
    for (const std::string& name : frozen_) freeze(name);
    model_utime_ = utime;
    resumed_ = true;
  } catch (const InputError&) {
    ++rejected_["saved state damaged"];
    track_.reset();
    estimator_ = RecursiveEstimator{estimator_settings(nullptr)};
  }
}

void Identifier::take_effect(const model::Effect& effect, std::istringstream& text) {
  model::ActiveEffect active{.effect = &effect};
  std::string input;
  if (!(text >> active.variant >> origin_ >> input) || active.variant < 0 || active.variant >= effect.form_count())
    throw InputError("identifier: the saved effect is damaged");
  input_ = input == "wrench" ? InputKind::kWrench : InputKind::kForce;
  for (std::size_t i = 0; i < effect.parameters().size(); ++i) active.theta.push_back(take(text));
  ParameterVector base(static_cast<Eigen::Index>(parameters_.size()));
  for (Eigen::Index i = 0; i < base.size(); ++i) base(i) = take(text);
  follow(std::move(active), base);
  estimator_ = RecursiveEstimator{estimator_settings(adopted())};
}

}  // namespace fathom::identification
