// The library of a learned force as a product: terms (what acts, and along what) times modulators (what makes it weaker
// or stronger). Most causes that no list holds are a known term that something else modulates.
#pragma once

#include <string>
#include <vector>

#include "common/inference/scan.hpp"
#include "common/likelihood/features.hpp"

namespace fathom::learning {

using Columns = std::vector<std::vector<likelihood::Factor>>;  ///< products of factors, one per column

/// What kind of term: which modulations are asked of it.
enum TermKind : unsigned {
  kPlainTerm = 1,
  kConstantTerm = 2,
  kStreamTerm = 4,
  kDragTerm = 8,
  kThrustTerm = 16,
  kThrusterTerm = 32,
  kWorldTerm = 64,   ///< a constant that is fixed in the world
  kWholeTerm = 128,  ///< the whole thrust
  kMassTerm = 256,
  kGoingTerm = 512  ///< the drag against translation
};

constexpr double kMoves = 1e-3;  ///< m/s, rad/s: an axis that does less shows nothing

/// Something that acts along a direction.
struct Term {
  std::string words;  ///< "drag", "a stream toward north"
  int axis{};         ///< Feature::axis
  Columns columns;    ///< that act together
  unsigned kind{kPlainTerm};
  bool held{};  ///< base numbers hold it: only its modulations are new
  bool closed{true};
  bool searched{false};  ///< inner numbers of it are sought in the data
};

/// What a term may go with besides.
struct Modulator {
  std::string words;  ///< ", by depth"
  Columns columns;
  unsigned of{};      ///< kinds of terms of which it is asked; of others it is another plain term, or costs too much
  bool closed{true};  ///< a law, not a table
  bool of_recording{false};  ///< a table over its time: it tells of no other recording
  bool searched{false};      ///< inner numbers of it are sought in the data
};

[[nodiscard]] std::vector<Term> terms_of(const likelihood::Problem& problem, const inference::Seen& seen,
                                         const model::Scene& scene);
/// A moment is sought for each term besides.
[[nodiscard]] std::vector<Modulator> modulators_of(const likelihood::Problem& problem, const model::Scene& scene);

}  // namespace fathom::learning
