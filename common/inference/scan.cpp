#include "common/inference/scan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <set>

#include "common/base/factors.hpp"
#include "common/base/parallel.hpp"
#include "common/model/effect_size.hpp"

namespace fathom::inference {
namespace {

constexpr double kZeroStart = 0.3;    // of its sigma, for a number whose grid value is zero
constexpr std::size_t kBatch = 48;    // columns that run through the filter together
constexpr std::size_t kPairsOf = 24;  // best promises, of which all pairs are asked
constexpr double kEventApart = 1.0;   // s: a moment that is so far off is on the true one's hill of the likelihood
constexpr int kOnsetSteps = 8;        // finer times about the best one
constexpr int kFiner = 2;             // so often
constexpr std::size_t kFurther = 2;   // grid points beside a law's best one, from which it is fitted too
constexpr double kNearly = 0.3;       // of the best one's score, for that

/// One grid point of a law as columns.
struct Question {
  std::size_t law{};
  std::vector<double> theta;             // shape numbers as they are, linear ones as each column has them
  std::vector<double> amplitude, sigma;  // per linear number: of its column, and its prior's over that
};

Question question(const Law& law, std::size_t index, const std::vector<double>& theta, const model::Vehicle& vehicle) {
  Question question{.law = index, .theta = theta};
  for (const std::size_t c : law.linear) {
    const model::EffectParameter parameter = model::parameter_of(*law.seed.effect, law.seed.variant, c, vehicle);
    const double amplitude = theta[c] != 0.0 ? theta[c] : kZeroStart * parameter.sigma;
    question.amplitude.push_back(amplitude);
    question.sigma.push_back(parameter.sigma / std::abs(amplitude));
  }
  return question;
}

std::vector<double> with_column(const Law& law, const Question& question, std::size_t column) {
  std::vector<double> theta = question.theta;
  for (std::size_t c = 0; c < law.linear.size(); ++c) theta[law.linear[c]] = c == column ? question.amplitude[c] : 0.0;
  return theta;
}

class Scanner {
 public:
  Scanner(const likelihood::Problem& problem, const Seen& seen, const std::vector<Law>& laws, int threads)
      : problem_{problem}, seen_{seen}, laws_{laws}, threads_{threads} {}

  /// Promises of these questions, in their order.
  std::vector<Promise> ask(const std::vector<Question>& questions) const {
    std::vector<std::pair<std::size_t, std::size_t>> batches;
    std::size_t first = 0, columns = 0;
    for (std::size_t q = 0; q < questions.size(); ++q) {
      columns += questions[q].amplitude.size();
      if (columns < kBatch && q + 1 < questions.size()) continue;
      batches.emplace_back(first, q + 1);
      first = q + 1;
      columns = 0;
    }
    std::vector<Promise> promises(questions.size());
    for_each_index(batches.size(), threads_, [&](std::size_t b) {
      const auto [from, to] = batches[b];
      std::vector<std::size_t> groups;
      const likelihood::ResponseSums sums = sums_of(questions, from, to, groups, false);
      for (std::size_t q = from; q < to; ++q) {
        const std::size_t at = groups[q - from], count = questions[q].amplitude.size();
        promises[q] = promise(questions[q], project(sums, at, count), sums, at);
      }
    });
    return promises;
  }

  std::vector<PairPromise> pairs(const std::vector<Question>& questions) const {
    std::vector<std::size_t> groups;
    if (questions.size() < 2) return {};
    const likelihood::ResponseSums sums = sums_of(questions, 0, questions.size(), groups, true);
    const Eigen::MatrixXd gram = project(sums, 0, static_cast<std::size_t>(sums.gradient.size()));
    std::vector<PairPromise> found;
    for (std::size_t a = 0; a < questions.size(); ++a) {
      for (std::size_t b = a + 1; b < questions.size(); ++b) {
        if (exclude(laws_[questions[a].law].seed, laws_[questions[b].law].seed)) continue;
        std::vector<Eigen::Index> columns;
        Eigen::VectorXd sigma(static_cast<Eigen::Index>(questions[a].sigma.size() + questions[b].sigma.size()));
        Eigen::Index n = 0;
        for (const std::size_t q : {a, b}) {
          for (std::size_t c = 0; c < questions[q].sigma.size(); ++c) {
            columns.push_back(static_cast<Eigen::Index>(groups[q] + c));
            sigma[n++] = questions[q].sigma[c];
          }
        }
        const Gain gain = linear_gain(gram(columns, columns), sums.gradient(columns), sigma);
        PairPromise pair{.first = a, .second = b, .score = gain.score};
        n = 0;
        for (const std::size_t q : {a, b}) {
          std::vector<double>& theta = q == a ? pair.theta_first : pair.theta_second;
          theta = questions[q].theta;
          for (std::size_t c = 0; c < questions[q].sigma.size(); ++c)
            theta[laws_[questions[q].law].linear[c]] = gain.amplitude[n++] * questions[q].amplitude[c];
        }
        found.push_back(std::move(pair));
      }
    }
    std::ranges::sort(found, std::greater{}, &PairPromise::score);
    return found;
  }

 private:
  likelihood::ResponseSums sums_of(const std::vector<Question>& questions, std::size_t from, std::size_t to,
                                   std::vector<std::size_t>& groups, bool all) const {
    likelihood::ResponseSums sums;
    for (std::size_t r = 0; r < problem_.runs.size(); ++r) {
      EffectColumns columns{problem_, seen_, seen_.fit.hypothesis, r};
      groups.clear();
      for (std::size_t q = from; q < to; ++q) {
        groups.push_back(columns.size());
        const Law& law = laws_[questions[q].law];
        for (std::size_t c = 0; c < law.linear.size(); ++c) columns.add(law.seed, with_column(law, questions[q], c));
      }
      likelihood::respond(
          problem_, seen_.reference[r], r, columns.size(), all ? std::span<const std::size_t>{} : groups,
          [&](std::size_t block, likelihood::ColumnsOut acceleration, likelihood::ColumnsOut shown) {
            columns.at(block, acceleration, shown);
          },
          sums);
    }
    sums.gradient -= sums.with_numbers.transpose() * seen_.step;  // the model's own numbers move along
    return sums;
  }

  /// The columns' Gram matrix with what the model's own numbers imitate taken out.
  Eigen::MatrixXd project(const likelihood::ResponseSums& sums, std::size_t at, std::size_t count) const {
    const auto from = static_cast<Eigen::Index>(at), n = static_cast<Eigen::Index>(count);
    Eigen::MatrixXd gram = sums.gram.block(from, from, n, n).selfadjointView<Eigen::Lower>();
    const Eigen::MatrixXd X = sums.with_numbers.middleCols(from, n);
    return gram - X.transpose() * (seen_.covariance * X);
  }

  Promise promise(const Question& question, const Eigen::MatrixXd& gram, const likelihood::ResponseSums& sums,
                  std::size_t at) const {
    const auto n = static_cast<Eigen::Index>(question.sigma.size());
    const Eigen::Map<const Eigen::VectorXd> sigma{question.sigma.data(), n};
    const Gain gain = linear_gain(gram, sums.gradient.segment(static_cast<Eigen::Index>(at), n), sigma);
    Promise promise{.law = question.law, .theta = question.theta, .gain = gain.gain, .score = gain.score};
    const Law& law = laws_[question.law];
    for (std::size_t c = 0; c < law.linear.size(); ++c) {
      const model::EffectParameter parameter =
          model::parameter_of(*law.seed.effect, law.seed.variant, law.linear[c], *problem_.vehicle);
      // Of numbers that are not told to be amplitudes a column is a secant, and says nothing beyond its end.
      const double most = law.seed.effect->amplitudes() > 0 ? std::numeric_limits<double>::infinity() : 1.0;
      const double x = std::clamp(gain.amplitude[static_cast<Eigen::Index>(c)], -most, most) * question.amplitude[c];
      // What the linear solution has on the wrong side of a limit promises nothing there.
      if (law.linear.size() == 1 && (x < parameter.low || x > parameter.high)) promise.gain = promise.score = 0.0;
      promise.theta[law.linear[c]] = std::clamp(x, parameter.low, parameter.high);
    }
    return promise;
  }

  const likelihood::Problem& problem_;
  const Seen& seen_;
  const std::vector<Law>& laws_;
  int threads_;
};

/// Grid points that differ in their linear numbers alone ask the same.
std::vector<Question> all_questions(const std::vector<Law>& laws, const model::Vehicle& vehicle) {
  std::vector<Question> questions;
  for (std::size_t l = 0; l < laws.size(); ++l) {
    std::vector<std::vector<double>> shapes;
    for (const std::vector<double>& theta : laws[l].grid) {
      std::vector<double> shape = theta;
      if (laws[l].seed.effect->amplitudes() > 0) {
        for (const std::size_t c : laws[l].linear) shape[c] = 0.0;
      }
      if (std::ranges::find(shapes, shape) != shapes.end()) continue;
      shapes.push_back(shape);
      questions.push_back(question(laws[l], l, theta, vehicle));
    }
  }
  return questions;
}

/// Between times of events that the grids of these laws hold, each time once; zero: they hold none.
double onset_spacing(std::span<const Law> laws) {
  double spacing = 0.0;
  for (const Law& law : laws) {
    if (law.onset < 0) continue;
    std::set<double> times;
    for (const std::vector<double>& theta : law.grid) times.insert(theta[static_cast<std::size_t>(law.onset)]);
    if (times.size() > 1)
      spacing = std::max(spacing, (*times.rbegin() - *times.begin()) / (static_cast<double>(times.size()) - 1.0));
  }
  return spacing;
}

/// Grid points of the same law after its best one. A promise is linear: numbers that are none (a delay, a time, a
/// place) are far off where the grid is.
std::vector<std::vector<double>> next_best(std::span<const Question> questions, std::span<const Promise> promises,
                                           std::size_t best) {
  std::vector<std::size_t> order;
  for (std::size_t q = 0; q < questions.size(); ++q) {
    if (q != best && questions[q].law == questions[best].law && promises[q].score > kNearly * promises[best].score)
      order.push_back(q);
  }
  std::ranges::sort(order, std::greater{}, [&](std::size_t q) { return promises[q].score; });
  std::vector<std::vector<double>> thetas;
  for (std::size_t k = 0; k < std::min(kFurther, order.size()); ++k) thetas.push_back(promises[order[k]].theta);
  return thetas;
}

/// Asks `steps` times about these questions' own, within `spacing`; the first of those that came.
std::size_t ask_finer(const Scanner& scanner, const likelihood::Problem& problem, std::span<const Law> laws,
                      const std::vector<std::size_t>& about, double spacing, int steps,
                      std::vector<Question>& questions, std::vector<Promise>& promises) {
  const std::size_t from = questions.size();
  for (const std::size_t q : about) {
    const Law& law = laws[questions[q].law];
    for (int s = -steps / 2; law.onset >= 0 && s <= steps / 2; ++s) {
      std::vector<double> theta = questions[q].theta;
      double& onset = theta[static_cast<std::size_t>(law.onset)];
      onset = std::clamp(onset + s * spacing / steps, problem.t_low, problem.t_high);
      if (s != 0) questions.push_back(question(law, questions[q].law, theta, *problem.vehicle));
    }
  }
  const std::vector<Question> more{questions.begin() + static_cast<std::ptrdiff_t>(from), questions.end()};
  std::ranges::move(scanner.ask(more), std::back_inserter(promises));
  return from;
}

}  // namespace

bool shaped(const Law& law) { return law.grid.size() > 1; }

std::vector<std::vector<double>> starts_of(const likelihood::Problem& problem, const Seen& seen, const Law& law,
                                           std::size_t count, const Thresholds& thresholds, int threads) {
  const std::vector<Law> one{law};
  const Scanner scanner{problem, seen, one, threads};
  std::vector<Question> questions = all_questions(one, *problem.vehicle);
  std::vector<Promise> promises = scanner.ask(questions);
  const double spacing = onset_spacing(one);
  const auto onset = [&](std::size_t q) { return questions[q].theta[static_cast<std::size_t>(law.onset)]; };
  const auto by_score = [&] {
    std::vector<std::size_t> order(questions.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, std::greater{}, [&](std::size_t q) { return promises[q].score; });
    return order;
  };
  std::vector<std::size_t> order = by_score();
  if (spacing > kEventApart) {  // the true moment's own hill may lie between two points that both look at others
    std::vector<std::size_t> about = order;
    std::erase_if(about, [&](std::size_t q) { return promises[q].score < 0.5 * promises[order.front()].score; });
    const int steps = static_cast<int>(std::ceil(spacing / kEventApart));
    static_cast<void>(ask_finer(scanner, problem, one, about, spacing, steps, questions, promises));
    order = by_score();
  }
  // About each of the best, apart from each other, its finest time.
  std::vector<std::vector<double>> starts;
  std::vector<std::size_t> taken;
  for (const std::size_t first : order) {
    if (taken.size() == count) break;
    const auto near = [&](std::size_t other) { return std::abs(onset(first) - onset(other)) < 2.0 * kEventApart; };
    if (law.onset >= 0 && std::ranges::any_of(taken, near)) continue;
    taken.push_back(first);
    std::size_t best = first;
    double about = std::min(spacing, kEventApart);
    for (int finer = 0; finer < kFiner && about > 0.0; ++finer) {
      for (std::size_t q = ask_finer(scanner, problem, one, {best}, about, kOnsetSteps, questions, promises);
           q < questions.size(); ++q) {
        if (promises[q].score > promises[best].score) best = q;
      }
      about /= kOnsetSteps;
    }
    if (promises[best].score >= thresholds.score_worth) starts.push_back(promises[best].theta);
  }
  return starts;
}

Gain linear_gain(const Eigen::MatrixXd& gram, const Eigen::VectorXd& gradient, const Eigen::VectorXd& sigma) {
  constexpr int kTurns = 3;  // of the prior's weight, which goes with the amplitude
  const likelihood::Number plain{.freedom = likelihood::kEffectFreedom};
  Gain gain;
  // In units of sigma.
  const Eigen::MatrixXd G = sigma.asDiagonal() * gram * sigma.asDiagonal();
  const Eigen::VectorXd b = sigma.cwiseProduct(gradient);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(sigma.size()), pivots;
  for (int turn = 0; turn < kTurns; ++turn) {
    Eigen::MatrixXd weighted = G;
    for (Eigen::Index j = 0; j < x.size(); ++j) weighted(j, j) += likelihood::prior_weight(plain, x[j]);
    const SymmetricFactor factor{weighted};
    x = factor.solve(b);
    pivots = factor.pivots();
  }
  gain.amplitude = sigma.cwiseProduct(x);
  gain.gain = b.dot(x) - 0.5 * x.dot(G * x);
  if (!std::isfinite(gain.gain)) return {0.0, 0.0, Eigen::VectorXd::Zero(sigma.size())};
  gain.score = gain.gain;
  for (Eigen::Index j = 0; j < sigma.size(); ++j)
    gain.score += likelihood::log_prior(plain, x[j]) + 0.5 * std::log(2.0 * std::numbers::pi) -
                  0.5 * std::log(std::max(pivots[j], 1e-300));
  return gain;
}

Scan scan(const likelihood::Problem& problem, const Seen& seen, const std::vector<Law>& laws,
          const Thresholds& thresholds, int threads) {
  std::vector<std::size_t> open;
  for (std::size_t l = 0; l < laws.size(); ++l) {
    const bool taken = std::ranges::any_of(seen.fit.hypothesis.model.effects,
                                           [&](const auto& active) { return exclude(active, laws[l].seed); });
    if (!taken) open.push_back(l);
  }
  std::vector<Law> asked;
  for (const std::size_t l : open) asked.push_back(laws[l]);
  const Scanner scanner{problem, seen, asked, threads};
  std::vector<Question> questions = all_questions(asked, *problem.vehicle);
  std::vector<Promise> promises = scanner.ask(questions);

  // The best grid point of each law; times of events sought more finely about it.
  std::map<std::size_t, std::size_t> best;
  const auto take_best = [&](std::size_t from) {
    for (std::size_t q = from; q < questions.size(); ++q) {
      const auto [place, fresh] = best.try_emplace(questions[q].law, q);
      if (!fresh && promises[q].score > promises[place->second].score) place->second = q;
    }
  };
  take_best(0);
  std::map<std::size_t, std::vector<std::vector<double>>> also;
  for (const auto& [l, q] : best) also[l] = next_best(questions, promises, q);
  const auto centres = [&] {
    std::vector<std::size_t> of;
    for (const auto& [l, q] : best) {
      if (promises[q].score >= thresholds.score_worth) of.push_back(q);
    }
    return of;
  };
  double spacing = onset_spacing(asked);
  for (int finer = 0; finer < kFiner && spacing > 0.0; ++finer) {
    take_best(ask_finer(scanner, problem, asked, centres(), spacing, kOnsetSteps, questions, promises));
    spacing /= kOnsetSteps;
  }

  Scan scan;
  std::vector<std::size_t> order;
  for (const auto& [l, q] : best) order.push_back(q);
  std::ranges::sort(order, std::greater{}, [&](std::size_t q) { return promises[q].score; });
  for (const std::size_t q : order) {
    scan.promises.push_back(promises[q]);
    scan.promises.back().law = open[promises[q].law];
    scan.promises.back().also = std::move(also.at(questions[q].law));
  }
  std::vector<Question> pairing;
  for (std::size_t k = 0; k < std::min(order.size(), kPairsOf); ++k) pairing.push_back(questions[order[k]]);
  scan.pairs = scanner.pairs(pairing);
  return scan;
}

}  // namespace fathom::inference
