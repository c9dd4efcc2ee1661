#include "common/diagnosis/own_run.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "common/model/onset.hpp"

namespace fathom::diagnosis {
namespace {

using identification::FitResult;
using identification::ParameterMap;
using identification::TrajectoryFit;

constexpr int kSteps = 10;         // of Gauss and Newton
constexpr double kHalved = 1e-3;   // of a step: shorter ones lead nowhere
constexpr double kArrived = 1e-6;  // relative fall of the cost
constexpr int kMoments = 16;       // of a change that are tried, beside "before" and "never"
constexpr double kOutside = 10.0;  // s before and after the run

const model::EffectParameter* parameter_of_run(const ParameterMap& map, std::size_t i, const model::Model& model) {
  if (map[i].effect < 0 || !map[i].sought) return nullptr;
  const model::ActiveEffect& active = model.effects[static_cast<std::size_t>(map[i].effect)];
  const model::EffectParameter& parameter = active.effect->parameters()[static_cast<std::size_t>(map[i].component)];
  return parameter.of_run ? &parameter : nullptr;
}

double middle(std::span<const Trial> unseen) { return 0.5 * (unseen.front().t.front() + unseen.back().t.back()); }

/// The first half's windows and the numbers that it may set.
class FirstHalf {
 public:
  FirstHalf(const FitResult& learnt, const model::Vehicle& vehicle, std::span<const Trial> unseen,
            const identification::FitSettings& settings)
      : problem_{vehicle, unseen, settings}, map_{learnt.model} {
    fit_.model = learnt.model;
    fit_.sigma = learnt.sigma;
    const double half = middle(unseen);
    for (std::size_t w = 0; w < problem_.windows().size(); ++w) {
      const model::Window& window = problem_.windows()[w].window();
      fit_.nu0.push_back(window.trial->nu[window.start]);
      if (window.trial->t[window.start + window.count - 1] <= half) early_.push_back(w);
    }
    for (std::size_t i = 0; i < map_.size(); ++i) {
      if (parameter_of_run(map_, i, fit_.model) != nullptr) own_.push_back(static_cast<Eigen::Index>(i));
    }
  }

  [[nodiscard]] bool tells() const { return !early_.empty() && !own_.empty(); }
  [[nodiscard]] const model::Model& model() const { return fit_.model; }
  [[nodiscard]] const std::vector<Eigen::Index>& own() const { return own_; }

  /// A change's moment is tried all over the run: no slope leads to it.
  void scan_moments(double from, double to) {
    for (const Eigen::Index i : own_) {
      if (parameter_of_run(map_, static_cast<std::size_t>(i), fit_.model)->name != model::kOnset) continue;
      std::vector<double> moments = model::onset_starts(from, to, kMoments);
      moments.insert(moments.end(), {from - kOutside, to + kOutside});
      Eigen::VectorXd best = map_.pack(fit_.model);
      double least = Equations{*this}.cost;
      for (const double moment : moments) {
        Eigen::VectorXd x = map_.pack(fit_.model);
        x[i] = moment / map_[static_cast<std::size_t>(i)].scale;
        map_.unpack(x, fit_.model);
        const double cost = Equations{*this}.cost;
        if (cost >= least) continue;
        least = cost;
        best = x;
      }
      map_.unpack(best, fit_.model);
    }
  }

  void descend() {
    Equations here{*this};
    for (int step = 0; step < kSteps; ++step) {
      const Eigen::VectorXd x = map_.pack(fit_.model);
      const Eigen::VectorXd move = -here.normal.ldlt().solve(here.gradient);
      double share = 1.0;
      Equations next = here;
      for (; share > kHalved; share *= 0.5) {
        Eigen::VectorXd there = x;
        there(own_) += share * move;
        map_.unpack(there, fit_.model);
        next = Equations{*this};
        if (next.cost < here.cost) break;
      }
      if (!(next.cost < here.cost)) {
        map_.unpack(x, fit_.model);
        return;
      }
      const bool arrived = here.cost - next.cost < kArrived * here.cost;
      here = next;
      if (arrived) return;
    }
  }

 private:
  struct Equations {
    explicit Equations(const FirstHalf& half) {
      const auto n = static_cast<Eigen::Index>(half.own_.size());
      normal = Eigen::MatrixXd::Identity(n, n);  // of scaled numbers: as much as one sample tells
      gradient = Eigen::VectorXd::Zero(n);
      const auto windows = half.problem_.linearise(half.fit_, false);
      for (const std::size_t w : half.early_) {
        const Eigen::MatrixXd J = windows[w].jacobian(Eigen::all, half.own_);
        normal += J.transpose() * J;
        gradient += J.transpose() * windows[w].residual;
        cost += 0.5 * windows[w].residual.squaredNorm();
      }
    }
    Eigen::MatrixXd normal;
    Eigen::VectorXd gradient;
    double cost{};
  };

  TrajectoryFit problem_;
  ParameterMap map_;
  FitResult fit_;
  std::vector<std::size_t> early_;
  std::vector<Eigen::Index> own_;
};

}  // namespace

std::optional<OwnRun> with_own_numbers(const FitResult& learnt, const model::Vehicle& vehicle,
                                       std::span<const Trial> unseen, const identification::FitSettings& settings) {
  const bool one = std::ranges::all_of(unseen, [&](const Trial& part) { return same_run(part, unseen.front()); });
  if (!one || identification::cut_windows(unseen, settings.window).empty()) return {};
  FirstHalf half{learnt, vehicle, unseen, settings};
  if (!half.tells()) return {};
  half.scan_moments(unseen.front().t.front(), unseen.back().t.back());
  half.descend();
  OwnRun own{half.model(), {}};
  const ParameterMap map{own.model};
  for (const Eigen::Index i : half.own()) {
    const auto place = static_cast<std::size_t>(map[static_cast<std::size_t>(i)].effect);
    const std::string name{own.model.effects[place].effect->name()};
    if (std::ranges::find(own.effects, name) == own.effects.end()) own.effects.push_back(name);
  }
  return own;
}

std::vector<model::Window> second_half(std::span<const model::Window> windows, std::span<const Trial> unseen) {
  std::vector<model::Window> late;
  for (const model::Window& window : windows) {
    if (window.trial->t[window.start] >= middle(unseen)) late.push_back(window);
  }
  return late;
}

}  // namespace fathom::diagnosis
