// What runs that no fit has seen say of all that was accepted together.
#pragma once

#include <array>
#include <span>

#include "common/diagnosis/moved.hpp"
#include "common/diagnosis/search.hpp"
#include "common/residual/prediction.hpp"

namespace fathom::diagnosis {

/// Whether what training promised is kept by runs that no fit has seen. A veto only: nothing is accepted for it, and
/// runs that hardly feel what was found (`foreseen`: fall_if_right) have none.
[[nodiscard]] bool carries_over(const SearchResult& found, const Interval& change, double foreseen);

/// Share of the lasting error on `unseen` that the accepted effects explain; 1 when the runs are too short to tell.
/// What is left along axes of `random` does not count.
[[nodiscard]] double share_on(std::span<const Trial> unseen, const SearchResult& found, const model::Vehicle& vehicle,
                              const Settings& settings, const std::array<bool, 6>& random = {});

/// Whether what explains `share` of the lasting error is worth keeping: either most of a cause, or, without its name,
/// for predictions that surely (`change`: improvement) gain. What random forces leave is imitated a little by much.
[[nodiscard]] bool worth_keeping(double share, const Interval& change);

}  // namespace fathom::diagnosis
