// The check of one vehicle's recordings against each other, step by step: was the pose read as it was meant, what do
// the pairs of signals say, and when two sensors accuse a third, who is to blame. Known to the files of its steps only;
// the rest of the room calls check_consistency().
#pragma once

#include <string>
#include <vector>

#include "common/consistency/consistency.hpp"
#include "common/consistency/conventions/selection.hpp"

namespace fathom::consistency {

class Check {
 public:
  explicit Check(std::span<const Recording> recordings);
  [[nodiscard]] ConsistencyResult run();

 private:
  [[nodiscard]] PoseSeries pose(std::size_t r) const {
    PoseSeries corrected = poses_[r];
    correct_pose(result_.corrections[r], corrected);
    return corrected;
  }
  // reading.cpp
  void choose_readings();
  void take(std::size_t r, const Reading& reading);
  void report_cause(const std::string& run, const Cause& cause, bool disagree);
  // consistency.cpp
  [[nodiscard]] PairResult rates() const;
  [[nodiscard]] PairResult velocity(const PairResult& gyro) const;
  [[nodiscard]] PairResult acceleration() const;
  bool blame_late_position(const PairResult& gyro, const PairResult& dvl);
  void align_clocks(bool dvl_compared, bool gyro_compared);
  void report_outliers(const std::string& name, const PairResult& pair);
  // pose_blame.cpp
  bool blame_pose_tilt(const PairResult& gyro, const PairResult& dvl);
  bool blame_position_unit(const PairResult& dvl);
  bool blame_position_scale(const PairResult& dvl);
  void compare_distances(const PairResult& dvl);
  bool find_heading(const PairResult& dvl);
  void report(const std::string& signal, const std::string& finding, double size, const std::string& unit,
              const std::string& evidence, const std::string& action, const std::string& reference) {
    result_.findings.push_back({.run = "all",
                                .signal = signal,
                                .reference = reference,
                                .finding = finding,
                                .size = size,
                                .unit = unit,
                                .evidence = evidence,
                                .action = action});
  }

  std::vector<RunSignals> runs_;
  std::vector<PoseSeries> poses_;  // averaged to the working rate
  std::vector<Series> gyro_, dvl_, force_;
  std::vector<std::string> names_;
  std::string reference_;
  bool one_estimate_{false};  // pose and velocity share a clock, and nothing else can be asked of them
  ConsistencyResult result_;
};

}  // namespace fathom::consistency
