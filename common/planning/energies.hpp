// How strongly effects show in a stretch of motion, beside the base parameters and beside each other.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/base/factors.hpp"
#include "common/planning/view.hpp"

namespace fathom::planning {

/// A stretch that could be flown in addition.
struct Extra {
  std::string name;
  double duration{};  ///< s
  const View* view{};
};

/// The segment with which a question is answered soonest.
struct Answer {
  std::string segment;
  double seconds{};  ///< of it, repeated; five at least, half an hour at most
};

/// Energy below which there is none: of the noise.
constexpr double kNoEnergy = 1e-9;

/// Twice the log odds at which one of two look-alikes is ruled out: what must set them apart, in squared standard
/// deviations.
constexpr double kToldApart = 2.0 * 3.0;

/// Base parameters, and the clock of the commands, as the prior and some stretches know them.
class Base {
 public:
  Base(const model::Model& model, std::span<const View* const> views);
  /// Step of the scaled parameters that follows a change, from its product with the derivatives.
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& b) const { return factor_.solve(b); }

 private:
  SymmetricFactor factor_;
};

/// An effect in one form at one size, and what it changes.
struct Suspect {
  model::ActiveEffect active;
  double ordinary{std::numeric_limits<double>::infinity()};  ///< its sizes over what is ordinary for them, the largest
  bool found{false};
  Eigen::VectorXd change;    ///< during the excitation
  Eigen::VectorXd imitated;  ///< the step of the base parameters and the clock that follows it
};

/// Multiplies what the effect is proportional to; false when that leaves the physical limits.
bool grow(model::ActiveEffect& active, double factor);

/// Energy, in squared standard deviations, that nothing else explains. What it is made from must outlive it.
class Energies {
 public:
  Energies(const View& excitation, std::span<const Extra> extras, const std::vector<Suspect>& suspects);

  /// Product of two suspects' changes beside the base parameters, by the excitation alone (`with` 0) or with extra
  /// number `with` - 1 in addition.
  [[nodiscard]] double product(std::size_t i, std::size_t j, std::size_t with) const;
  /// Of suspect `i` beside suspect `j`.
  [[nodiscard]] double beside(std::size_t i, std::size_t j, std::size_t with) const;
  /// The extra that shows suspect `i` as strongly as the excitation does.
  [[nodiscard]] std::optional<Answer> as_strong(std::size_t i) const;
  /// The extra that tells `i` from `j`.
  [[nodiscard]] std::optional<Answer> tells_apart(std::size_t i, std::size_t j) const;

 private:
  const View& excitation_;
  std::span<const Extra> extras_;
  const std::vector<Suspect>& suspects_;
  std::vector<Base> bases_;
  std::vector<std::vector<Eigen::VectorXd>> changes_;
};

}  // namespace fathom::planning
