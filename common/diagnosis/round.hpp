// One round of the search: full fits of the candidates that promise most, until one stands that nothing speaks against.
#pragma once

#include <map>
#include <optional>

#include "common/diagnosis/held_out.hpp"
#include "common/diagnosis/questions.hpp"
#include "common/diagnosis/random_force.hpp"

namespace fathom::diagnosis {

/// The candidate that gains most and that nothing speaks against.
struct Winner {
  std::size_t place{};  ///< among the answers
  identification::FitResult fit;
};

/// What it is made from must outlive it.
class Round {
 public:
  Round(Answers& answers, Promises& promises, const identification::TrajectoryFit& problem,
        const identification::FitResult& reference, std::span<const Trial> train, const Settings& settings, int tried,
        const Progress& progress, double done);

  /// `first` tells which candidates are meant; after `few` fits without a winner, only open ones, `most` in all.
  std::optional<Winner> fit_best(Which first, std::size_t few, std::size_t most);

  /// Names what looks like the winner: by the first looks, of which `near` is the fit that was asked about, and those
  /// that were fitted in full beside it, stand as well, and change the same motion in the same way. What the first
  /// looks saw of them may have been far from where their fits went.
  void name_rivals(const Winner& winner, const identification::FitResult& near, Judged& accepted) const;

 private:
  [[nodiscard]] bool looks_like(std::size_t place, const Winner& best) const;
  [[nodiscard]] bool counts_beside_trifles(const Winner& best) const;
  bool counts_beside_memory(std::size_t i, const identification::FitResult& fit);
  std::optional<identification::FitResult> fit_in_full(std::size_t i, double best_share);

  Answers& answers_;
  Promises& promises_;
  const identification::TrajectoryFit& problem_;
  const identification::FitResult& reference_;
  std::span<const Trial> train_;
  const Settings& settings_;
  int tried_;
  const Progress& progress_;
  double done_;
  Coarse coarse_;
  std::map<std::size_t, identification::FitResult> stands_;   // by place: fitted in full, and nothing speaks against it
  std::map<std::size_t, identification::FitResult> trifles_;  // evident, but too little or too quick to count
  std::optional<CrossValidation> checked_;                    // of the reference, made when the first fit is judged
  std::optional<RandomForce> random_;                         // of the reference, made when the first fit wins
};

}  // namespace fathom::diagnosis
