// One pass of the live regression: candidates made for what a stretch of the trial has shown (how deep, how fast, how
// long), and the evidence of the samples that went through them. Once the trial has shown more, another pass is made.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "common/diagnosis/live_evidence.hpp"
#include "common/diagnosis/places.hpp"
#include "common/diagnosis/seen_trial.hpp"
#include "common/identification/integral_regressor.hpp"

namespace fathom::diagnosis {

constexpr Utime kCommandStep = 20'000;  // us between commands that are kept for delays

/// What a pass rests on.
struct LiveBasis {
  const model::Vehicle& vehicle;
  const std::vector<model::BaseParameter>& parameters;  ///< of the vehicle file, in its order
  const identification::ParameterVector& prior_mean;
  const model::Model& nominal;
  bool input_is_wrench{};
  double block{};    ///< s
  double max_gap{};  ///< s
  std::size_t most_blocks{};
  double mounting{};                          ///< rad, as in LiveSettings; 0: turns are not asked for
  identification::IntegralSettings integral;  ///< of the rows
};

class LiveScreening {
 public:
  /// Candidates for the scene of the valid ones among `seen`, of which there is one at least. Everything in `basis`
  /// must outlive it. `sigma` weighs the axes as an earlier pass did: what a long stretch leaves tells of the cause
  /// that is looked for rather than of noise.
  LiveScreening(const LiveBasis& basis, const SeenTrial& seen, const std::optional<Vector6d>& sigma);

  /// Takes the next sample. The first one of a new block hands out the instant up to which rows count; what came
  /// before may be judged then. `behind`: nobody will.
  std::optional<Utime> use(const LiveSample& sample, bool behind = false);
  /// The streams ended: what is in the open block counts too.
  void close() { evidence_->close_block(); }

  [[nodiscard]] LiveEvidence& evidence() { return *evidence_; }
  [[nodiscard]] const std::vector<LiveForm>& forms() const { return columns_->forms(); }
  [[nodiscard]] const Places& places() const { return places_; }
  /// For which the candidates were made.
  [[nodiscard]] const model::Scene& scene() const { return scene_; }
  /// Size of the rows' residual per axis, N and N m.
  [[nodiscard]] const Vector6d& sigma() const { return sigma_; }

 private:
  struct Before {
    Utime utime{};
    model::ActuatorForces force;
  };
  [[nodiscard]] model::Scene scene_of(const SeenTrial& seen) const;
  [[nodiscard]] model::Model base_of(const SeenTrial& seen);
  void add(const identification::RowBlock& block);
  [[nodiscard]] Eigen::Index turns() const { return basis_.mounting > 0.0 ? LiveCandidates::kTurns : 0; }

  LiveBasis basis_;
  model::Scene scene_;
  Utime origin_;
  Vector6d sigma_{Vector6d::Ones()};
  identification::IntegralRegressor regressor_;
  std::unique_ptr<LiveCandidates> columns_;
  std::unique_ptr<LiveEvidence> evidence_;
  Places places_;
  std::optional<Before> before_;
  std::optional<std::int64_t> block_;  // number of the block that is filling
  std::vector<Eigen::VectorXd> past_;  // commands on their grid
  Utime past_begin_{};
  std::vector<WrenchColumns> wrench_, momentum_;  // ring, beside the regressor's
  std::size_t next_{};
  std::size_t filled_{};
  WrenchColumns filtered_, rate_;  // workspace
  Eigen::VectorXd row_;
};

}  // namespace fathom::diagnosis
