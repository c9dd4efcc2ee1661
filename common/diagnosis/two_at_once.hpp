// Two effects that are found together or not at all: each is judged beside the other, as if that had been found first.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "common/diagnosis/pairs.hpp"
#include "common/diagnosis/round.hpp"

namespace fathom::diagnosis {

struct Two {
  std::array<Judged, 2> judged;
  identification::FitResult fit;
};

/// What a search hands to it; all of it must outlive the call.
struct TwoAtOnce {
  std::span<const Candidate> candidates;
  NearView& near;
  const identification::TrajectoryFit& problem;
  const identification::FitResult& reference;  ///< the model that lacks them
  std::span<const Trial> trials;
  const model::Scene& scene;
  const Settings& settings;
  int tried{};
  const Progress& progress;
  double done{};
};

/// The pairs that promise enough for a full fit, best first.
[[nodiscard]] std::vector<Pair> worthy_pairs(const Answers& answers);

/// Whether what was found alone is one of the two that promise most together: the other follows by itself, mostly.
[[nodiscard]] bool will_be_followed(std::span<const Pair> worthy, const Answers& answers, const Winner& alone);

/// Two effects that explain far more together than `alone`: the fit with what was found one by one, or the reference.
[[nodiscard]] std::optional<Two> find_two(const TwoAtOnce& with, const Answers& answers, std::span<const Pair> worthy,
                                          const identification::FitResult& alone);

}  // namespace fathom::diagnosis
