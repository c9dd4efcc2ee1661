#include "common/preflight/wiring.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "common/identification/trajectories/fit_from_priors.hpp"
#include "common/preflight/thrust_evidence.hpp"
#include "common/preflight/turned_axes.hpp"

namespace fathom::preflight {
namespace {

using Allocation = Eigen::Matrix<double, 6, Eigen::Dynamic>;

constexpr int kStarts = 60;               // of the search, beside the file's own arrangement
constexpr double kPrice = 6.0;            // log likelihood per input that is not as in the file
constexpr double kCertain = 20.0;         // log likelihood over the file's own arrangement
constexpr double kSame = 5.0;             // log likelihood by which arrangements are not told apart
constexpr std::size_t kMostReadings = 3;  // that are told
constexpr std::size_t kWindows = 40;      // of the fits that confirm it
constexpr double kLessError = 0.5;        // of the error, at least

class Search {
 public:
  Search(const model::Vehicle& vehicle, std::span<const Trial> trials)
      : evidence_{vehicle, trials},
        allocation_{trials.front().input_is_wrench ? Allocation{Allocation::Identity(6, 6)} : vehicle.allocation} {}

  [[nodiscard]] Wiring as_filed() const {
    const auto n = static_cast<std::size_t>(allocation_.cols());
    Wiring wiring{std::vector<std::size_t>(n), std::vector<int>(n, 1)};
    std::iota(wiring.actuator.begin(), wiring.actuator.end(), std::size_t{0});
    return wiring;
  }

  [[nodiscard]] Allocation effective(const Wiring& wiring) const {
    Allocation allocation(6, allocation_.cols());
    for (std::size_t i = 0; i < wiring.sign.size(); ++i)
      allocation.col(static_cast<Eigen::Index>(i)) =
          wiring.sign[i] * allocation_.col(static_cast<Eigen::Index>(wiring.actuator[i]));
    return allocation;
  }

  /// The half turn of all axes under which the file's own arrangement would fit best.
  [[nodiscard]] TurnedAxes turn() const {
    TurnedAxes axes = likeliest_turn(evidence_, allocation_);
    axes.cost += kPrice;  // one thing to be wrong, however many thrusters it moves
    return axes;
  }

  /// Minus log likelihood, what the file does not say being the less likely the more it is.
  [[nodiscard]] double cost(const Wiring& wiring) const {
    const Allocation allocation = effective(wiring);
    double changed = 0.0;
    for (Eigen::Index i = 0; i < allocation.cols(); ++i)
      changed += allocation.col(i).isApprox(allocation_.col(i)) ? 0.0 : 1.0;
    return evidence_.cost(allocation) + kPrice * changed;
  }

  /// Downhill by one exchange, rotation of three, or reversal at a time.
  [[nodiscard]] Wiring descend(Wiring wiring) const {
    double least = cost(wiring);
    for (bool moved = true; moved;) {
      moved = false;
      Wiring best = wiring;
      const auto look = [&](const Wiring& next) {
        const double its = cost(next);
        if (its >= least - 1e-9) return;
        least = its;
        best = next;
        moved = true;
      };
      const std::size_t n = wiring.sign.size();
      for (std::size_t i = 0; i < n; ++i) {
        Wiring turned = wiring;
        turned.sign[i] = -turned.sign[i];
        look(turned);
        for (std::size_t j = i + 1; j < n; ++j) {
          Wiring exchanged = wiring;
          std::swap(exchanged.actuator[i], exchanged.actuator[j]);
          look(exchanged);
          for (std::size_t k = 0; k < n; ++k) {
            if (k == i || k == j) continue;
            Wiring rotated = exchanged;
            std::swap(rotated.actuator[j], rotated.actuator[k]);
            look(rotated);
          }
        }
      }
      wiring = best;
    }
    return wiring;
  }

 private:
  ThrustEvidence evidence_;
  Allocation allocation_;
};

std::vector<Eigen::VectorXd> rewired(const std::vector<Eigen::VectorXd>& inputs, const Wiring& wiring) {
  std::vector<Eigen::VectorXd> all;
  all.reserve(inputs.size());
  for (const Eigen::VectorXd& input : inputs) {
    Eigen::VectorXd& next = all.emplace_back(input.size());
    for (std::size_t i = 0; i < wiring.sign.size(); ++i)
      next[static_cast<Eigen::Index>(wiring.actuator[i])] = wiring.sign[i] * input[static_cast<Eigen::Index>(i)];
  }
  return all;
}

/// Of the same windows: the mean over the axes, as a ratio each, so that none rules by its unit.
double error_left(const identification::FitResult& as_filed, const identification::FitResult& other) {
  double sum = 0.0, axes = 0.0;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    double before = 0.0, after = 0.0;
    for (std::size_t w = 0; w < as_filed.window_square.size(); ++w) {
      before += as_filed.window_square[w][axis];
      after += other.window_square[w][axis];
    }
    if (!(before > 0.0) || !(after > 0.0)) continue;
    sum += 0.5 * std::log(after / before);
    axes += 1.0;
  }
  return axes > 0.0 ? std::exp(sum / axes) : 1.0;
}

}  // namespace

std::vector<Wiring> likely_wirings(const model::Vehicle& vehicle, std::span<const Trial> trials) {
  const Search search{vehicle, trials};
  const Wiring filed = search.as_filed();
  std::vector<Wiring> ends{search.descend(filed)};
  std::mt19937 random{1};
  for (int start = 0; start < kStarts; ++start) {
    Wiring any = filed;
    for (std::size_t i = any.sign.size(); i-- > 1;) std::swap(any.actuator[i], any.actuator[random() % (i + 1)]);
    for (int& sign : any.sign) sign = random() % 2 == 0 ? 1 : -1;
    ends.push_back(search.descend(any));
  }
  std::ranges::stable_sort(ends, {}, [&](const Wiring& wiring) { return search.cost(wiring); });
  const double least = search.cost(ends.front());
  if (least > search.cost(filed) - kCertain) return {};
  std::vector<Wiring> likely;
  for (const Wiring& wiring : ends) {
    if (search.cost(wiring) > least + kSame || likely.size() == kMostReadings) break;
    const Allocation own = search.effective(wiring);
    if (std::ranges::none_of(likely, [&](const Wiring& w) { return search.effective(w).isApprox(own); }))
      likely.push_back(wiring);
  }
  return likely;
}

namespace {

/// A half turn of the axes that fits as well as the likeliest arrangements of thrusters.
std::optional<TurnedAxes> turn_instead(const model::Vehicle& vehicle, std::span<const Trial> trials,
                                       const std::vector<Wiring>& likely) {
  const Search search{vehicle, trials};
  const double least = likely.empty() ? search.cost(search.as_filed()) - kCertain : search.cost(likely.front()) + kSame;
  const TurnedAxes turn = search.turn();
  return turn.cost <= least ? std::optional{turn} : std::nullopt;
}

}  // namespace

std::vector<Trial> rewired(std::span<const Trial> trials, const Wiring& wiring) {
  std::vector<Trial> all{trials.begin(), trials.end()};
  for (Trial& trial : all) {
    trial.input = rewired(trial.input, wiring);
    trial.held = rewired(trial.held, wiring);
    trial.told = rewired(trial.told, wiring);
  }
  return all;
}

std::string words_for(const Wiring& wiring, const model::Vehicle& vehicle, bool wrench) {
  const auto name = [&](std::size_t i) {
    return wrench ? std::string{model::kAxisNames[i]} : vehicle.thrusters[i].name;
  };
  std::vector<std::string> words;
  const std::size_t n = wiring.sign.size();
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t other = wiring.actuator[i];
    if (other == i) continue;
    if (wiring.actuator[other] != i) {
      words.push_back(name(i) + " acting as " + name(other));
    } else if (i < other) {
      words.push_back(name(i) + " and " + name(other) + " exchanged");
    }
  }
  const bool all = std::ranges::all_of(wiring.sign, [](int sign) { return sign < 0; });
  if (all) words.push_back(wrench ? "every axis reversed" : "every thruster reversed");
  for (std::size_t i = 0; i < n && !all; ++i) {
    if (wiring.sign[i] < 0) words.push_back(name(i) + " reversed");
  }
  std::string text;
  for (const std::string& each : words) text += (text.empty() ? "" : ", ") + each;
  return text;
}

std::optional<WiringFault> wiring_fault(const model::Vehicle& vehicle, std::span<const Trial> trials,
                                        const identification::FitSettings& settings) {
  const std::vector<Wiring> likely = likely_wirings(vehicle, trials);
  const std::optional<TurnedAxes> turn = turn_instead(vehicle, trials, likely);
  if (likely.empty() && !turn) return {};
  identification::FitSettings few = settings;
  few.most_windows = std::min(few.most_windows, kWindows);
  model::Vehicle right = vehicle;
  std::vector<Trial> other{trials.begin(), trials.end()};
  if (!turn) {
    other = rewired(trials, likely.front());
  } else if (trials.front().input_is_wrench) {
    Wiring signs = Search{vehicle, trials}.as_filed();
    signs.sign.assign(turn->sign.begin(), turn->sign.end());
    other = rewired(trials, signs);
  } else {
    right.allocation = turned(vehicle.allocation, *turn);
  }
  const double left = error_left(identification::fit_from_priors(vehicle, trials, few),
                                 identification::fit_from_priors(right, other, few));
  if (left > 1.0 - kLessError) return {};
  WiringFault fault{.readings = {}, .error_reduction = 1.0 - left};
  if (turn) fault.readings.emplace_back(turn->words);
  for (const Wiring& wiring : likely)
    fault.readings.push_back(words_for(wiring, vehicle, trials.front().input_is_wrench));
  return fault;
}

}  // namespace fathom::preflight
