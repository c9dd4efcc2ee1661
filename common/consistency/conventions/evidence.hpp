// What the kinematic relations of one recording say about a reading: position against velocity through the attitude,
// attitude against rates, gravity against the accelerometer, depth against position. Each window of about a second
// gives one log-likelihood, with the relation's noise estimated under the reading itself (Student's t, so that outliers
// do not choose), and two readings are compared by Vuong's test on the differences, whose long-run variance respects
// that neighbouring windows tell one story (Vuong 1989, Econometrica 57, 307; Newey and West 1987).
#pragma once

#include <array>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "common/consistency/conventions/evidence_windows.hpp"
#include "common/consistency/conventions/reading.hpp"
#include "common/estimation/timeline.hpp"

namespace fathom::consistency {

enum Relation : std::size_t { kTravel, kTurning, kGravity, kDepth, kRelations };

/// A reading of one recording, judged.
struct Judged {
  std::vector<double> log_likelihood;            ///< per window, of all relations
  std::array<double, kRelations> unexplained{};  ///< fraction of the relation's variance; 1 where it is not there
  std::array<bool, kRelations> seen{};
  bool upside_down{};  ///< the vehicle hangs with its keel up nearly throughout
  double heading{};    ///< rad, where the reading leaves it free
  [[nodiscard]] double total() const;
};

/// By how much, and how surely, the first is better.
struct Advantage {
  double gain{};  ///< nats
  double z{};     ///< of Vuong's test
};
[[nodiscard]] Advantage compare(const Judged& better, const Judged& than);

/// Streams of one recording as read, and how they lie in windows.
class Evidence {
 public:
  /// Empty series: not recorded. `depth` holds (0, 0, z).
  Evidence(const estimation::PoseSeries& pose, const estimation::Series& velocity, const estimation::Series& rates,
           const estimation::Series& force, const estimation::Series& depth);
  [[nodiscard]] Judged judge(const Reading& reading) const;
  /// Enough windows, and at least one relation.
  [[nodiscard]] bool speaks() const;
  /// The attitude as read never tilts, to the last digit: it was made of a heading, as for a craft that only turns.
  [[nodiscard]] bool heading_alone() const { return heading_alone_; }

 private:
  [[nodiscard]] const std::vector<EvidenceWindow>& windows(const Reading& reading) const;
  EvidenceStreams streams_;
  bool heading_alone_{};
  mutable std::map<std::pair<int, int>, std::vector<EvidenceWindow>> forms_;  ///< each way to read the attitude
};

}  // namespace fathom::consistency
