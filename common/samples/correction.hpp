// A force that was learned and adopted, or not, as result.json holds it: a correction with arguments, kept apart from
// causes.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "common/samples/estimates.hpp"

namespace fathom {

/// One factor of a feature; names, places and widths as common/model/learned/features.hpp has them.
struct CorrectionFactor {
  std::string quantity;
  int index{}, bank{};
  double a{}, b{}, c{}, d{};
  std::string column{};  ///< of a measured column: its candidate
};

/// weight times scale times the product of the factors, along an axis: N or N m, or a share of the drag or thrust that
/// it acts along.
struct CorrectionTerm {
  std::string group;  ///< in words
  int axis{};         ///< 0..5 X..N of the body; 6..8 north, east, down of the world; 9 all of the hull's drag; 10 all
                      ///< of the thrust; 11.. the line of each thruster; the rest as features.hpp counts them
  std::vector<CorrectionFactor> factors;
  double scale{}, weight{}, sigma{};
  bool law{};  ///< part of a law in closed form, none of a table
};

/// What is left of an axis' acceleration beside the model with the correction.
struct CorrectionLeft {
  std::string axis;  ///< X Y Z K M N
  double share{};    ///< random force over the applied acceleration
  double before{};   ///< the same without the correction
};

/// A closed form that the correction is told as.
struct FormulaGiven {
  std::string equation;             ///< Fossen's notation
  std::vector<NamedValue> numbers;  ///< SI
  double over_learned{};            ///< nats over the table of features
  std::string words;
};

struct CorrectionGiven {
  bool asked{false};     ///< something unlisted was there to be learned
  bool adopted{false};   ///< it is part of the model that is reported and exported
  bool carried{false};   ///< and of what is told of other runs, without what depends on time
  bool goes_on{false};   ///< time-dependent laws of it stand as they were at the end where a recording's clock goes on
  std::string refused;   ///< why it is not adopted, with numbers
  std::string words;     ///< a sentence
  std::string look_for;  ///< what may lie behind it: a hint, no finding
  double log_odds{}, size{};
  double held_out{1.0};          ///< error over the base model's, geometric mean over what no weight was fitted to
  double held_out_carried{1.0};  ///< the same without what depends on time
  int windows{}, shortened{};    ///< predictions compared; of them with a horizon cut where the motion is chaotic
  std::vector<CorrectionTerm> terms;
  std::vector<std::vector<double>> covariance;  ///< of the weights
  std::array<double, 6> visited_nu{}, visited_tau{};
  std::vector<double> visited_force;  ///< N per thruster, or the wrench
  bool input_is_wrench{false};
  std::array<double, 3> visited_low{}, visited_high{};  ///< m
  std::vector<CorrectionLeft> left;
  /// Deviation of predictions of 10 s on what judges, by the covariance of all numbers, weights included: u v w [m/s],
  /// p q r [rad/s].
  std::array<double, 6> prediction_std{};
  double not_visited{};  ///< share of what judges that is beyond what it was learned from: there it fades
  std::optional<FormulaGiven> formula;  ///< where one fits: the terms are then its own
};

}  // namespace fathom
