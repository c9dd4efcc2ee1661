#include "common/result/cause_words.hpp"

#include <algorithm>
#include <array>

namespace fathom::result {
namespace {

constexpr std::array kWords{
    CauseWords{"nothing_found", "log odds", "No effect has the odds that a name needs", false},
    CauseWords{"named", "probability", "The evidence sets an effect apart from every other"},
    CauseWords{"weak_evidence", "probability", "Names of so little evidence are often wrong", false},
    CauseWords{"rivals", "probability", "The data fits more than one name", false},
    CauseWords{"free_force", "log odds", "A force acts that no listed effect explains"},
    CauseWords{"slow_random_force", "memory [s]", "A random force remembers itself for too long to be noise"},
    CauseWords{"many_names", "names", "Many names are not enough: something is left all the same, as of what no list holds"},
    CauseWords{"not_following", "fraction of the acceleration", "The model does not follow its thrust", false},
    CauseWords{"absurd_number", "size over its prior's", "A number lies where none can be"},
    CauseWords{"too_short", "s of data", "The runs are too short to judge by", false},
    CauseWords{"not_finite", "", "The filter diverged"},
    CauseWords{"scores_disagree", "fraction of the open-loop error",
               "Numbers fitted one step ahead and many ahead disagree"},
    CauseWords{"names_mislead", "fraction of the error",
               "With the names that fit best, runs that judge are foretold worse than without", false},
    CauseWords{"sensors_disagree", "log odds", "A sensor's number is wrong, by comparing the sensors"},
    CauseWords{"sensors_undecided", "log odds", "One of two sensors is wrong, and nothing tells which", false},
    CauseWords{"begins_unseen", "s", "Something begins in a run that judges, where no fit has seen it"},
    CauseWords{"wiring", "fraction of the error", "The thrusters seem to be others than the vehicle's file says"},
    CauseWords{"no_prediction", "R2 of 5 s predictions", "The model foretells less than the average does", false},
    CauseWords{"thrust_not_followed", "fraction of the applied wrench",
               "Less than half of the applied force is accounted for", false},
    CauseWords{"residual_goes_with", "fraction of the residual's variance",
               "The residual goes with something that was measured"},
    CauseWords{"not_carried_over", "log odds", "An effect helped the runs that it was fitted to, and not the others"},
    CauseWords{"promising", "fraction of the error", "A refused effect would remove much of the error"},
    CauseWords{"part_only", "fraction of the lasting error", "The accepted effects explain only a part", false},
    CauseWords{"no_skill", "1 - (error / error where nothing changes)^2",
               "The model predicts no better than that nothing changes", false},
    CauseWords{"force_unit", "fitted inertia over the expected one",
               "The thrust is as a force in another unit would be"},
    CauseWords{"input_idle", "Student's t of the thrust",
               "The recorded thrust does nothing, or, below zero, pushes the other way", false},
    CauseWords{"out_of_time", "s", "The time that was given ended before the search did"},
    CauseWords{"free_curve", "", "A force of a form that no listed effect has would explain more"}};

}  // namespace

std::span<const CauseWords> cause_words() { return kWords; }

const CauseWords* words_of(std::string_view cause) {
  const auto found = std::ranges::find(kWords, cause, &CauseWords::cause);
  return found == kWords.end() ? nullptr : &*found;
}

}  // namespace fathom::result
