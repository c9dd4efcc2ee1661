#include "common/inference/free_force.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "common/base/parallel.hpp"

namespace fathom::inference {
namespace {

constexpr double kStartSigma = 0.03;  // of the applied wrench: weights before their group's variance is known
constexpr double kLeastSigma = 1e-4;
constexpr double kMostSigma =
    1.0;  // groups that nearly cancel would else stand for anything with weights of thousands of per cent
constexpr int kTurns = 5;               // of the variances
constexpr std::size_t kShortlist = 14;  // groups whose products with all others are worked out
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

Screen screen(const likelihood::Problem& problem, const Seen& seen, const likelihood::FreeForce& library,
              const std::vector<std::size_t>& groups, bool all) {
  Screen screen{.groups = groups};
  std::vector<std::size_t> beginnings;
  std::size_t columns = 0;
  for (const std::size_t g : groups) {
    beginnings.push_back(columns);
    screen.ranges.emplace_back(static_cast<Eigen::Index>(columns), library.groups[g].count);
    columns += static_cast<std::size_t>(library.groups[g].count);
  }
  likelihood::ResponseSums sums;
  for (std::size_t r = 0; r < problem.runs.size(); ++r) {
    FeatureColumns features{problem, seen, library, groups, r};
    likelihood::respond(
        problem, seen.reference[r], r, columns, all ? std::span<const std::size_t>{} : beginnings,
        [&](std::size_t block, likelihood::RowMatrix& acceleration, likelihood::RowMatrix&) {
          features.at(block, acceleration);
        },
        sums);
  }
  const Eigen::MatrixXd X = sums.with_numbers;
  screen.gram = sums.gram.selfadjointView<Eigen::Lower>();
  screen.gram -= X.transpose() * (seen.covariance * X);
  screen.gradient = sums.gradient;
  return screen;
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

/// The hypothesis with these groups of the library as its free force.
likelihood::FreeForce chosen(const likelihood::FreeForce& library, const Screen& screen,
                             const std::vector<std::size_t>& picked, const GroupEvidence& evidence) {
  likelihood::FreeForce force;
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
  if (group.axis >= likelihood::kWorldAxis) return group.kind;
  return group.kind + " in " + model::kAxisNames[static_cast<std::size_t>(group.axis)];
}

FreeForceFound find_free_force(const likelihood::Problem& problem, const Seen& seen, const model::Scene& scene,
                               const Thresholds& thresholds, int threads, const Deadline& deadline) {
  FreeForceFound found;
  const likelihood::FreeForce library = feature_library(problem, seen, scene);
  const std::size_t all = library.groups.size();
  if (all == 0) return found;

  // Each group alone; the best of them with all their products.
  std::vector<double> alone(all, 0.0);
  const std::vector<std::vector<std::size_t>> batches = batches_of(library);
  for_each_index(batches.size(), threads, [&](std::size_t b) {
    const Screen several = screen(problem, seen, library, batches[b], false);
    for (std::size_t k = 0; k < batches[b].size(); ++k) {
      const std::size_t g = batches[b][k];
      alone[g] = group_evidence(several.gram, several.gradient, std::span{several.ranges}.subspan(k, 1), {kStartSigma})
                     .log_bayes_factor -
                 price(library.groups[g], all, thresholds);
    }
  });
  std::vector<std::size_t> shortlist(all);
  for (std::size_t g = 0; g < all; ++g) shortlist[g] = g;
  std::ranges::sort(shortlist, std::greater{}, [&](std::size_t g) { return alone[g]; });
  shortlist.resize(std::min(all, kShortlist));
  const Screen whole = screen(problem, seen, library, shortlist, true);

  std::vector<std::size_t> picked;
  GroupEvidence evidence;
  double priced = 0.0;
  while (static_cast<int>(picked.size()) < thresholds.most_groups) {
    double best = thresholds.group_gain;
    std::size_t taken = shortlist.size();
    GroupEvidence of_best;
    for (std::size_t k = 0; k < shortlist.size(); ++k) {
      if (std::ranges::find(picked, k) != picked.end()) continue;
      std::vector<Range> ranges;
      for (const std::size_t other : picked) ranges.push_back(whole.ranges[other]);
      ranges.push_back(whole.ranges[k]);
      std::vector<double> sigma = evidence.sigma;
      sigma.push_back(kStartSigma);
      GroupEvidence with = group_evidence(whole.gram, whole.gradient, ranges, sigma);
      const double gain =
          with.log_bayes_factor - evidence.log_bayes_factor - price(library.groups[whole.groups[k]], all, thresholds);
      if (gain <= best) continue;
      best = gain;
      taken = k;
      of_best = std::move(with);
    }
    if (taken == shortlist.size()) break;
    const likelihood::FeatureGroup& group = library.groups[whole.groups[taken]];
    found.groups.push_back({group.kind, group.axis, best});
    priced += price(group, all, thresholds);
    picked.push_back(taken);
    evidence = std::move(of_best);
  }
  // Where nothing stands out, the best is fitted all the same: the fitted random force may have swallowed it.
  if (picked.empty()) {
    picked.push_back(0);
    const likelihood::FeatureGroup& group = library.groups[whole.groups[0]];
    evidence = group_evidence(whole.gram, whole.gradient, std::span{whole.ranges}.first(1), {kStartSigma});
    priced = price(group, all, thresholds);
    found.groups.push_back({group.kind, group.axis, evidence.log_bayes_factor - priced});
  }
  found.at_fixed_noise = evidence.log_bayes_factor - priced;
  found.log_odds = found.at_fixed_noise;

  // Noise fitted anew beside it, from the noise as it is and from a smaller random force.
  const bool settled = found.at_fixed_noise > kSettled * thresholds.free_force_odds;
  std::vector<likelihood::Fit> fits(deadline.over() ? 0 : settled ? 1 : 2);
  for_each_index(fits.size(), threads, [&](std::size_t start) {
    likelihood::Hypothesis hypothesis = seen.fit.hypothesis;
    hypothesis.force = chosen(library, whole, picked, evidence);
    likelihood::Noise noise = seen.fit.noise;
    for (likelihood::AxisNoise& axis : noise) axis.log[likelihood::kForce] -= start == 0 ? 0.0 : std::log(kFactor);
    likelihood::FitOptions options{.noise_rounds = 2, .steps = 2, .enough = 0.3};
    if (fits.size() == 1) options.threads = threads;
    // The screen is linear: where its weights run away in the filter, the fit begins from smaller ones.
    likelihood::Fit fitted;
    for (const double share : {1.0, 0.3, 0.0}) {
      likelihood::Hypothesis smaller = hypothesis;
      for (double& weight : smaller.force.weights) weight *= share;
      fitted = likelihood::fit(problem, smaller, noise, options);
      if (fitted.finite) break;
    }
    if (fitted.finite) {
      renew_sigmas(fitted);
      options.noise_rounds = 1;
      const likelihood::Fit again = likelihood::fit(problem, fitted.hypothesis, fitted.noise, options);
      if (again.finite) fitted = again;
    }
    fits[start] = std::move(fitted);
  });
  for (likelihood::Fit& fit : fits) {
    if (!fit.finite) continue;
    const double odds = fit.log_evidence - seen.fit.log_evidence - priced;
    if (found.fit.finite && fit.log_evidence <= found.fit.log_evidence) continue;
    found.log_odds = odds;
    found.fit = std::move(fit);
  }
  // What the screen promises and no fit keeps is not found.
  if (!fits.empty() && !found.fit.finite) found.log_odds = std::min(found.log_odds, 0.0);

  for (std::size_t i = 0; i < static_cast<std::size_t>(problem.simulated) && found.fit.finite; ++i) {
    const double left = found.fit.noise[i][likelihood::kForce] / seen.fit.noise[i][likelihood::kForce];
    found.explainable.push_back(std::max(0.0, 1.0 - left * left));
  }
  // Its size at the seen states.
  std::vector<double> weights(evidence.weight.begin(), evidence.weight.end());
  if (found.fit.finite) weights = found.fit.hypothesis.force.weights;
  std::vector<std::size_t> groups;
  for (const std::size_t k : picked) groups.push_back(whole.groups[k]);
  std::vector<Eigen::MatrixXd> accelerations;
  for (std::size_t r = 0; r < problem.runs.size(); ++r) {
    FeatureColumns features{problem, seen, library, groups, r};
    const auto blocks = static_cast<Eigen::Index>(problem.runs[r].blocks().size());
    likelihood::RowMatrix columns(seen.reference[r].axes, static_cast<Eigen::Index>(features.size()));
    const Eigen::Map<const Eigen::VectorXd> w{weights.data(), static_cast<Eigen::Index>(weights.size())};
    Eigen::MatrixXd sum(columns.rows(), blocks);
    for (Eigen::Index b = 0; b < blocks; ++b) {
      features.at(static_cast<std::size_t>(b), columns);
      sum.col(b) = columns * w;
    }
    accelerations.push_back(std::move(sum));
  }
  found.size = size_of(problem, seen, accelerations);
  return found;
}

}  // namespace fathom::inference
