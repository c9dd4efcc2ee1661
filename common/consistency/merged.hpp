// What the checks of several groups of recordings, or of the parts of a long one, come to together: the same finding
// in many parts is one finding with the parts that show it, and a quantity that every part measures is their mean.
#pragma once

#include <map>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "common/consistency/consistency.hpp"

namespace fathom::consistency {

/// What was checked at a time: recordings, or parts of one.
struct CheckedPart {
  std::string name;   ///< as in the findings
  std::size_t run{};  ///< number of the recording that it is, or belongs to
};

class Merged {
 public:
  explicit Merged(std::vector<std::string> runs) : runs_{std::move(runs)} {}

  /// The check of these together. What the first one leaves is returned by result() as it is.
  void add(ConsistencyResult result, std::span<const CheckedPart> parts);
  /// Corrections: one per recording, those that most of its parts share. Pairs hold their statements alone where there
  /// was more than one check.
  [[nodiscard]] ConsistencyResult result() &&;
  [[nodiscard]] std::size_t checks() const { return checks_; }

 private:
  struct Seen {
    ConsistencyFinding first;
    std::vector<double> sizes, stds;
    std::vector<std::string> names;  ///< of the parts, of the first few
    std::size_t parts{};
  };
  void take_findings(const std::vector<ConsistencyFinding>& findings, std::span<const CheckedPart> parts);
  void take_statements(const ConsistencyResult& result);

  std::vector<std::string> runs_;
  std::size_t checks_{};
  ConsistencyResult only_;  ///< of the first
  using Key = std::tuple<std::string, std::string, std::string, std::string>;
  std::map<Key, Seen> seen_;
  std::vector<Key> order_;                                                 ///< in which they came
  std::map<std::string, std::vector<std::vector<Statement>>> statements_;  ///< per pair: per quantity, of every check
  std::vector<Pooled> distances_;
  std::vector<double> distance_limits_;
  std::vector<std::vector<Corrections>> corrections_;  ///< per recording: of its parts
};

}  // namespace fathom::consistency
