#include "common/inference/free_force.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "common/base/parallel.hpp"

namespace fathom::inference {
namespace {

constexpr double kStartSigma = 0.03;  // of the applied wrench: weights before their group's variance is known
constexpr double kLeastSigma = 1e-4;
constexpr double kMostSigma =
    1.0;  // groups that nearly cancel would else stand for anything with weights of thousands of per cent
constexpr int kTurns = 5;               // of the variances
constexpr std::size_t kShortlist = 24;  // groups whose products with all others are worked out
constexpr double kFactor = 4.0;         // by which the second start's random force is smaller
constexpr int kBatch = 48;              // columns that pass through the filter together
constexpr double kSettled = 4.0;        // times the odds that are needed: no second start could change the verdict

using Range = std::pair<Eigen::Index, Eigen::Index>;

struct Screen {
  std::vector<std::size_t> groups;  // of the library
  std::vector<Range> ranges;        // of the columns
  Eigen::MatrixXd gram;             // projected
  Eigen::VectorXd gradient;
};

/// `relatives`: effects whose columns come last; all products are worked out with them.
Screen screen(const likelihood::Problem& problem, const Seen& seen, const likelihood::FreeForce& library,
              const std::vector<std::size_t>& groups, bool all, std::span<const model::ActiveEffect> relatives = {}) {
  Screen screen{.groups = groups};
  std::vector<std::size_t> beginnings;
  std::size_t columns = 0;
  for (const std::size_t g : groups) {
    beginnings.push_back(columns);
    screen.ranges.emplace_back(static_cast<Eigen::Index>(columns), library.groups[g].count);
    columns += static_cast<std::size_t>(library.groups[g].count);
  }
  columns += relatives.size();
  likelihood::ResponseSums sums;
  for (std::size_t r = 0; r < problem.runs.size(); ++r) {
    FeatureColumns features{problem, seen, library, groups, r};
    EffectColumns effects{problem, seen, seen.fit.hypothesis, r};
    for (const model::ActiveEffect& active : relatives) effects.add(active, active.theta);
    likelihood::RowMatrix acceleration(seen.reference[r].axes, static_cast<Eigen::Index>(relatives.size())),
        by_sensor(acceleration.rows(), acceleration.cols());
    likelihood::respond(
        problem, seen.reference[r], r, columns, all || !relatives.empty() ? std::span<const std::size_t>{} : beginnings,
        [&](std::size_t block, likelihood::RowMatrix& into, likelihood::RowMatrix& shown) {
          features.at(block, into);
          if (relatives.empty()) return;
          by_sensor.setZero();
          effects.at(block, acceleration, by_sensor);
          into.rightCols(acceleration.cols()) = acceleration;
          shown.rightCols(acceleration.cols()) = by_sensor.topRows(shown.rows());
        },
        sums);
  }
  const Eigen::MatrixXd X = sums.with_numbers;
  screen.gram = sums.gram.selfadjointView<Eigen::Lower>();
  screen.gram -= X.transpose() * (seen.covariance * X);
  screen.gradient = sums.gradient - X.transpose() * seen.step;
  return screen;
}

/// Share of a column's own information that a group of others holds too.
double shared(const Screen& screen, const Range& range, Eigen::Index column) {
  Eigen::MatrixXd G = screen.gram.block(range.first, range.first, range.second, range.second);
  G.diagonal() *= 1.0 + 1e-9;
  const Eigen::VectorXd g = screen.gram.block(range.first, column, range.second, 1);
  const double own = screen.gram(column, column);
  if (!(own > 0.0) || !(G.diagonal().minCoeff() > 0.0)) return 0.0;
  return g.dot(G.ldlt().solve(g)) / own;
}

/// Groups that pass through the filter together.
std::vector<std::vector<std::size_t>> batches_of(const likelihood::FreeForce& library) {
  std::vector<std::vector<std::size_t>> batches;
  int columns = kBatch;
  for (std::size_t g = 0; g < library.groups.size(); ++g) {
    if (columns + library.groups[g].count > kBatch) {
      batches.emplace_back();
      columns = 0;
    }
    batches.back().push_back(g);
    columns += library.groups[g].count;
  }
  return batches;
}

double price(const likelihood::FeatureGroup& group, std::size_t of, const Thresholds& thresholds) {
  return thresholds.group_price + std::log(static_cast<double>(of)) +
         (group.searched ? thresholds.searched_price : 0.0);
}

/// What a screen has taken up.
struct Picked {
  likelihood::FreeForce force;
  double bayes_factor{}, priced{};  ///< nats, of all together
};

Picked picked_of(const likelihood::FreeForce& library, const Screen& screen, const std::vector<std::size_t>& picked,
                 const GroupEvidence& evidence) {
  Picked taken{.bayes_factor = evidence.log_bayes_factor};
  likelihood::FreeForce& force = taken.force;
  Eigen::Index at = 0;
  for (std::size_t k = 0; k < picked.size(); ++k) {
    likelihood::FeatureGroup group = library.groups[screen.groups[picked[k]]];
    const int from = group.first;
    group.first = static_cast<int>(force.features.size());
    group.sigma = evidence.sigma[k];
    for (int j = 0; j < group.count; ++j) {
      force.features.push_back(library.features[static_cast<std::size_t>(from + j)]);
      force.weights.push_back(evidence.weight[at++]);
    }
    force.groups.push_back(std::move(group));
  }
  return taken;
}

likelihood::FreeForce both(likelihood::FreeForce force, const likelihood::FreeForce& more) {
  for (likelihood::FeatureGroup group : more.groups) {
    group.first += static_cast<int>(force.features.size());
    force.groups.push_back(std::move(group));
  }
  force.features.insert(force.features.end(), more.features.begin(), more.features.end());
  force.weights.insert(force.weights.end(), more.weights.begin(), more.weights.end());
  return force;
}

/// sigma^2 := |w|^2 / (n - tr(Sigma) / sigma^2), MacKay 1992.
void renew_sigmas(likelihood::Fit& fit) {
  const Eigen::Index p = fit.information.rows();
  const Eigen::MatrixXd covariance = fit.information.ldlt().solve(Eigen::MatrixXd::Identity(p, p));
  std::size_t first = 0;
  while (first < fit.numbers.size() && fit.numbers[first].kind != likelihood::NumberKind::kWeight) ++first;
  for (likelihood::FeatureGroup& group : fit.hypothesis.force.groups) {
    double square = 0.0, open = 0.0;
    for (int j = group.first; j < group.first + group.count; ++j) {
      const double w = fit.hypothesis.force.weights[static_cast<std::size_t>(j)];
      const auto at = static_cast<Eigen::Index>(first) + j;
      square += w * w;
      open += covariance(at, at);
    }
    const double known = std::max(group.count - open / (group.sigma * group.sigma), 0.1);
    group.sigma = std::clamp(std::sqrt(square / known), kLeastSigma, kMostSigma);
  }
}

}  // namespace

GroupEvidence group_evidence(const Eigen::MatrixXd& gram, const Eigen::VectorXd& gradient,
                             std::span<const Range> groups, std::vector<double> sigma) {
  std::vector<Eigen::Index> columns;
  for (const auto& [first, count] : groups) {
    for (Eigen::Index j = 0; j < count; ++j) columns.push_back(first + j);
  }
  const Eigen::MatrixXd G = gram(columns, columns);
  const Eigen::VectorXd b = gradient(columns);
  GroupEvidence best{.log_bayes_factor = -1e300, .sigma = sigma};
  for (int turn = 0; turn < kTurns; ++turn) {
    Eigen::VectorXd D(static_cast<Eigen::Index>(columns.size()));
    Eigen::Index at = 0;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      for (Eigen::Index j = 0; j < groups[g].second; ++j) D[at++] = sigma[g];
    }
    Eigen::MatrixXd scaled = D.asDiagonal() * G * D.asDiagonal();
    scaled.diagonal().array() += 1.0;
    const Eigen::LDLT<Eigen::MatrixXd> ldlt{scaled};
    const Eigen::VectorXd x = ldlt.solve(D.cwiseProduct(b));
    double value = 0.5 * D.cwiseProduct(b).dot(x);
    for (Eigen::Index j = 0; j < D.size(); ++j) value -= 0.5 * std::log(std::max(ldlt.vectorD()[j], 1e-300));
    if (std::isfinite(value) && value > best.log_bayes_factor) best = {value, sigma, D.cwiseProduct(x)};
    const Eigen::MatrixXd inverse = ldlt.solve(Eigen::MatrixXd::Identity(D.size(), D.size()));
    at = 0;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      double square = 0.0, open = 0.0;
      for (Eigen::Index j = 0; j < groups[g].second; ++j, ++at) {
        square += D[at] * x[at] * D[at] * x[at];
        open += inverse(at, at);
      }
      const double known = std::max(static_cast<double>(groups[g].second) - open, 0.1);
      sigma[g] = std::clamp(std::sqrt(square / known), kLeastSigma, kMostSigma);
    }
  }
  return best;
}

std::string words(const GroupFound& group) {
  if (group.axis >= likelihood::kWorldAxis) return group.kind;  // which says along what
  return group.kind + " in " + model::kAxisNames[static_cast<std::size_t>(group.axis)];
}

namespace {

class Seeker {
 public:
  Seeker(const likelihood::Problem& problem, const Seen& seen, const model::Scene& scene, const Thresholds& thresholds,
         int threads, const Deadline& deadline, std::span<const model::ActiveEffect> relatives)
      : problem_{problem},
        seen_{seen},
        scene_{scene},
        thresholds_{thresholds},
        threads_{threads},
        deadline_{deadline},
        relatives_{relatives} {}

  FreeForceFound run() {
    FreeForceFound found;
    double evidence = seen_.fit.log_evidence;  // prices paid
    for (int round = 0; round < thresholds_.free_force_rounds && !(round > 0 && deadline_.over()); ++round) {
      std::optional<Seen> again;
      if (round > 0) again = see(problem_, found.fit, threads_);
      const Seen& now = again ? *again : seen_;
      Picked picked = pick(now, round == 0);
      if (picked.force.empty()) break;
      if (round == 0) found.at_fixed_noise = found.log_odds = picked.bayes_factor - picked.priced;
      // What the random force has swallowed shows where it is smaller.
      std::optional<Picked> quiet;
      if (round == 0 && swallows(now)) {
        likelihood::Fit quick = now.fit;
        quick.noise = quickened(now);
        quiet = pick(see(problem_, std::move(quick), threads_), true);
      }
      if (deadline_.over()) break;
      const bool settled = round > 0 || found.at_fixed_noise >= kSettled * thresholds_.free_force_odds;
      std::vector<likelihood::Fit> fits(quiet || !settled ? 2 : 1);
      for_each_index(fits.size(), threads_, [&](std::size_t start) {
        likelihood::Noise noise = now.fit.noise;
        if (start > 0 && quiet) {
          noise = quickened(now);
        } else if (start > 0) {
          for (likelihood::AxisNoise& axis : noise) axis.log[likelihood::kForce] -= std::log(kFactor);
        }
        fits[start] = fitted(now.fit.hypothesis, start > 0 && quiet ? quiet->force : picked.force, noise,
                             fits.size() == 1 ? threads_ : 1);
      });
      const likelihood::Fit* best = nullptr;
      for (const likelihood::Fit& fit : fits) {
        if (fit.finite && (best == nullptr || worth(fit) > worth(*best))) best = &fit;
      }
      // What the screen promises and no fit keeps is not found.
      if (best == nullptr) {
        if (round == 0) found.log_odds = std::min(found.log_odds, 0.0);
        break;
      }
      const double gained = worth(*best) - evidence;
      if (round > 0 && gained < thresholds_.group_gain) break;
      found.fit = *best;
      evidence = worth(*best);
      if (round == 0) screened_ = std::move(picked);
      if (gained < thresholds_.group_gain) break;
    }
    if (found.fit.finite) prune(found.fit);
    conclude(found);
    return found;
  }

 private:
  /// Groups that are worth more than they cost, one after the other, those that have become superfluous taken back.
  [[nodiscard]] Picked pick(const Seen& seen, bool at_least_one) {
    const likelihood::FreeForce library = feature_library(problem_, seen, scene_);
    const std::size_t all = library.groups.size();
    groups_ = std::max(groups_, all);
    std::vector<double> alone(all, -1e300);
    const std::vector<std::vector<std::size_t>> batches = batches_of(library);
    for_each_index(batches.size(), threads_, [&](std::size_t b) {
      const Screen several = screen(problem_, seen, library, batches[b], false, relatives_);
      const auto own = several.gram.cols() - static_cast<Eigen::Index>(relatives_.size());
      for (std::size_t k = 0; k < batches[b].size(); ++k) {
        const std::size_t g = batches[b][k];
        bool same = held(seen, library.groups[g]);
        for (Eigen::Index e = own; e < several.gram.cols() && !same; ++e)
          same = shared(several, several.ranges[k], e) > thresholds_.same_thing;
        if (same) continue;
        alone[g] =
            group_evidence(several.gram, several.gradient, std::span{several.ranges}.subspan(k, 1), {kStartSigma})
                .log_bayes_factor -
            price(library.groups[g], all, thresholds_);
      }
    });
    std::vector<std::size_t> shortlist;
    for (std::size_t g = 0; g < all; ++g) {
      if (alone[g] > -1e299) shortlist.push_back(g);
    }
    if (shortlist.empty()) return {};
    std::ranges::sort(shortlist, std::greater{}, [&](std::size_t g) { return alone[g]; });
    shortlist.resize(std::min(shortlist.size(), kShortlist));
    const Screen whole = screen(problem_, seen, library, shortlist, true);
    const auto price_of = [&](std::size_t k) { return price(library.groups[whole.groups[k]], all, thresholds_); };
    const auto evidence_of = [&](const std::vector<std::size_t>& of, std::vector<double> sigma) {
      std::vector<Range> ranges;
      for (const std::size_t k : of) ranges.push_back(whole.ranges[k]);
      return group_evidence(whole.gram, whole.gradient, ranges, std::move(sigma));
    };
    std::vector<std::size_t> picked;
    GroupEvidence evidence;
    double priced = 0.0;
    const auto most = static_cast<std::size_t>(
        std::max(0, thresholds_.most_groups - static_cast<int>(seen.fit.hypothesis.force.groups.size())));
    while (picked.size() < most) {
      double best = thresholds_.group_gain;
      std::size_t taken = shortlist.size();
      GroupEvidence of_best;
      for (std::size_t k = 0; k < shortlist.size(); ++k) {
        if (std::ranges::find(picked, k) != picked.end()) continue;
        std::vector<std::size_t> of = picked;
        of.push_back(k);
        std::vector<double> sigma = evidence.sigma;
        sigma.push_back(kStartSigma);
        GroupEvidence with = evidence_of(of, std::move(sigma));
        const double gain = with.log_bayes_factor - evidence.log_bayes_factor - price_of(k);
        if (gain <= best) continue;
        best = gain;
        taken = k;
        of_best = std::move(with);
      }
      if (taken == shortlist.size()) break;
      picked.push_back(taken);
      priced += price_of(taken);
      evidence = std::move(of_best);
      for (std::size_t k = 0; k + 1 < picked.size();) {  // the one that was just taken up stays
        std::vector<std::size_t> of = picked;
        std::vector<double> sigma = evidence.sigma;
        of.erase(of.begin() + static_cast<std::ptrdiff_t>(k));
        sigma.erase(sigma.begin() + static_cast<std::ptrdiff_t>(k));
        GroupEvidence without = evidence_of(of, std::move(sigma));
        if (without.log_bayes_factor + price_of(picked[k]) <= evidence.log_bayes_factor) {
          ++k;
          continue;
        }
        priced -= price_of(picked[k]);
        picked = std::move(of);
        evidence = std::move(without);
      }
    }
    // Where nothing stands out, the best is fitted all the same: the fitted random force may have swallowed it.
    if (picked.empty() && at_least_one && most > 0) {
      picked.push_back(0);
      priced = price_of(0);
      evidence = evidence_of(picked, {kStartSigma});
    }
    if (picked.empty()) return {};
    Picked taken = picked_of(library, whole, picked, evidence);
    taken.priced = priced;
    return taken;
  }

  /// A group of the force that is in the model already.
  static bool held(const Seen& seen, const likelihood::FeatureGroup& group) {
    return !group.searched && std::ranges::any_of(seen.fit.hypothesis.force.groups, [&](const auto& other) {
      return other.kind == group.kind && other.axis == group.axis && other.count == group.count;
    });
  }

  /// A random force of practical size that remembers for long may have taken something slow for its own.
  [[nodiscard]] bool swallows(const Seen& seen, std::size_t i) const {
    const likelihood::AxisNoise& noise = seen.fit.noise[i];
    return noise[likelihood::kForce] > thresholds_.smallest_size * seen.applied[problem_.axes[i]] &&
           noise[likelihood::kForceMemory] > thresholds_.swallowing_memory;
  }
  [[nodiscard]] bool swallows(const Seen& seen) const {
    for (std::size_t i = 0; i < static_cast<std::size_t>(problem_.simulated); ++i) {
      if (swallows(seen, i)) return true;
    }
    return false;
  }

  /// The noise without what is slow in such random forces: as quick as they are at first, sigma^2 / tau stays what it
  /// is.
  [[nodiscard]] likelihood::Noise quickened(const Seen& seen) const {
    likelihood::Noise noise = seen.fit.noise;
    const likelihood::Noise usual = likelihood::prior_noise(problem_);
    for (std::size_t i = 0; i < static_cast<std::size_t>(problem_.simulated); ++i) {
      if (!swallows(seen, i)) continue;
      const double shorter = usual[i].log[likelihood::kForceMemory] - noise[i].log[likelihood::kForceMemory];
      noise[i].log[likelihood::kForceMemory] += shorter;
      noise[i].log[likelihood::kForce] += 0.5 * shorter;
    }
    return noise;
  }

  [[nodiscard]] likelihood::Fit fitted(const likelihood::Hypothesis& from, const likelihood::FreeForce& more,
                                       const likelihood::Noise& noise, int threads) const {
    likelihood::FitOptions options{.noise_rounds = 2, .steps = 2, .enough = 0.3, .threads = threads};
    // The screen is linear: where its weights run away in the filter, the fit begins from smaller ones.
    likelihood::Fit fit;
    for (const double share : {1.0, 0.3, 0.0}) {
      likelihood::FreeForce smaller = more;
      for (double& weight : smaller.weights) weight *= share;
      likelihood::Hypothesis hypothesis = from;
      hypothesis.force = both(hypothesis.force, smaller);
      fit = likelihood::fit(problem_, hypothesis, noise, options);
      if (fit.finite) break;
    }
    if (!fit.finite) return fit;
    renew_sigmas(fit);
    options.noise_rounds = kMostRounds;
    likelihood::Fit again = likelihood::fit(problem_, fit.hypothesis, fit.noise, options);
    return again.finite ? again : fit;
  }

  [[nodiscard]] double price_of(const likelihood::FreeForce& force) const {
    double sum = 0.0;
    for (const likelihood::FeatureGroup& group : force.groups) sum += price(group, groups_, thresholds_);
    return sum;
  }
  [[nodiscard]] double worth(const likelihood::Fit& fit) const {
    return fit.log_evidence - price_of(fit.hypothesis.force);
  }

  /// Nats that each group is worth, its price paid: Savage and Dickey's ratio of densities at no weight.
  [[nodiscard]] std::vector<double> worths(const likelihood::Fit& fit) const {
    const Eigen::Index p = fit.information.rows();
    const Eigen::MatrixXd covariance = fit.information.ldlt().solve(Eigen::MatrixXd::Identity(p, p));
    Eigen::Index first = 0;
    while (first < p && fit.numbers[static_cast<std::size_t>(first)].kind != likelihood::NumberKind::kWeight) ++first;
    std::vector<double> worths;
    for (const likelihood::FeatureGroup& group : fit.hypothesis.force.groups) {
      const Eigen::MatrixXd C = covariance.block(first + group.first, first + group.first, group.count, group.count);
      const Eigen::Map<const Eigen::VectorXd> w{fit.hypothesis.force.weights.data() + group.first, group.count};
      const Eigen::LDLT<Eigen::MatrixXd> ldlt{C};
      double log_det = 0.0;
      for (Eigen::Index j = 0; j < group.count; ++j) log_det += std::log(std::max(ldlt.vectorD()[j], 1e-300));
      worths.push_back(0.5 * w.dot(ldlt.solve(w)) + 0.5 * log_det - group.count * std::log(group.sigma) -
                       price(group, groups_, thresholds_));
    }
    return worths;
  }

  /// Groups that others have made superfluous go, if a fit without them agrees.
  void prune(likelihood::Fit& fit) const {
    const std::vector<double> worth_of = worths(fit);
    likelihood::FreeForce kept;
    for (std::size_t g = 0; g < worth_of.size(); ++g) {
      if (worth_of[g] <= 0.0) continue;
      likelihood::FeatureGroup group = fit.hypothesis.force.groups[g];
      const auto from = static_cast<std::ptrdiff_t>(group.first), to = from + group.count;
      group.first = static_cast<int>(kept.features.size());
      const likelihood::FreeForce& force = fit.hypothesis.force;
      kept.features.insert(kept.features.end(), force.features.begin() + from, force.features.begin() + to);
      kept.weights.insert(kept.weights.end(), force.weights.begin() + from, force.weights.begin() + to);
      kept.groups.push_back(std::move(group));
    }
    if (kept.empty() || kept.groups.size() == worth_of.size() || deadline_.over()) return;
    likelihood::Hypothesis hypothesis = fit.hypothesis;
    hypothesis.force = {};
    likelihood::Fit without = fitted(hypothesis, kept, fit.noise, threads_);
    if (without.finite && worth(without) >= worth(fit)) fit = std::move(without);
  }

  void conclude(FreeForceFound& found) const {
    const likelihood::FreeForce* force = &screened_.force;
    if (found.fit.finite) {
      force = &found.fit.hypothesis.force;
      found.log_odds = std::max(found.log_odds, worth(found.fit) - seen_.fit.log_evidence);
      const std::vector<double> worth_of = worths(found.fit);
      for (std::size_t g = 0; g < worth_of.size(); ++g)
        found.groups.push_back({force->groups[g].kind, force->groups[g].axis, worth_of[g]});
      for (std::size_t i = 0; i < static_cast<std::size_t>(problem_.simulated); ++i) {
        const double left = found.fit.noise[i][likelihood::kForce] / seen_.fit.noise[i][likelihood::kForce];
        found.explainable.push_back(std::max(0.0, 1.0 - left * left));
      }
    } else {
      for (const likelihood::FeatureGroup& group : force->groups)
        found.groups.push_back({group.kind, group.axis, found.at_fixed_noise});
    }
    std::ranges::stable_sort(found.groups, std::greater{}, &GroupFound::gain);
    if (force->empty()) return;
    found.size = size_at(*force);
  }

  /// At the seen states.
  [[nodiscard]] Size size_at(const likelihood::FreeForce& force) const {
    std::vector<std::size_t> groups(force.groups.size());
    std::iota(groups.begin(), groups.end(), std::size_t{0});
    const Eigen::Map<const Eigen::VectorXd> w{force.weights.data(), static_cast<Eigen::Index>(force.weights.size())};
    std::vector<Eigen::MatrixXd> accelerations;
    for (std::size_t r = 0; r < problem_.runs.size(); ++r) {
      FeatureColumns features{problem_, seen_, force, groups, r};
      const auto blocks = static_cast<Eigen::Index>(problem_.runs[r].blocks().size());
      likelihood::RowMatrix columns(seen_.reference[r].axes, static_cast<Eigen::Index>(features.size()));
      Eigen::MatrixXd sum(columns.rows(), blocks);
      for (Eigen::Index b = 0; b < blocks; ++b) {
        features.at(static_cast<std::size_t>(b), columns);
        sum.col(b) = columns * w;
      }
      accelerations.push_back(std::move(sum));
    }
    return size_of(problem_, seen_, accelerations);
  }

  static constexpr int kMostRounds = 4;
  const likelihood::Problem& problem_;
  const Seen& seen_;
  const model::Scene& scene_;
  const Thresholds& thresholds_;
  int threads_;
  const Deadline& deadline_;
  std::span<const model::ActiveEffect> relatives_;
  std::size_t groups_{1};  // that were screened
  Picked screened_;
};

}  // namespace

FreeForceFound find_free_force(const likelihood::Problem& problem, const Seen& seen, const model::Scene& scene,
                               const Thresholds& thresholds, int threads, const Deadline& deadline,
                               std::span<const model::ActiveEffect> relatives) {
  return Seeker{problem, seen, scene, thresholds, threads, deadline, relatives}.run();
}

}  // namespace fathom::inference
