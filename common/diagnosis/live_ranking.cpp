// From samples to filtered rows, from rows to a verdict.
#include <algorithm>
#include <cmath>

#include "common/diagnosis/evidence.hpp"
#include "common/diagnosis/live_diagnoser.hpp"

namespace fathom::diagnosis {
namespace {

constexpr Utime kPastStep = 20'000;       // us between commands kept for delays
constexpr std::size_t kPastLength = 100;  // of those: 2 s, longer than the longest delay
constexpr double kModelDelay = 2.0;       // s: more than the identifier is late
constexpr std::size_t kMostModels = 100;  // of MODEL that are remembered
constexpr std::size_t kPastMost = 2 * kPastLength;

}  // namespace

void LiveDiagnoser::record_input(const Sample& sample) {
  const auto end = [&] { return past_begin_ + static_cast<Utime>(past_.size()) * kPastStep; };
  if (past_.empty() || sample.motion.utime - end() > static_cast<Utime>(kPastLength) * kPastStep) {
    past_.assign(1, Eigen::VectorXd{sample.force});
    past_begin_ = sample.motion.utime;
  }
  while (end() <= sample.motion.utime) {
    const auto input = aligner_.input_at(end());
    past_.push_back(input ? Eigen::VectorXd{sample.boost * *input} : past_.back());
  }
  if (candidates_ && past_.size() > kPastMost) {  // the warm-up needs all of its own
    const std::size_t old = past_.size() - kPastLength;
    past_.erase(past_.begin(), past_.begin() + static_cast<std::ptrdiff_t>(old));
    past_begin_ += static_cast<Utime>(old) * kPastStep;
  }
}

void LiveDiagnoser::use(const Sample& sample, std::optional<EffectRanking>& ranking) {
  Candidates& c = *candidates_;
  const auto rows = regressor_.step(sample.motion);
  if (!sample.motion.valid) {
    c.columns.reset();
    c.filled = 0;
    last_.reset();
    return;
  }
  const double elapsed = last_ ? seconds_between(last_->motion.utime, sample.motion.utime) : 0.0;
  if (elapsed > settings_.max_gap) {
    c.columns.reset();
    c.filled = 0;
  }
  if (!regressor_.took()) return;
  const model::InputSignal past{seconds_between(*origin_, past_begin_), 1e-6 * static_cast<double>(kPastStep), past_};
  const model::Motion motion{.t = seconds_between(*origin_, sample.motion.utime),
                             .p_WB = sample.p_WB,
                             .R_WB = sample.q_WB.toRotationMatrix(),
                             .nu = sample.motion.nu,
                             .force = sample.force,
                             .voltage = sample.voltage,
                             .input = &past,
                             .vehicle = vehicle_.get()};
  const model::ActuatorForces middle =
      last_ ? model::ActuatorForces{0.5 * (last_->force + sample.force)} : sample.force;
  c.columns.step(motion, middle, elapsed, c.wrench[c.next], c.momentum[c.next]);
  c.next = (c.next + 1) % c.wrench.size();
  c.filled = std::min(c.filled + 1, c.wrench.size());
  last_ = sample;
  if (!rows) return;
  // The instant of a row is its window's end: blocks close by message time alone.
  const auto block = static_cast<std::int64_t>(seconds_between(*origin_, rows->end) / settings_.block);
  if (block_ && block != *block_) {
    c.evidence.close_block();
    ranking = rank(rows->end);
  }
  block_ = block;
  if (sample.has_position) places_.add(sample.p_WB);
  add(*rows);
}

void LiveDiagnoser::add(const identification::RowBlock& block) {
  Candidates& c = *candidates_;
  const auto average = regressor_.average();
  const auto derivative = regressor_.derivative();
  const std::size_t count = average.size();
  if (count > c.filled) return;
  const Eigen::Index base = prior_mean_.size();
  WrenchColumns& filtered = c.filtered;
  WrenchColumns& rate = c.rate;
  filtered.setZero();
  rate.setZero();
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = (c.next + c.wrench.size() - count + i) % c.wrench.size();
    filtered += average[i] * c.wrench[at];
    rate += derivative[i] * c.momentum[at];
  }
  for (Eigen::Index i = 0; i < rate.cols(); ++i) {
    filtered.col(c.columns.inertial()[static_cast<std::size_t>(i)]) -= rate.col(i);
  }
  c.evidence.next_instant();
  for (const identification::Row& row : block.view()) {
    c.row.head(base) = row.h;
    c.row[base] = row.y - row.h.dot(prior_mean_);
    c.row.tail(filtered.cols()) = filtered.row(row.axis).transpose();
    c.row /= sigma_[row.axis];
    c.evidence.add(row.axis, c.row, row.y / sigma_[row.axis]);
  }
}

EffectRanking LiveDiagnoser::rank(Utime utime) {
  EffectRanking ranking{.utime = utime, .verdict = "collecting"};
  rivals_.reset();
  if (!candidates_) return ranking;
  const LiveEvidence& evidence = candidates_->evidence;
  if (evidence.blocks() < static_cast<std::size_t>(settings_.fewest_blocks)) return ranking;
  suspicions_ = evidence.judge();
  std::erase_if(suspicions_, [&](const LiveSuspicion& s) {
    const LiveForm& form = forms()[static_cast<std::size_t>(s.form)];
    return places_.rule_out(*form.effect, s.theta, form.variant);
  });
  const auto convinces = [&](const LiveSuspicion& s) {
    return s.log_odds >= settings_.accept_log_odds && s.error_reduction >= settings_.smallest_reduction;
  };
  // Odds say whether; among those that convince, the one that explains most comes first.
  const auto doubtful = std::stable_partition(suspicions_.begin(), suspicions_.end(), convinces);
  std::stable_sort(suspicions_.begin(), doubtful, [](const LiveSuspicion& a, const LiveSuspicion& b) {
    return a.error_reduction > b.error_reduction;
  });
  const auto effect_of = [&](const LiveSuspicion& s) { return forms()[static_cast<std::size_t>(s.form)].effect; };
  std::vector<const LiveSuspicion*> best;  // of each effect, in order
  for (const LiveSuspicion& suspicion : suspicions_) {
    const bool known = std::any_of(best.begin(), best.end(),
                                   [&](const LiveSuspicion* b) { return effect_of(*b) == effect_of(suspicion); });
    if (known) continue;
    best.push_back(&suspicion);
    ranking.candidates.push_back({.name = std::string{effect_of(suspicion)->name()},
                                  .log_odds = suspicion.log_odds,
                                  .error_reduction = suspicion.error_reduction,
                                  .variant = forms()[static_cast<std::size_t>(suspicion.form)].variant_name,
                                  .numbers = suspicion.theta});
  }
  if (best.empty() || !convinces(*best.front())) {
    ranking.verdict = evidence.structured() || leaves_much(utime) ? "unexplained" : "adequate";
    return ranking;
  }
  const LiveSuspicion& winner = *best.front();
  const auto rival = std::find_if(best.begin() + 1, best.end(), [&](const LiveSuspicion* other) {
    return convinces(*other) && evidence.likeness(winner, *other) > settings_.alias_correlation &&
           robust_log_likelihood_ratio(other->block_cost, winner.block_cost) < settings_.alternative_log_odds;
  });
  if (rival == best.end()) {
    ranking.verdict = "effect";
    return ranking;
  }
  const auto active = [&](const LiveSuspicion& s) {
    const LiveForm& form = forms()[static_cast<std::size_t>(s.form)];
    return model::ActiveEffect{form.effect, form.variant, form.variant_name, s.theta};
  };
  ranking.verdict = "ambiguous";
  ranking.against = effect_of(**rival)->name();
  rivals_.emplace(active(winner), active(**rival));
  return ranking;
}

void LiveDiagnoser::hear(const ModelEstimate& model) {
  if (!left_.empty() && model.utime <= left_.back().utime) return;
  left_.push_back({model.utime, model.residual_ratio.maxCoeff()});
  if (left_.size() > kMostModels) left_.pop_front();
}

// A residual that forgets within a second shows no memory here, but its power gives it away. Models count by their time
// stamps, kModelDelay after them, so that it does not matter when they arrived.
bool LiveDiagnoser::leaves_much(Utime utime) {
  if (settings_.largest_ratio <= 0.0) return false;
  double ratio = 0.0;
  for (const Left& left : left_) {
    if (seconds_between(left.utime, utime) >= kModelDelay) ratio = left.ratio;
  }
  return ratio > settings_.largest_ratio;
}

void LiveDiagnoser::forget_motion() {
  warm_up_.clear();
  past_.clear();
  last_.reset();
  origin_.reset();
  block_.reset();
}

void LiveDiagnoser::reset() {
  forget_motion();
  newest_ = 0;
  source_ = Source::kUnknown;
  aligner_.reset();
  regressor_.reset();
  candidates_.reset();
  left_.clear();
  places_.clear();
  suspicions_.clear();
  rivals_.reset();
}

}  // namespace fathom::diagnosis
