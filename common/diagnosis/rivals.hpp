// Other explanations beside the one that was accepted: which look the same, which of them the data cannot rule out, at
// what odds, and which base number each would falsify where it acts and is left out.
#pragma once

#include <map>
#include <string>

#include "common/diagnosis/judgement.hpp"
#include "common/diagnosis/questions.hpp"

namespace fathom::diagnosis {

constexpr double kAlternativeLogOdds = 3.0;  ///< 20 to 1 between two look-alikes settles which it is

/// A base number that a missing effect moves, by so much of its value.
struct Corruption {
  std::string parameter;  ///< empty where none surely moves
  double share{};
};

/// The base numbers of a fit without an effect, with how well they are known.
class BaseNumbers {
 public:
  BaseNumbers(const identification::TrajectoryFit& problem, identification::FitResult without);
  /// Of those that the model `with` the effect surely has otherwise, the one that is off by the largest share.
  /// `without`: a model without the effect, fitted to the same windows as the one with it.
  [[nodiscard]] Corruption most_moved(const model::Model& without, const model::Model& with) const;
  [[nodiscard]] const identification::FitResult& fit() const { return without_; }

 private:
  identification::FitResult without_;
};

/// Natural log odds of an explanation that was chosen over another one, from 0. Numbers beyond the other's cost what
/// they do in `price`; that the other has more does not speak against it, since it may have them for a reason.
[[nodiscard]] double log_odds_over(std::span<const double> other, int other_numbers, std::span<const double> chosen,
                                   int chosen_numbers);
/// Log odds that a name is right which has `log_odds` against doing nothing, beside what it may be instead.
[[nodiscard]] double log_odds_among(double log_odds, std::span<const Alternative> alternatives);

/// What the first looks say: names look-alikes of the winner, and which of them nothing rules out. `near`: the model
/// that was asked about, as fitted to short windows. `step`: s, of the rollouts.
void find_aliases(Judged& winner, const Screened& best, const Answers& answers, const BaseNumbers& numbers,
                  const model::Model& near, double step, const Settings& settings);
/// What full fits say, by place among the answers; where they speak, they count for more.
void find_rivals(Judged& winner, const identification::FitResult& fit,
                 const std::map<std::size_t, identification::FitResult>& stands, const Answers& answers,
                 const BaseNumbers& numbers, const identification::TrajectoryFit& problem, const Settings& settings);

/// The odds between look-alikes, and what each would do to the model unnoticed; empty where there are none.
[[nodiscard]] std::string odds_sentence(const EffectFound& effect);

}  // namespace fathom::diagnosis
